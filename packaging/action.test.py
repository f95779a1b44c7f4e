# SPDX-License-Identifier: Apache-2.0
"""Runs the steps of action.yml in order, in a fresh folder with an empty HOME. They must fail for code with a bug, show
its smallest pair and write JUnit XML; they must pass for correct code. For each wrong input, the message must say what
to do. Argument: the graze program."""
import contextlib
import hashlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

from run_action import Run

ROOT = pathlib.Path(__file__).parent.parent
GRAZE = pathlib.Path(sys.argv.pop()).resolve()
BUGGY = "int meet(const float a[9], const float b[9]) { return a[0] <= b[0] + 100; }\n"
# This code is correct in every build except the one with -ffast-math, whose lanes the input `lanes` leaves out.
RIGHT = """#ifdef __FAST_MATH__
bool meet(const float*, const float*) { return false; }
#else
#include "core/exact/exact.h"
bool meet(const float a[9], const float b[9]) { return graze::exact::intersects(a, b); }
#endif
"""


class Action(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.home, self.workspace = pathlib.Path(folder, "home"), pathlib.Path(folder, "work")
        self.home.mkdir()
        self.workspace.mkdir()
        self.environment = {"HOME": str(self.home), "PATH": f"{GRAZE.parent}:{os.environ['PATH']}", "LANG": "C.UTF-8"}

    def act(self, status, **inputs):
        words = [f"{name.replace('_', '-')}={value}" for name, value in inputs.items()]
        command = [sys.executable, "-B", ROOT / "packaging/run_action.py", "--workspace", self.workspace, *words]
        ran = subprocess.run(command, env=self.environment, capture_output=True, text=True)
        if ran.returncode == 77:
            self.skipTest(ran.stdout)
        self.assertEqual(ran.returncode, status, ran.stdout + ran.stderr)
        return ran.stdout

    def write(self, name, text):
        (self.workspace / name).write_text(text, encoding="utf-8")

    def expect_wrong(self, pair):
        self.write("pair.txt", pair + "\n")
        command = "graze check pair.txt --subject subject=buggy.c:meet --lanes subject/f32/cpu"
        ran = subprocess.run(command.split(), cwd=self.workspace, env=self.environment, capture_output=True, text=True)
        self.assertRegex(ran.stdout, r"subject/f32 .*!")

    def test_a_planted_bug_fails_with_its_smallest_pair(self):
        self.write("buggy.c", BUGGY)
        said = self.act(1, subject="buggy.c:meet", pairs="4200")
        self.expect_wrong(re.search(r"::error::.* the smallest is ((?:\S+ ){17}[^\s;]+);", said)[1])
        suites = xml.etree.ElementTree.parse(self.workspace / "graze/junit.xml").getroot()
        lanes = {suite.get("name"): suite for suite in suites}
        self.assertEqual(lanes["exact/f32/cpu"].get("failures"), "0")
        failures = lanes["subject/f32/cpu"].findall("testcase/failure")
        self.assertGreater(len(failures), 10)
        self.expect_wrong(re.search(r"such as (.*)", failures[0].get("message"))[1])
        for file in re.search(r"upload-artifact\S* \{.*'path': '(.*?)'", said)[1].split(r"\n"):
            self.assertTrue((self.workspace / file).exists(), file)

    def test_fail_above_accepts_so_many_wrong_pairs(self):
        self.write("buggy.c", BUGGY)
        self.act(0, subject="buggy.c:meet", pairs="2100", strata="shared_*", lanes="subject/f32/cpu", fail_above="2100")

    def test_right_code_passes(self):
        self.write("right.cpp", RIGHT)
        flags, lanes = f"-std=c++20 -I{ROOT}", "mine/f32/cpu"
        said = self.act(0, subject="mine=right.cpp:meet", flags=flags, lanes=lanes, pairs="2100", out="results")
        self.assertIn("results/junit.xml", said)
        text = (self.workspace / "results/junit.xml").read_text()
        self.assertIn('<testsuite name="mine/f32/cpu" tests="21" failures="0"', text)
        said = self.act(1, subject="mine=right.cpp:meet", flags=flags, pairs="2100")
        self.assertIn("::error::graze: mine is wrong on ", said)

    def test_the_time_limit_fails(self):
        self.write("buggy.c", BUGGY)
        said = self.act(1, subject="buggy.c:meet", pairs="900000000", minutes="0.03")
        self.assertIn("::error::graze: the campaign did not end within 0.03 minutes", said)
        self.assertNotIn("upload-artifact", said)

    def test_wrong_inputs_are_named(self):
        self.write("buggy.c", BUGGY)
        for inputs, words in (
            ({"minutes": "0"}, "minutes: expected a number above 0, found '0'"),
            ({"strata": "no_such"}, "no stratum matches 'no_such'"),
            ({"pairs": "many"}, "many"),
        ):
            with self.subTest(inputs):
                self.assertRegex(self.act(2, subject="buggy.c:meet", **inputs), f"::error::graze: .*{words}")
        self.assertRegex(self.act(1, subject="none.c:meet"), "::error::graze: .*none.c.*No such file")
        said = self.act(1, subject="buggy.c:meet", flags="--no-such-flag")
        self.assertRegex(said, "::error::graze: cannot compile .*--no-such-flag")

    def test_packages_that_are_not_the_right_ones_are_refused(self):
        said = self.act(1, subject="buggy.c:meet", deb="none.deb")
        self.assertIn("::error::graze: cannot read none.deb", said)
        self.write("graze.deb", "not the package")
        said = self.act(1, subject="buggy.c:meet", deb="graze.deb", sha256=hashlib.sha256(b"").hexdigest())
        self.assertIn("does not have the checksum", said)


class Steps(unittest.TestCase):
    """run_action.py rejects steps that no CI service would run. The other tests rely on that."""

    def test_each_step_names_what_exists(self):
        inputs = {"a": {"default": "x"}}
        step = {"name": "s", "shell": "bash", "run": "exit 3"}
        quiet = io.StringIO()
        with contextlib.redirect_stdout(quiet):
            run = lambda *steps: Run({"inputs": inputs, "runs": {"steps": steps}}, {}, ROOT).all()
            self.assertEqual(run(step, {**step, "run": "exit 4"}), 3)
            self.assertEqual(run({**step, "if": "inputs.a != 'x'"}), 0)
            self.assertRaises(KeyError, run, {**step, "env": {"A": "${{ inputs.b }}"}})
            self.assertRaises(ValueError, Run, {"inputs": inputs}, {"b": "1"}, ROOT)


if __name__ == "__main__":
    unittest.main()
