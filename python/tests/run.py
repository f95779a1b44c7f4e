#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the doctests and test_*.py on the package as it will be installed. Tests the plug-in if Debian's python3-pytest
is installed, and the wheel if python3-build, python3-setuptools and python3-wheel are installed.
  run.py FOLDER GRAZE     FOLDER: contains the package; GRAZE: the program
"""
import doctest
import importlib.util
import os
import pathlib
import sys
import unittest

if importlib.util.find_spec("numpy") is None:
    print("SKIPPED: NumPy is not installed (Debian's python3-numpy)")
    sys.exit(77)

folder, program = sys.argv[1:3]
sys.path.insert(0, folder)
os.environ.update(PYTHONPATH=folder, GRAZE=program)
for name in ("GRAZE_PAIRS", "GRAZE_SEED"):
    os.environ.pop(name, None)

import graze  # noqa: E402

here = pathlib.Path(__file__).parent
suite = unittest.defaultTestLoader.discover(str(here), "test_*.py")
for module in (graze, graze._arrays, graze._given):
    suite.addTests(doctest.DocTestSuite(module, optionflags=doctest.ELLIPSIS))
done = unittest.TextTestRunner(verbosity=2).run(suite)
for _, why in done.skipped:
    print("left out: " + why)
sys.exit(0 if done.wasSuccessful() and done.testsRun > 15 else 1)
