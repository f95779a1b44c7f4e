# SPDX-License-Identifier: Apache-2.0
"""results.test.py [GRAZE]: docs/results is the output of scripts/results for the records. Each number on it comes from
a record, and the records agree with the pages and data that they were taken from. With GRAZE, the web site is also
written, and its texts about pairs are compared with the verdicts of the lanes."""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent
GRAZE = pathlib.Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else None
import measurements  # noqa: E402
from presenting import figures, page, records, site  # noqa: E402
from presenting.page import RESULTS, results  # noqa: E402
from presenting.records import BEGIN, END, Records, Unsupported, digits, plain  # noqa: E402

DOCS = ROOT / "docs"
# Digits and words that are not measured numbers: names, definitions, and the confidence of every interval.
NAMES = re.compile(
    r"float(32|64)|2012|ARM64|x86-64|x87|95 %|H[12]00|Debian 12|C\+\+|2\^12 ulps|ulps?\b|3-D|GTX 590|8800 GT"
    r"|one rounding|one core|one pair|moller_1997|guigue_devillers_2003|Open3D|3d"
)
NUMBER = re.compile(
    r"[0-9]+|\b(one|two|three|four|five|six|seven|eight|nine|ten|eleven|twelve|fifteen|half|third|quarter|twice)\b"
)


class Traced(Records):
    """`values` has the requested values. Values in `changed` replace these, by topic, metric and key."""

    def __init__(self):
        super().__init__()
        self.values, self.changed = {}, {}

    def __call__(self, topic, metric, key="value"):
        value = self.values[(topic, metric, key)] = super().__call__(topic, metric, key)
        return self.changed.get((topic, metric, key), value)


def unbacked(text):
    """Returns: the numbers of a marked text without a record; code and link targets do not count."""
    text = re.sub(f"{BEGIN}[^{END}]*{END}", " ", text)
    text = re.sub(r"`[^`]*`|\]\([^)]*\)", " ", text)
    return [found.group() for found in NUMBER.finditer(NAMES.sub(" ", text))]


def written():
    return page.files(results(Records()))


def table(path, after, head):
    """Returns: {row: {column: cell}} of the first table whose text begins with `head`, after the text `after`."""
    text = (DOCS / path).read_text(encoding="utf-8")
    text = text[text.index(after) :]
    lines = text[text.index(head) :].splitlines()
    cells = lambda line: [cell.strip() for cell in line.strip("|").split("|")]
    columns, found = cells(lines[0]), {}
    for line in lines[2:]:
        if not line.startswith("|"):
            break
        row = cells(line)
        found[row[0]] = dict(zip(columns, row))
    return found


class Page(unittest.TestCase):
    def test_it_agrees_with_the_records(self):
        for name, text in written().items():
            self.assertEqual(page.read(DOCS / "results" / name), text, f"docs/results/{name}: run scripts/results")
        figures_there = {path.name for path in (DOCS / "results").glob("*.svg")}
        self.assertEqual(figures_there, {name for name in written() if name.endswith(".svg")})

    def test_check_names_the_files_that_are_older_than_their_records(self):
        check = lambda root: subprocess.run(
            [sys.executable, "-B", root / "scripts/results", "--check"], capture_output=True, text=True, check=False
        )
        self.assertEqual(check(ROOT).returncode, 0, check(ROOT).stderr)
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder)
            for part in ("scripts/presenting", "docs/results", "docs/measurements"):
                shutil.copytree(ROOT / part, copy / part)
            for part in ("results", "measurements.py", "verdicts_apart.py"):
                shutil.copy(HERE / part, copy / "scripts" / part)
            record = copy / "docs/measurements/agreement.toml"
            text = record.read_text(encoding="utf-8")
            self.assertIn("value = 6_118}", text)
            record.write_text(text.replace("value = 6_118}", "value = 6_218}"), encoding="utf-8")
            stale = check(copy)
            self.assertEqual(stale.returncode, 1)
            self.assertIn("docs/results/README.md", stale.stderr)
            self.assertIn("docs/results/riddle.svg", stale.stderr)
            self.assertNotIn("epsilon.svg", stale.stderr)

    def test_each_number_comes_from_a_record(self):
        self.assertLessEqual(len(RESULTS), 10)
        labels = []
        with mock.patch.object(figures, "escape", side_effect=lambda words: words):
            with mock.patch.object(figures, "plain", side_effect=lambda words: labels.append(words) or plain(words)):
                found = results(Records())
        for result in found:
            for text in (result.headline, result.paragraph, result.alt):
                self.assertEqual(unbacked(text), [], text)
            self.assertRegex(result.headline, BEGIN)
        self.assertGreater(len(labels), 100)
        ticks = re.compile(r"[0-9,.]+( %)?|2[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+")
        for label in labels:
            self.assertEqual([] if ticks.fullmatch(label) else unbacked(label), [], label)
        self.assertEqual(unbacked(page.HEAD) + unbacked(page.TAIL), [])

    def test_a_number_without_a_record_is_found(self):
        self.assertEqual(
            unbacked(f"on {records.count(12)} of seven pairs, 7.1 %, about a third"), ["seven", "7", "1", "third"]
        )
        self.assertEqual(unbacked("float32 and `moller_1997/f32`, [2012](2012.md), 95 %"), [])

    def test_each_value_that_is_used_is_shown_or_checked(self):
        before, changed = Traced(), Traced()
        results(before)
        self.assertGreater(len(before.values), 150)
        now = written()
        for key, value in before.values.items():
            more = [x * 2 + 1 for x in value] if isinstance(value, list) else value * 2 + 1
            less = [x / 1000 for x in value] if isinstance(value, list) else value / 1000
            noticed = False
            for other in (more, less):
                changed.changed = {key: other}
                try:
                    noticed = noticed or page.files(results(changed)) != now
                except Unsupported:
                    noticed = True
            self.assertTrue(noticed, key)

    def test_bounds_are_rounded_outward(self):
        self.assertEqual(digits(3186.2, towards=math.floor), "3,180")
        self.assertEqual(digits(3353.1, towards=math.ceil), "3,360")
        self.assertEqual(digits(0.0072983, 2, math.ceil), "0.0073")
        self.assertEqual(digits(99.96), "100.0")
        self.assertEqual(plain(records.one_in(6118, 20_000_000)), "1 in 3,270")
        self.assertEqual(plain(records.one_in_interval(6118, 20_000_000)), "1 in 3,360 to 1 in 3,180")


class Sources(unittest.TestCase):
    """Records that were taken from a page or a file agree with that source."""

    def setUp(self):
        self.records = Records()

    def cells(self, topic, metric):
        """{row: {column: value}} of a grid."""
        grids = [run["grid"] for run in measurements.read()[1][topic]["run"] if "grid" in run]
        grid = next(grid for grid in grids if grid["metric"] == metric)
        return {row: dict(zip(grid["columns"], values)) for row, values in grid["cells"].items()}

    def test_default_campaign(self):
        data = json.loads((ROOT / "reports/published/default.json").read_text(encoding="utf-8"))
        lanes = [lane["id"] for lane in data["lanes"]]
        groups = [group["id"] for group in data["groups"]]
        strata = [stratum["id"] for stratum in data["strata"]]
        found = {}
        for rate in data["group_rates"]:
            found.setdefault(lanes[rate["lane"]], {})[groups[rate["group"]]] = rate["wrong"]
        for rate in data["rates"]:
            stratum = "all" if rate["stratum"] is None else strata[rate["stratum"]]
            if stratum not in ("uniform", "all"):
                continue  # other strata may have the same name as a group
            found[lanes[rate["lane"]]][stratum] = rate["wrong"]
            if stratum == "all" and rate["differs_from_cpu"]:
                found[lanes[rate["lane"]]]["other than `cpu`"] = rate["differs_from_cpu"]
        grid = self.cells("campaign", "Wrong verdicts of the default campaign")
        self.assertEqual(len(grid), 32)
        pairs = grid.pop("pairs")
        for lane, columns in grid.items():
            for column, value in columns.items():
                if value != "":
                    its = found[lane.strip("`")][column]
                    self.assertEqual((value, pairs[column]), (its["count"], its["of"]), (lane, column))

    def test_toolchains(self):
        shown = table("results/toolchains.md", "", "| lane |")
        grid = self.cells("toolchains", "Verdicts of a toolchain, of 1,000,020 pairs of all strata")
        self.assertEqual((len(shown), grid.keys()), (10, shown.keys()))
        for lane, columns in grid.items():
            for column, value in columns.items():
                toolchain, what = column.split(", ")
                of_both = [float(x) for x in shown[lane][toolchain].split("/")]
                self.assertEqual(float(value), of_both[0 if what == "differs" else -1], (lane, column))
        text = (DOCS / "results/toolchains.md").read_text(encoding="utf-8")
        self.assertIn("give the same verdicts (ARM64: on 10,006,500 pairs per lane)", text)

    def test_hosts_of_2012(self):
        of = "Pairs for one verdict that differs, of 10,000,000 with the reference of "
        for which, after in (("random triangles", "of the **random**"), ("special cases", "of the **special cases**:")):
            shown, grid = table("results/2012.md", after, "| | `cpu`"), self.cells("hosts_2012", of + which)
            self.assertEqual((len(shown), grid.keys()), (11, shown.keys()))
            for device, hosts in shown.items():
                for host in ("`cpu`", "`x87`", "`x87-O0`"):
                    value, interval = grid[device][host], grid[device][f"{host}, interval"]
                    text = "0 (over 2,603,178)" if value == "" else f"{value:,} ({interval[0]:,} to {interval[1]:,})"
                    self.assertEqual(text, hosts[host], (which, device, host))
        self.assertIn("1 in 39,500 to 1 in 179", (DOCS / "results/2012.md").read_text(encoding="utf-8"))

    def test_league(self):
        shown = table("league.md", "", "| lane | general, ")
        grid = self.cells("league", "Pairs on which a lane fails")
        self.assertEqual((len(shown), grid.keys()), (40, shown.keys()))
        for lane, columns in grid.items():
            for column, value in columns.items():
                self.assertEqual(f"{value:,}", shown[lane][column], (lane, column))
        pages = [path.read_text(encoding="utf-8") for path in (DOCS / "findings").glob("*.md")]
        findings = sum("`graze league` found the failure" in text for text in pages)
        self.assertEqual(self.records("league", "findings of the league, [docs/findings](findings)"), findings)


class Site(unittest.TestCase):
    def checked(self, name, lanes):
        """The output of graze check for a pair of the site."""
        if GRAZE is None:
            self.skipTest("needs the program graze as argument")
        command = [GRAZE, "check", "-", "--lanes", lanes]
        ran = subprocess.run(command, input=site.PAIRS[name][0] + "\n", capture_output=True, text=True, check=False)
        return re.sub(r" +", " ", ran.stdout)

    def test_the_pair_of_the_thesis(self):
        said = self.checked("riddle", "interval_overlap/f32/cpu,interval_overlap/f32/cuda-fma")
        self.assertIn("truth: disjoint", said)
        self.assertLess(float(re.search(r"\(([0-9.]+) ulps", said)[1]), 1)
        self.assertRegex(said, r"cpu cuda-fma\n interval_overlap/f32 intersects ! disjoint\n")

    def test_the_pair_of_the_finding(self):
        said = self.checked("league", "*")
        self.assertIn("truth: intersects, contact segment", said)
        self.assertNotIn("disjoint", said)
        finding = (DOCS / "findings/vtk_triangle.md").read_text(encoding="utf-8")
        numbers = [int(x) for x in re.findall(r"-?[0-9]+", re.search(r"a = .*; b = .*\)", finding)[0])]
        self.assertEqual([int(x) for x in site.PAIRS["league"][0].split()], numbers)
        for words in ("`vtkTriangle::TrianglesIntersect`", "VTK 9.1.0"):
            self.assertIn(words, finding)
            self.assertIn(words, site.PAIRS["league"][2])

    def test_the_pair_of_the_epsilon(self):
        said = self.checked("epsilon", "moller_1997/f32/cpu,moller_1997/f32/cpu/abs:1e-6")
        self.assertIn("truth: disjoint", said)
        self.assertRegex(said, r" moller_1997/f32 disjoint\n moller_1997/f32 abs:1e-6 intersects !\n")

    def test_it_needs_nothing_but_its_files(self):
        found = results(Records())
        index = site.index(found)
        for result in found:
            self.assertIn(f'<section id="{result.name}">', index)
            self.assertIn(result.figure, index)
        own = index.replace('xmlns="http://www.w3.org/2000/svg"', "").split("<script>")[0]
        self.assertEqual(re.findall(r"https?://|//[a-z]+\.[a-z]|@import", own), [])
        self.assertEqual(re.findall(f"[{BEGIN}{END}`]|\\]\\(", own), [])
        targets = set(re.findall(r'(?:href|src)="([^"#]*)', index))
        self.assertEqual(targets, {"", "data:,", "viewer.html"})
        self.assertEqual(site.PAIRS.keys() - {result.name for result in found}, set())

    def test_it_is_written_with_the_viewer(self):
        if GRAZE is None:
            self.skipTest("needs the program graze as argument")
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder, "site")
            try:
                site.write(results(Records()), out, GRAZE)
            except site.NoViewer as why:
                self.skipTest(str(why))
            self.assertEqual({path.name for path in out.iterdir()}, {"index.html", "viewer.html"})
            self.assertGreater((out / "viewer.html").stat().st_size, 500_000)

    def test_without_a_viewer_it_says_so(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder, "site")
            with self.assertRaisesRegex(site.NoViewer, "view wrote no page"):
                site.write([], out, "false")
            self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()
