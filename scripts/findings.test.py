# SPDX-License-Identifier: Apache-2.0
"""scripts/findings accepts only a page that shows its program's output. Every page of docs/findings has all parts."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

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


class Findings(unittest.TestCase):
    def checked(self, text):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder, "stub.md")
            page.write_text(text, encoding="utf-8")
            return subprocess.run([sys.executable, SCRIPT, "--here", page], capture_output=True, text=True, check=False)

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

    def test_every_page_has_its_parts(self):
        pages = list(PAGES.glob("*.md"))
        self.assertTrue(pages)
        for page in pages:
            text = page.read_text(encoding="utf-8")
            for part in (
                "Not sent anywhere",
                "**Smallest case**",
                "**Expected:**",
                "**Found:**",
                "**Version:**",
                "**Packages:** `g++ ",
                "**Cause:**",
                "```cpp\n// g++",
            ):
                self.assertIn(part, text, page.name)


if __name__ == "__main__":
    unittest.main()
