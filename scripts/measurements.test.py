# SPDX-License-Identifier: Apache-2.0
"""docs/measurements.md is the output of scripts/measurements.py for the records. Each record has the right keys, with
the right types. Docs.CommitsThatTheyNameAreInTheHistory checks the commits."""
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import measurements  # noqa: E402

# A file of records with every allowed key, oldest run first.
SPEED = """title = "Speed"
about = "How fast."

[[run]]
machine = "m"
toolkit = "t"
commit = "aaaaaaa"
date = 2026-01-01
command = "`old`"
unit = "s"
results = [{metric = "a", value = 3}, {metric = "b", value = 1_500}]

[[run]]
machine = "m"
toolkit = "t"
by = "bbbbbbb"
date = 2026-01-02
command = "`new`"
before = "ccccccc"
unit = "s"
note = "A note."
results = [
  {metric = "a", value = [1.50, 2], limit = 1},
  {metric = "c", value = 0.00001, unit = "10^9 pairs/s", baseline = 7},
]
[run.grid]
metric = "g"
rows = "row"
columns = ["x", "y"]
[run.grid.cells]
"r" = [4, ""]
"""
SECTION = """
## Speed
How fast.

| metric | value | before | limit | machine | commit | how |
|---|---:|---:|---:|---|---|---|
| a | 1.50 to 2 s | 3 | 1 | m | by `bbbbbbb` | 2 |
| b | 1,500 s |  |  | m | `aaaaaaa` | 1 |
| c | 0.00001 × 10^9 pairs/s | 7 |  | m | by `bbbbbbb` | 2 |

**g**, s (m, by `bbbbbbb`, how: 2)

| row | x | y |
| --- | ---: | ---: |
| r | 4 |  |

How:
1. `old`; t; 2026-01-01.
2. `new`; t; 2026-01-02. Before: `ccccccc`. A note.
"""


class Measurements(unittest.TestCase):
    def rendered(self, speed, machines='m = "a machine"\n'):
        with tempfile.TemporaryDirectory() as folder:
            for topic in measurements.TOPICS:
                pathlib.Path(folder, f"{topic}.toml").write_text(speed, encoding="utf-8")
            pathlib.Path(folder, "machines.toml").write_text(machines, encoding="utf-8")
            return measurements.render(pathlib.Path(folder))

    def test_the_page_agrees_with_the_records(self):
        self.assertEqual(
            measurements.PAGE.read_text(encoding="utf-8").splitlines(),
            measurements.render().splitlines(),
            "docs/measurements.md and docs/measurements/ differ: run python3 scripts/measurements.py",
        )

    def test_the_page_shows_the_newest_value_the_one_before_and_the_limit(self):
        page = self.rendered(SPEED)
        self.assertIn("| m | a machine |\n", page)
        self.assertEqual(page[page.index("\n## Speed") :], SECTION * len(measurements.TOPICS))

    def test_a_changed_record_changes_the_page(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder, "records")
            shutil.copytree(measurements.RECORDS, copy)
            self.assertEqual(measurements.render(copy), measurements.render())
            for path, old, new in (
                ("exact.toml", "value = 38.3,", "value = 38.4,"),
                ("invariants.toml", "[2.86, 20.4,", "[2.86, 20.5,"),
                ("machines.toml", "16 cores", "17 cores"),
            ):
                text = (copy / path).read_text(encoding="utf-8")
                self.assertIn(old, text)
                (copy / path).write_text(text.replace(old, new, 1), encoding="utf-8")
                self.assertNotEqual(measurements.render(copy), measurements.render(), path)
                (copy / path).write_text(text, encoding="utf-8")

    def test_a_record_that_is_not_whole_is_refused(self):
        for old, new, message in (
            ('machine = "m"\n', "", "run 1, a: `machine` is missing"),
            ('command = "`old`"\n', "", "run 1, a: `command` is missing"),
            ('toolkit = "t"', 'toolkit = ""', "`toolkit` is ''; it must be str"),
            ("date = 2026-01-01", 'date = "2026-01-01"', "`date` is '2026-01-01'; it must be date"),
            ("date = 2026-01-01", "date = 2026-01-03", "in the order of their dates"),
            ('commit = "aaaaaaa"', 'commit = "the last"', "is no abbreviated commit"),
            ('commit = "aaaaaaa"\n', "", "needs `commit` or `by`, and not both"),
            ('by = "bbbbbbb"', 'by = "bbbbbbb"\ncommit = "bbbbbbb"', "run 2: needs `commit` or `by`, and not both"),
            ('machine = "m"', 'machine = "n"', "machine 'n' is not in machines.toml"),
            ('unit = "s"\nresults', "results", "run 1, a: `unit` is missing"),
            ("value = 3", 'value = "3"', "run 1, a: `value` is '3'; it must be a number or [low, high]"),
            ("value = 3", "value = [1, 2, 3]", "it must be a number or [low, high]"),
            ("value = 3", "value = true", "it must be a number or [low, high]"),
            ("value = 3", "valeu = 3", "run 1, a: `value` is missing"),
            ("limit = 1", "limits = 1", "unknown key `limits`"),
            ('metric = "b"', 'metric = "a"', "'a' is measured twice in one run"),
            ('"r" = [4, ""]', '"r" = [4]', "r or the units are not as many as the 2 columns"),
            ('"r" = [4, ""]', '"r" = [4, "5"]', "run 2, g, r: y: `value` is '5'"),
            ('rows = "row"\n', "", "run 2, grid: `rows` is missing"),
            ('results = [{metric = "a", value = 3}, {metric = "b", value = 1_500}]', "", "run 1: has neither"),
        ):
            self.assertIn(old, SPEED)
            with self.assertRaises(measurements.Malformed) as refused:
                self.rendered(SPEED.replace(old, new, 1))
            self.assertIn(message, str(refused.exception))

    def test_a_file_that_no_section_shows_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder, "records")
            shutil.copytree(measurements.RECORDS, copy)
            shutil.copy(copy / "exact.toml", copy / "more.toml")
            with self.assertRaisesRegex(measurements.Malformed, "differ by .'more'"):
                measurements.render(copy)

    def test_what_other_documents_link_is_a_section(self):
        sections = {
            re.sub(r"[^a-z0-9 -]", "", line[3:].lower()).replace(" ", "-")
            for line in measurements.PAGE.read_text(encoding="utf-8").splitlines()
            if line.startswith("## ")
        }
        links = [
            link
            for page in measurements.DOCS.glob("*.md")
            for link in re.findall(r"\(measurements\.md#([^)]*)\)", page.read_text(encoding="utf-8"))
        ]
        self.assertTrue(links)
        for link in links:
            self.assertIn(link, sections)


if __name__ == "__main__":
    unittest.main()
