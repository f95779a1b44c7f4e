# SPDX-License-Identifier: Apache-2.0
"""The table of scripts/league, the adapters and their README agree. The four pairs detect wrong uses of a library."""
import pathlib
import subprocess
import tempfile
import unittest

from loaded import loaded

league = loaded("league")

SUBJECT = """#include <graze/subject.h>
#include <stdlib.h>
static int decide(const double a[9], const double b[9]) { (void)a, (void)b; %s; }
GRAZE_SUBJECT(stub) = {.abi = GRAZE_SUBJECT_ABI, .version = "7", .f64 = decide};
"""


class League(unittest.TestCase):
    def what_is_said_of(self, body):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "stub.c")
            source.write_text(SUBJECT % body, encoding="utf-8")
            subprocess.run(
                ["gcc", "-shared", "-fPIC", f"-I{league.ROOT}/subjects/include", source, "-o", f"{folder}/stub.so"],
                check=True,
            )
            try:
                return league.check(f"{folder}/stub.so:stub")
            except league.LeftOut as why:
                return f"left out: {why}"

    def test_the_four_pairs(self):
        right = "b[0] < 9"
        self.assertEqual(self.what_is_said_of(f"return {right}"), "7  f64: touching yes, coplanar yes")
        self.assertEqual(self.what_is_said_of(f"return b[2] == 0 ? 0 : {right}"), "7  f64: touching no, coplanar no")
        self.assertEqual(self.what_is_said_of(f"return b[2] == 0 ? -1 : {right}"), "7  f64: touching ?, coplanar ?")
        self.assertIn(
            "left out: wrong use of the library, or unusable: f64 answers 1 to the pair that is apart",
            self.what_is_said_of("return 1"),
        )
        self.assertIn("f64 answers 0 to the pair that is crossing", self.what_is_said_of("return 0"))
        self.assertIn("left out: crashed", self.what_is_said_of("abort()"))

    def test_every_adapter_is_in_the_table_and_in_the_readme(self):
        files = {path.name for path in league.SOURCES.iterdir()} - {"README.md"}
        self.assertEqual({adapter for _, adapter, _, _ in league.ADAPTERS}, files)
        readme = (league.SOURCES / "README.md").read_text(encoding="utf-8")
        for name in files:
            self.assertIn(f"`{name}`", readme)
            self.assertLessEqual(len((league.SOURCES / name).read_text(encoding="utf-8").splitlines()), 60, name)

    def test_notes_are_of_subjects_and_of_kinds_that_graze_reads(self):
        names = {adapter[0] for adapter in league.ADAPTERS}
        for row, notes in league.NOTES.items():
            self.assertTrue(any(row == name or row.startswith(name + "_") for name in names), row)
            for note in notes:
                self.assertRegex(note, r"^(version|source|convention): .+|^pairs: [1-9][0-9]*$")


if __name__ == "__main__":
    unittest.main()
