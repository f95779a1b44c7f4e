# SPDX-License-Identifier: Apache-2.0
"""The plug-in for pytest: how many pairs tests by graze.given draw, for a nightly run."""
import os
from typing import Any


def pytest_addoption(parser: Any) -> None:
    group = parser.getgroup("graze")
    group.addoption("--graze-pairs", metavar="N", help="pairs of each test by graze.given")
    group.addoption("--graze-seed", metavar="N", help="seed of their pairs")


def pytest_configure(config: Any) -> None:
    for name in ("pairs", "seed"):
        value = config.getoption("--graze-" + name)
        if value is not None:
            os.environ["GRAZE_" + name.upper()] = value
