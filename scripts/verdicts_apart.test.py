# SPDX-License-Identifier: Apache-2.0
"""Output of verdicts_apart.py for campaigns with known counts."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).with_name("verdicts_apart.py")
LANES = {f"mine/f32/{name}": {} for name in ("cpu", "x87", "cuda-fma", "other")}
SIGNATURES = [
    {"key": "none/22/skew/+2^3/mine:+f32/cpu;+f32/x87", "count": 40},
    {"key": "point/22/skew/0/mine:-f32/cpu", "count": 9},
    {"key": "point/22/skew/0/mine:?f32/cpu;-f32/x87", "count": 1},
    {"key": "point/22/skew/0/yours:-f32/cpu;-f32/x87", "count": 500},  # another subject
]


def run(summary, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "summary.json").write_text(summary)
        command = [sys.executable, SCRIPT, folder, *arguments]
        return subprocess.run(command, capture_output=True, text=True)


def summary(**changes):
    strata = {"thesis": {"pairs": 600, "lanes": LANES}, "thesis_special": {"pairs": 400, "lanes": LANES}}
    return json.dumps({"complete": True, "strata": strata, "signatures": SIGNATURES, **changes})


class VerdictsApart(unittest.TestCase):
    def test_counts_pairs_with_different_verdicts(self):
        ran = run(summary(), "mine", "f32/cpu,f32/other", "f32/x87,f32/cuda-fma")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        lines = ran.stdout.splitlines()
        self.assertEqual(lines[0], "| 1,000 pairs | `f32/x87` | `f32/cuda-fma` |")
        # cpu and x87 differ on 10 of 1,000 pairs: Wilson's interval is 0.54 % to 1.83 %.
        self.assertEqual(lines[2], "| `f32/cpu` | 100 (54 to 184) | 20 (15 to 27) |")
        # other and x87 differ on 41 pairs; other and cuda-fma differ on none of 1,000, so the bound is 1 in 261.
        self.assertEqual(lines[3], "| `f32/other` | 24 (18 to 33) | 0 (over 261) |")

    def test_what_is_missing_gets_one_line(self):
        for text, lane, why in (
            (summary(), "f32/none", "no lane mine/f32/none"),
            (summary(complete=False), "f32/cpu", "not finished"),
            ("{", "f32/cpu", "cannot read"),
        ):
            ran = run(text, "mine", lane, "f32/cpu")
            self.assertEqual(ran.returncode, 1)
            self.assertRegex(ran.stderr, f"^verdicts_apart: .*{why}.*\n$")


if __name__ == "__main__":
    unittest.main()
