# SPDX-License-Identifier: Apache-2.0
"""scripts/findings accepts only pages that show their program's output. Every page of docs/findings has all parts."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

from loaded import loaded

SCRIPT = pathlib.Path(__file__).with_name("findings")
PAGES = SCRIPT.parent.parent / "docs/findings"
PAGE = """# t
**Packages:** `g++`

```cpp
// g++ stub.cpp -o stub && ./stub
#include <cstdio>
int main() {{ std::puts("{prints}"); }}
```

```text
{says}
```
"""

JS_PAGE = """**Packages:** `nodejs npm`
**npm:** `{npm}`

```js
// node stub.mjs
the program
```

```text
{says}
```
"""
# Stand-ins: npm records what it installs, or prints a setting; node prints that record, then the text of its program.
NPM = """case $1 in
  config) echo "the $3 of npm" ;;
  install) shift; case "$*" in *missing*) echo "no such package"; exit 1 ;; esac; mkdir node_modules && echo "$@" > node_modules/installed ;;
esac
"""
NODE = 'cat node_modules/installed; tail -n +2 "$1"\n'


class Findings(unittest.TestCase):
    def checked(self, text, programs={}):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder, "stub.md")
            page.write_text(text, encoding="utf-8")
            path = self.path_with(folder, programs)
            return subprocess.run(
                [sys.executable, SCRIPT, "--here", page],
                capture_output=True,
                text=True,
                check=False,
                env={**os.environ, "PATH": path},
            )

    def path_with(self, folder, programs):
        for name, text in programs.items():
            program = pathlib.Path(folder, name)
            program.write_text("#!/bin/sh\n" + text, encoding="utf-8")
            program.chmod(0o755)
        return f"{folder}:{os.environ['PATH']}"

    def test_a_page_is_held_to_what_it_says(self):
        right = self.checked(PAGE.format(prints="1", says="1"))
        self.assertEqual(
            (right.returncode, right.stdout),
            (0, "as said  stub, with g++\n1 of 1 programs print what their pages say\n"),
        )
        wrong = self.checked(PAGE.format(prints="1", says="2"))
        self.assertEqual(wrong.returncode, 1)
        self.assertIn("WRONG    stub, with g++\nexpected:\n2\nprinted:\n1\n", wrong.stdout)
        broken = self.checked(PAGE.format(prints='";', says="1"))
        self.assertEqual(broken.returncode, 1)
        self.assertIn("error", broken.stdout)

    def test_a_page_without_a_program_or_packages_is_refused(self):
        for missing in ("**Packages:**", "```cpp", "```text"):
            refused = self.checked(PAGE.format(prints="1", says="1").replace(missing, ""))
            self.assertEqual(refused.returncode, 1)
            self.assertIn("has 0 times", refused.stderr)

    def test_a_javascript_page_gets_its_npm_packages(self):
        stubs = {"npm": NPM, "node": NODE}
        npm = "some@1.2.3 @scope/other@4.5.6"
        says = f"--no-save --no-audit --no-fund {npm}\nthe program"
        right = self.checked(JS_PAGE.format(npm=npm, says=says), stubs)
        self.assertEqual(
            (right.returncode, right.stdout),
            (0, f"as said  stub, with nodejs npm {npm}\n1 of 1 programs print what their pages say\n"),
        )
        self.assertEqual(self.checked(JS_PAGE.format(npm=npm, says="another"), stubs).returncode, 1)
        missing = self.checked(JS_PAGE.format(npm="missing@1.2.3", says=says), stubs)
        self.assertEqual(missing.returncode, 1)
        self.assertIn("no such package", missing.stderr)
        self.assertIn("nothing: it was not run", missing.stdout)

    def test_npm_packages_without_an_exact_version_are_refused(self):
        for npm in ("some", "some@latest", "some@^1.2.3", "some@1.2"):
            refused = self.checked(JS_PAGE.format(npm=npm, says=""))
            self.assertEqual(refused.returncode, 1)
            self.assertIn(f"names '{npm}' for npm", refused.stderr)

    def test_the_fresh_system_gets_the_registry_of_this_machine(self):
        with tempfile.TemporaryDirectory() as folder:
            path = self.path_with(folder, {"npm": NPM})
            with unittest.mock.patch.dict(os.environ, PATH=path):
                self.assertEqual(loaded("findings").registry(), "export npm_config_registry='the registry of npm'\n")
        with unittest.mock.patch.dict(os.environ, PATH=""):
            self.assertEqual(loaded("findings").registry(), "")

    def test_every_page_has_its_parts(self):
        pages = list(PAGES.glob("*.md"))
        self.assertTrue(pages)
        for page in pages:
            text = page.read_text(encoding="utf-8")
            for part in (
                "This report has not been sent to the library's authors.",
                "**Smallest case**",
                "**Expected:**",
                "**Found:**",
                "**Version:**",
                "**Packages:** `",
                "**Cause:**",
                "**How often:**",
            ):
                self.assertIn(part, text, page.name)
            self.assertRegex(
                text, rf"```cpp\n// g\+\+ -O2 {page.stem}\.cpp |```js\n// node {page.stem}\.mjs\n", page.name
            )


if __name__ == "__main__":
    unittest.main()
