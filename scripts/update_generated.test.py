# SPDX-License-Identifier: Apache-2.0
"""scripts/update_generated copies tests' output into strata/golden.h and cuda/twin/contracted_otherwise.inc, and
changes nothing else."""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
from loaded import loaded  # noqa: E402

ROOT = pathlib.Path(__file__).parent.parent
update = loaded("update_generated")


class Goldens(unittest.TestCase):
    header = (ROOT / "strata/golden.h").read_text()

    def test_without_changes_nothing_is_written(self):
        self.assertGreaterEqual(len(update.TEXT_OF_ROW.findall(self.header)), 19)
        self.assertEqual(update.with_goldens(self.header, "[  PASSED  ] 1 test."), self.header)

    def test_a_changed_hash_replaces_its_row(self):
        renewed = update.with_goldens(self.header, "thesis is now 0xab12\n").splitlines()
        changed = [(old, new) for old, new in zip(self.header.splitlines(), renewed) if old != new]
        self.assertEqual(len(renewed), len(self.header.splitlines()))
        self.assertEqual([new for _, new in changed], ["    0x000000000000ab12u,  // thesis"])
        self.assertTrue(changed[0][0].endswith("// thesis"))

    def test_a_new_stratum_gets_a_row_at_the_end(self):
        renewed = update.with_goldens(self.header, "brand_new is now 0x1\n")
        self.assertIn("    0x0000000000000001u,  // brand_new\n};\n\n}", renewed)


class Kernels(unittest.TestCase):
    rows = (ROOT / "cuda/twin/contracted_otherwise.inc").read_text()

    def test_without_changes_nothing_is_written(self):
        self.assertIn('    "interval_overlap/f32/cuda-fma/rel",\n', self.rows)
        self.assertEqual(update.with_kernels(self.rows, "[  SKIPPED ] 2 tests"), self.rows)

    def test_kernels_come_and_go(self):
        more = update.with_kernels(self.rows, "kernel moller_1997/f32/cuda-fma/abs breaks the rule\n")
        self.assertEqual(more, self.rows + '    "moller_1997/f32/cuda-fma/abs",\n')
        self.assertEqual(update.with_kernels(more, "kernel moller_1997/f32/cuda-fma/abs follows the rule\n"), self.rows)


if __name__ == "__main__":
    unittest.main()
