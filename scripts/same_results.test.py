# SPDX-License-Identifier: Apache-2.0
"""Output of same_results for two stand-ins for graze, which write whatever a test requests."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).with_name("same_results")
GRAZE = """#!/bin/sh
while [ $# -gt 1 ]; do [ "$1" = --out ] && out=$2; [ "$1" = explain ] && verb=$1; shift; done
[ -n "$out" ] && [ "${out%%.png}" = "$out" ] && mkdir -p "$out/cases" && {
  echo '%(summary)s' > "$out/summary.json"
  echo '%(case)s' > "$out/cases/1.pairs"
  echo '%(clock)s' | tee "$out/costs.json" > "$out/timings.json"
}
echo done; [ "$verb" != explain ] || exit %(status)s
"""
USUAL = {"summary": '{"pairs": 3, "build": {"commit": "a"}}', "case": "0 0 0", "clock": "1", "status": "0"}


class SameResults(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def graze(self, name, **changed):
        file = self.folder / name
        file.write_text(GRAZE % {**USUAL, **changed})
        file.chmod(0o755)
        return file

    def run_script(self, **changed):
        command = [sys.executable, SCRIPT, self.graze("old"), self.graze("new", **changed)]
        ran = subprocess.run(command, capture_output=True, text=True)
        return ran.returncode, ran.stdout

    def test_the_same_but_for_build_and_timings(self):
        summary = '{"pairs": 3, "build": {"commit": "b"}, "checksum": "of the build too", "summary": "its hash"}'
        status, said = self.run_script(summary=summary, clock="2")
        self.assertEqual((status, said), (0, "43 files compared, 0 differences\n"))

    def test_a_difference_is_shown_where_it_is(self):
        status, said = self.run_script(case="0 0 1")
        self.assertEqual(status, 1)
        self.assertIn("large/cases/1.pairs:1: old 0 0 0\n", said)
        self.assertIn("new 0 0 1\n", said)
        self.assertIn("43 files compared, 9 differences", said)

    def test_another_key_is_a_difference(self):
        self.assertEqual(self.run_script(summary='{"pair_count": 3}')[0], 1)

    def test_steps_must_run(self):
        status, said = self.run_script(status="2")
        self.assertEqual(status, 1)
        self.assertIn("new graze explain mixed_scale:1:3", said)
        broken = self.graze("broken", status="2")  # both fail in the same way
        self.assertEqual(subprocess.run([sys.executable, SCRIPT, broken, broken], capture_output=True).returncode, 1)
        self.assertEqual(
            subprocess.run([sys.executable, SCRIPT, broken, self.folder], capture_output=True).returncode, 2
        )


if __name__ == "__main__":
    unittest.main()
