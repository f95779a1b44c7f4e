#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the shell steps of action.yml in order, as a CI service does: with `bash -eo pipefail`, in a workspace, and with
files that collect outputs and additions to the PATH. Steps that use another action are only printed. Exit status: that
of the first failing step, or 77 without PyYAML (Debian's package python3-yaml).
  run_action.py [--workspace DIR] [NAME=VALUE of an input]..."""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
GITHUB = {"runner.os": "Linux", "runner.arch": "X64", "github.run_id": "1", "github.job": "test"}


class Run:
    def __init__(self, action, given, workspace):
        unknown = set(given) - set(action["inputs"])
        if unknown:
            raise ValueError(f"unknown input {sorted(unknown)[0]}; there are {', '.join(action['inputs'])}")
        self.values = dict(GITHUB)
        for name, description in action["inputs"].items():
            if description.get("required") and name not in given:
                raise ValueError(f"the input {name} is missing")
            self.values[f"inputs.{name}"] = given.get(name, description.get("default", ""))
        self.action, self.workspace = action, workspace
        self.status, self.path = 0, os.environ["PATH"]

    def value(self, name):
        if re.fullmatch(r"steps\.\w+\.outputs\.\w+", name):
            return self.values.get(name, "")  # empty for a step that did not run
        return self.values[name]

    def text(self, template):
        return re.sub(r"\$\{\{ (.*?) \}\}", lambda found: self.value(found[1]), str(template))

    def runs(self, condition):
        """Whether a step runs: all terms joined by && must hold. After a failed step, one of them must be always()."""
        terms = condition.split(" && ") if condition else []
        for term in terms:
            if term != "always()":
                name, relation, text = re.fullmatch(r"([\w.-]+) (==|!=) '(.*)'", term).groups()
                if (self.value(name) == text) != (relation == "=="):
                    return False
        return self.status == 0 or "always()" in terms

    def step(self, step):
        if not self.runs(step.get("if")):
            return
        if "uses" in step:
            inputs = {key: self.text(value) for key, value in step["with"].items()}
            print(f"== {step['name']}: not run here: {step['uses']} {inputs}", flush=True)
            return
        if step["shell"] != "bash":
            raise ValueError(f"{step['name']}: only bash is supported here")
        print(f"== {step['name']}", flush=True)
        with tempfile.TemporaryDirectory() as folder:
            outputs, paths = pathlib.Path(folder, "outputs"), pathlib.Path(folder, "paths")
            outputs.touch()
            paths.touch()
            environment = {
                **os.environ,
                **{name: self.text(value) for name, value in step.get("env", {}).items()},
                "PATH": self.path,
                "GITHUB_ACTION_PATH": str(ROOT),
                "GITHUB_WORKSPACE": str(self.workspace),
                "GITHUB_OUTPUT": str(outputs),
                "GITHUB_PATH": str(paths),
            }
            command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", self.text(step["run"])]
            status = subprocess.run(command, cwd=self.workspace, env=environment, check=False).returncode
            self.status = self.status or status
            self.path = os.pathsep.join([*reversed(paths.read_text().split()), self.path])
            several = r"(\w+)<<(\w+)\n(.*?)\n\2\n"
            text = outputs.read_text()
            for name, _, lines in re.findall(several, text, re.S):
                self.values[f"steps.{step['id']}.outputs.{name}"] = lines
            for name, line in re.findall(r"^(\w+)=(.*)$", re.sub(several, "", text, flags=re.S), re.M):
                self.values[f"steps.{step['id']}.outputs.{name}"] = line

    def all(self):
        for step in self.action["runs"]["steps"]:
            self.step(step)
        return self.status


def main():
    try:
        import yaml
    except ImportError:
        print("run_action: SKIPPED: PyYAML is not installed (Debian's package python3-yaml)")
        return 77
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workspace", type=pathlib.Path, default=pathlib.Path.cwd())
    parser.add_argument("inputs", nargs="*", metavar="NAME=VALUE")
    arguments = parser.parse_args()
    action = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
    return Run(action, dict(given.split("=", 1) for given in arguments.inputs), arguments.workspace).all()


if __name__ == "__main__":
    sys.exit(main())
