# SPDX-License-Identifier: Apache-2.0
"""Output of speed_table.py for results with known values."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).with_name("speed_table.py")
HOST = {"processor": "P", "num_cpus": 2, "compiler": "GNU 12", "flags": "-O3", "commit": "c0ffee"}
DEVICE = {"device": "D", "driver": "13.0", "nvcc": "13.0.88", "flags": "-O3", "commit": "c0ffee"}


def runs(name, *seconds, items=1000, **counters):
    """One repetition for each time, and an aggregate, which must be ignored."""
    each = [{"run_name": name, "run_type": "iteration", "items_per_second": items / s, **counters} for s in seconds]
    return [*each, {**each[0], "run_type": "aggregate", "items_per_second": 1.0}]


def host_results():
    times = {
        "guigue_devillers_2003/f64/cpu": 2e-5,
        "interval_overlap/f32/cpu": 3e-5,
        "cgal_verdict": 5e-4,
        "gmp_contact": 2e-3,
    }
    benchmarks = [run for name, s in times.items() for run in runs(f"{name}/thesis", s, pairs=1000)]
    benchmarks += runs("exact/f32/cpu/thesis", 9e-5, 4e-5, 3e-5, pairs=1000)  # median: 40 ns per pair
    benchmarks += runs("exact/f32/cpu,proper/thesis", 2e-5, items=800, pairs=800)  # 25 ns
    benchmarks += runs("cgal_epick/thesis", 8e-5, items=800, pairs=800)  # 100 ns
    benchmarks += runs("cgal_epeck/thesis", 16e-5, items=800, pairs=800)
    return benchmarks


def device_results():
    stages = {"bounded": 900, "doubles": 50, "int128": 30, "wide": 20}
    return (
        runs("copy/memory/manual_time", 1.0, bytes_per_second=2.88e12)
        + runs("read/memory/manual_time", 1.0, bytes_per_second=3e12)
        + runs("exact/f32/cuda/thesis/manual_time", 1.0, items=3e10, bytes_per_second=2.16e12, **stages)
    )


class SpeedTable(unittest.TestCase):
    def run_script(self, *documents):
        with tempfile.TemporaryDirectory() as folder:
            files = [pathlib.Path(folder, f"{i}.json") for i in range(len(documents))]
            for file, (context, benchmarks) in zip(files, documents):
                file.write_text(json.dumps({"context": context, "benchmarks": benchmarks}), encoding="utf-8")
            return subprocess.run([sys.executable, SCRIPT, *files], capture_output=True, text=True, check=False)

    def test_host_row_has_medians_and_ratios_over_the_same_pairs(self):
        result = self.run_script((HOST, host_results()))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("| thesis | 40 | 20 | 30 | 100 | 200 | 500 | 2,000 | 2.00 | 4.00 | 80 % |\n", result.stdout)
        self.assertIn("commit `c0ffee`", result.stdout)
        self.assertNotIn("GPU", result.stdout)

    def test_a_stratum_that_cgal_does_not_take_has_no_figure_for_it(self):
        only_graze = [
            run for run in host_results() if "proper" not in run["run_name"] and "cgal_ep" not in run["run_name"]
        ]
        other = [{**run, "run_name": run["run_name"].replace("thesis", "degenerate")} for run in only_graze]
        result = self.run_script((HOST, host_results() + other))
        self.assertIn("| degenerate | 40 | 20 | 30 | - | - | 500 | 2,000 | 2.00 | - | 0 % |\n", result.stdout)

    def test_device_row_is_a_share_of_the_measured_memory(self):
        result = self.run_script((HOST, host_results()), (DEVICE, device_results()))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("| thesis | 30 | 75 % | 72 % | 90 % | 5 % | 3 % | 2 % |\n", result.stdout)
        self.assertIn("which is 40 * 10^9 pairs/s", result.stdout)

    def test_pairs_of_doubles_have_a_table_of_their_own(self):
        of_doubles = runs("exact/f64/cpu/stored/f64", 3e-5, 1e-5, 2e-5, pairs=1000)  # median: 20 ns per pair
        of_doubles += runs("exact/f64/cpu,proper/stored/f64", 2e-5, items=800, pairs=800)  # 25 ns
        of_doubles += runs("cgal_epick/stored/f64", 4e-5, items=800, pairs=800)  # 50 ns
        of_doubles += runs("exact/f64/cpu/degenerate/f64", 6e-5, pairs=1000)
        on_device = runs("copy/memory/f64/manual_time", 1.0, bytes_per_second=2.8e12)
        on_device += runs("read/memory/f64/manual_time", 1.0, bytes_per_second=4e12)
        on_device += runs("exact/f64/cuda/stored/f64/manual_time", 1.0, items=2e10, bytes_per_second=3e12)
        result = self.run_script((HOST, host_results() + of_doubles), (DEVICE, device_results() + on_device))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("| stored | 20 | 50 | 2.00 |\n| degenerate | 60 | - | - |\n", result.stdout)
        self.assertIn("| stored | 20 | 75 % |\n", result.stdout)
        self.assertIn("| thesis | 30 | 75 % | 72 % | 90 % | 5 % | 3 % | 2 % |\n", result.stdout)

    def test_a_failed_validation_fails(self):
        failed = {
            "name": "exact/f32/cpu/thesis",
            "run_name": "exact/f32/cpu/thesis",
            "run_type": "iteration",
            "error_occurred": True,
            "error_message": "differs from the oracle",
        }
        result = self.run_script((HOST, host_results() + [failed]))
        self.assertEqual(result.returncode, 1)
        self.assertIn("expected figures of exact/f32/cpu/thesis, found: differs from the oracle", result.stderr)


if __name__ == "__main__":
    unittest.main()
