# SPDX-License-Identifier: Apache-2.0
"""Tests graze.given, the plug-in for pytest, and the wheel."""
import importlib.util
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import unittest

import graze
import numpy as np

FAILING = """
import graze

def boxes(a, b):
    return bool((a.max(0) >= b.min(0)).all() and (b.max(0) >= a.min(0)).all())

@graze.given("near_*")
def test_boxes(a, b):
    return boxes(a, b)

@graze.given("uniform", max_wrong=0.6)
def test_boxes_far_apart(a, b):
    return boxes(a, b)
"""


def boxes(a, b):
    return bool((a.max(0) >= b.min(0)).all() and (b.max(0) >= a.min(0)).all())


def exact(a, b):
    return int(graze.truth(np.stack([a, b]))[0])


def failure_of(test):
    try:
        test()
    except AssertionError as failure:
        return str(failure)
    return ""


class Given(unittest.TestCase):
    def test_the_smallest_pair_is_wrong_and_fails_as_an_example(self):
        said = failure_of(graze.given("near_*", pairs=4000)(boxes))
        self.assertRegex(said, r"boxes is wrong on [\d,]+ of 4,000 pairs")
        pair = graze.Pair(re.search(r"@graze.example\('(.*)'\)", said)[1])
        self.assertEqual((boxes(*pair.array), graze.truth(pair)[0]), (True, 0))
        self.assertTrue((np.abs(pair.array) <= 1).all(), pair)
        apart = graze.example(pair)(graze.given("nested", pairs=1)(boxes))
        self.assertIn("wrong on an example", failure_of(apart))
        under = graze.given("nested", pairs=1)(graze.example(str(pair))(lambda a, b: boxes(a, b)))
        self.assertIn("wrong on an example", failure_of(under))

    def test_the_same_counts_for_arrays(self):
        def arrays(a, b):
            return (a.max(1) >= b.min(1)).all(1) & (b.max(1) >= a.min(1)).all(1)

        one, many = (
            failure_of(graze.given(pairs=5000, vectorized=of_many)(f))
            for f, of_many in ((boxes, False), (arrays, True))
        )
        self.assertEqual(one.split(" ", 1)[1], many.split(" ", 1)[1])

    def test_right_functions_pass(self):
        graze.given(pairs=2000)(exact)()
        graze.given(pairs=100_000, vectorized=True)(lambda a, b: graze.truth(np.stack([a, b], 1)))()

    def test_methods_of_a_test_case(self):
        class Case(unittest.TestCase):
            answer = True

            @graze.given("near_*", pairs=500)
            def runTest(self, a, b):
                return self.answer

        ran = Case().run()
        self.assertEqual((ran.testsRun, len(ran.errors), len(ran.failures)), (1, 0, 1), ran.errors)
        self.assertIn("runTest is wrong on", ran.failures[0][1])

    def test_conventions_and_declined(self):
        def without_touching(a, b):
            relation = graze.relation(np.stack([a, b]))[0]
            return relation["verdict"] == 1 and relation["margin_sign"] != 0

        self.assertIn("false negatives", failure_of(graze.given("exact_contact", pairs=300)(without_touching)))
        kinds = ("touching", "coplanar")
        graze.given("exact_contact", pairs=300, either=kinds)(without_touching)()
        self.assertIn("declines every pair", failure_of(graze.given(pairs=100)(lambda a, b: -1)))

    def test_exceptions_are_wrong_answers_and_other_results_end_the_test(self):
        def raises(a, b):
            if a[0, 0] > 0:
                raise ZeroDivisionError("no area")
            return exact(a, b)

        with self.assertRaises(AssertionError) as failed:
            graze.given("uniform", pairs=500)(raises)()
        self.assertIn("exceptions", str(failed.exception))
        self.assertIsInstance(failed.exception.__cause__, ZeroDivisionError)
        for result, found in (
            (None, "None"),
            ("yes", "a str"),
            (0.5, "a float"),
            (np.nan, "a float"),
            ([True], "a list"),
        ):
            with self.assertRaisesRegex(TypeError, f"^<lambda> returned {found}; return a bool or an int"):
                graze.given(pairs=10)(lambda a, b, result=result: result)()
        with self.assertRaisesRegex(TypeError, "a generator"):
            graze.given(pairs=10)(lambda a, b: (yield))()
        with self.assertRaisesRegex(TypeError, "of shape"):
            graze.given(pairs=10, vectorized=True)(lambda a, b: True)()
        with self.assertRaises(SystemExit):
            graze.given(pairs=10)(lambda a, b: sys.exit(3))()

    def test_what_a_signal_handler_raises_ends_the_test(self):
        class Alarm(BaseException):
            pass

        def ring(*_):
            raise Alarm

        before = signal.signal(signal.SIGALRM, ring)
        try:
            for k in range(30):
                signal.setitimer(signal.ITIMER_REAL, 0.01 + k / 1000)
                with self.assertRaises(Alarm):
                    graze.given("uniform", pairs=10**8, vectorized=True)(lambda a, b: np.zeros(len(a), bool))()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)

    def test_answers_of_numpy_and_masked_answers(self):
        for kind in (bool, int, np.bool_, np.int8, np.uint64):
            graze.given("uniform", pairs=20)(lambda a, b, kind=kind: kind(exact(a, b)))()
        self.assertIn("declines every pair", failure_of(graze.given(pairs=10)(lambda a, b: np.int16(-1))))
        with self.assertRaisesRegex(TypeError, "MaskedConstant"):
            graze.given(pairs=10)(lambda a, b: np.ma.masked)()
        with self.assertRaisesRegex(ValueError, "masked"):
            graze.given(pairs=10, vectorized=True)(lambda a, b: np.ma.masked_less(a[:, 0, 0] > 0, 2))()

    def test_the_function_cannot_write_into_the_pairs(self):
        def writes(a, b):
            a[:] = 0
            return True

        self.assertIn("exceptions", failure_of(graze.given(pairs=10)(writes)))

    @unittest.skipUnless(importlib.util.find_spec("pytest"), "pytest (Debian's python3-pytest)")
    def test_pytest_shows_the_pair_and_takes_the_numbers(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "test_boxes.py").write_text(FAILING, encoding="utf-8")
            words = [sys.executable, "-B", "-m", "pytest", "-p", "graze._pytest", "-p", "no:cacheprovider"]
            done = subprocess.run(
                words + ["--graze-pairs", "8000", "--graze-seed", "5"], cwd=folder, capture_output=True, text=True
            )
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"1 failed, 1 passed")
        self.assertRegex(done.stdout, r"test_boxes is wrong on [\d,]+ of 8,000 pairs")
        self.assertIn("@graze.example('", done.stdout)
        self.assertNotIn("_given.py", done.stdout)

    @unittest.skipUnless(
        all(importlib.util.find_spec(name) for name in ("build", "setuptools", "wheel")),
        "the wheel (Debian's python3-build, python3-setuptools, python3-wheel)",
    )
    def test_the_wheel_has_the_package(self):
        import zipfile

        source = pathlib.Path(__file__).resolve().parents[2]
        with tempfile.TemporaryDirectory() as folder:
            words = [str(source / "scripts/wheel"), "--package", os.environ["PYTHONPATH"] + "/graze", "--out", folder]
            done = subprocess.run(words, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            wheels = list(pathlib.Path(folder).glob("*.whl"))
            self.assertEqual(len(wheels), 1)
            self.assertRegex(wheels[0].name, r"^graze-.*-py3-none-linux_")
            installed = pathlib.Path(folder) / "installed"
            zipfile.ZipFile(wheels[0]).extractall(installed)
            code = "import graze; print(graze.__file__, graze.truth(graze.pairs(count=9)).sum())"
            environment = dict(os.environ, PYTHONPATH=str(installed))
            words = [sys.executable, "-c", code]
            said = subprocess.run(words, capture_output=True, text=True, env=environment, cwd=folder)
            self.assertIn(str(installed), said.stdout, said.stderr)
            libraries = list((installed / "graze").glob("*.so.*"))
            self.assertIn("libtbb.so.12", [library.name for library in libraries])
            self.assertEqual(len(list(installed.glob("*.dist-info/LICENSE.*"))), len(libraries) + 1)  # and CGAL


if __name__ == "__main__":
    unittest.main()
