# SPDX-License-Identifier: Apache-2.0
"""scripts/format --check names the files that are not formatted. It fails if it cannot parse a file, and if it finds no
files.

  format.test.py [BUILD]   BUILD: the build tree that has prettier, default build
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parent.parent
BUILD = sys.argv.pop(1) if len(sys.argv) > 1 else str(PROJECT / "build")
GOOD = {
    "a.cpp": "int f() { return 1; }\n",
    "b.cu": "int g();\n",
    "tool": "#!/usr/bin/env python3\nprint(1)\n",
    "c.mjs": "f('x');\n",
}
BAD = {
    "a.cpp": "int f(){return 1;}\n",
    "b.cu": "int  g();\n",
    "tool": "#!/usr/bin/env python3\nprint( 1 )\n",
    "c.mjs": 'f("x")\n',
}


class Format(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.root / "scripts").mkdir()
        for file in ("scripts/format", ".clang-format", ".prettierrc.json", "pyproject.toml"):
            shutil.copy(PROJECT / file, self.root / file)
        subprocess.run(["git", "init", "-q"], cwd=self.root, check=True)

    def write(self, files):
        for name, text in files.items():
            (self.root / name).write_text(text)

    def format(self, *arguments, path=None):
        environment = os.environ | ({"PATH": path} if path else {})
        run = subprocess.run(
            [self.root / "scripts/format", "--build", BUILD, *arguments],
            env=environment,
            text=True,
            capture_output=True,
        )
        return run.returncode, run.stdout + run.stderr

    def need_all(self):
        code, said = self.format("--check")
        if code == 77:
            self.skipTest(said.strip())

    def test_names_what_is_not_formatted_and_mends_it(self):
        self.write(GOOD)
        self.need_all()
        self.assertEqual(self.format("--check")[0], 0)
        for name in BAD:
            self.write(GOOD | {name: BAD[name]})
            code, said = self.format("--check")
            self.assertEqual((code, said.splitlines()[0]), (1, f"not formatted: {name}"))
            self.assertEqual((self.root / name).read_text(), BAD[name])
        self.write(BAD)
        self.assertEqual(self.format()[0], 0)
        self.assertEqual({name: (self.root / name).read_text() for name in GOOD}, GOOD)

    def test_fails_on_what_it_cannot_read(self):
        self.write(GOOD)
        self.need_all()
        for name, text in (("tool", "#!/usr/bin/env python3\nprint(\n"), ("c.mjs", "f(\n")):
            self.write(GOOD | {name: text})
            code, said = self.format("--check")
            self.assertEqual(code, 1)
            self.assertIn(name, said)

    def test_fails_on_nothing_to_check(self):
        self.assertEqual(self.format("--check")[0], 1)

    def test_names_the_formatters_that_are_missing(self):
        self.write(GOOD)
        bare = self.root / "bin"
        bare.mkdir()
        for tool in ("bash", "env", "git", "grep", "sed", "sort", "nproc", "xargs", "dirname"):
            (bare / tool).symlink_to(shutil.which(tool))
        code, said = self.format("--check", path=str(bare))
        self.assertEqual(code, 77)
        for formatter in ("clang-format 14", "black 23", "prettier"):
            self.assertIn(f"{formatter} is missing", said)


if __name__ == "__main__":
    unittest.main()
