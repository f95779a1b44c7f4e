# SPDX-License-Identifier: Apache-2.0
"""Tests the models' sizes and exact numbers, and that near_models writes the same bytes each time."""
import pathlib
import subprocess
import sys
import tempfile
import unittest
from fractions import Fraction

SCRIPT = pathlib.Path(__file__).with_name("near_models")
PART = "OFF\n4 2 0\n0.1 0 0\n1e-1 1 0\n-2 0 1\n3 3 3\n3 0 1 2\n4 0 1 2 3\n"


class NearModels(unittest.TestCase):
    def setUp(self):
        self.path = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def run_it(self, *words):
        return subprocess.run(
            [sys.executable, "-B", SCRIPT, *map(str, words)], capture_output=True, text=True, check=False
        )

    def made(self, name, part=PART):
        (self.path / "given.off").write_text(part, encoding="ascii")
        ran = self.run_it(self.path / name, self.path / "given.off")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        return {file.name: file.read_text(encoding="ascii") for file in (self.path / name).iterdir()}

    def test_the_models(self):
        files = self.made("one")
        self.assertEqual(files, self.made("two"))
        vertices = {}
        for name, text in files.items():
            lines = text.splitlines()
            count, faces, _ = map(int, lines[1].split())
            self.assertEqual(len(lines), 2 + count + faces, name)
            vertices[name] = [tuple(map(Fraction, line.split())) for line in lines[2 : 2 + count]]
        self.assertEqual(len(vertices), 8)
        for k in (1, 2):
            moved = [(x + 500_000, y + 5_400_000, z) for x, y, z in vertices[f"local_{k}.off"]]
            self.assertEqual(vertices[f"survey_{k}.off"], moved)
            self.assertEqual(len(moved), 101 * 101)
        for (x, y, z), (moved_x, *same) in zip(vertices["part_1.off"], vertices["part_2.off"]):
            self.assertEqual((moved_x, same), (x + Fraction(1, 1000), [y, z]))
        self.assertIn("4 0 1 2 3\n", files["part_2.off"])
        radius = [(x - Fraction("18250.5")) ** 2 + (y + Fraction("2830.25")) ** 2 for x, y, _ in vertices["shaft.off"]]
        for squared in radius:
            self.assertAlmostEqual(float(squared), 19.996**2, places=6)

    def test_what_is_no_off_file_is_refused(self):
        (self.path / "given.off").write_text("solid\n", encoding="ascii")
        ran = self.run_it(self.path / "m", self.path / "given.off")
        self.assertEqual(ran.returncode, 1)
        self.assertIn("expected OFF, found 'solid'", ran.stderr)
        self.assertEqual(self.run_it().returncode, 1)


if __name__ == "__main__":
    unittest.main()
