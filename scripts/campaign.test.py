# SPDX-License-Identifier: Apache-2.0
"""The sources compile in the build of scripts/campaign. Its unity groups are larger than those of other builds, so
private names of different files may clash only there. Checks each group's syntax in a separate build; generates no
code."""
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).parent.parent
COMPILER, BUILT = sys.argv.pop(), sys.argv.pop()


def run(*command, **options):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)


def syntax_only(command, build):
    """The compiler's command without outputs, optimisation and precompiled headers. Generated files come from another
    build."""
    kept, words = [], iter(shlex.split(command.replace(f"{build}/generated", f"{BUILT}/generated")))
    for word in words:
        if word in ("-o", "-MF", "-MT", "-include"):
            next(words)
        elif word != "-MD" and not word.startswith("-O"):
            kept.append(word)
    return [*kept, "-fsyntax-only"]


class CampaignBuild(unittest.TestCase):
    def test_sources_compiled_together_have_no_clashing_names(self):
        with tempfile.TemporaryDirectory() as build:
            options = ["-DGRAZE_CAMPAIGN=ON", f"-DCMAKE_CXX_COMPILER={COMPILER}", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"]
            configured = run("cmake", "--preset=release", "-B", build, *options, cwd=ROOT)
            self.assertEqual(configured.returncode, 0, configured.stderr)
            needed = set(run("ninja", "-C", build, "-t", "inputs", "bin/graze").stdout.split())
            entries = json.loads(pathlib.Path(build, "compile_commands.json").read_text(encoding="utf-8"))
            groups = [entry for entry in entries if "/Unity/" in entry["file"] and entry["file"] in needed]
            self.assertGreaterEqual(len(groups), 5)
            with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as workers:
                ran = workers.map(
                    lambda entry: run(*syntax_only(entry["command"], build), cwd=entry["directory"]), groups
                )
                for entry, result in zip(groups, ran):
                    with self.subTest(entry["file"]):
                        self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
