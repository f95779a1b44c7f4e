# SPDX-License-Identifier: Apache-2.0
"""The plug-in for pytest. Its options set the number of pairs and the seed of tests with graze.given, for example in a
nightly run. A failure is reported without a traceback if the message says everything."""
import os
from typing import Any, Generator

import pytest


def pytest_addoption(parser: Any) -> None:
    group = parser.getgroup("graze")
    group.addoption("--graze-pairs", metavar="N", help="number of pairs in each test with graze.given")
    group.addoption("--graze-seed", metavar="N", help="seed of their pairs")


def pytest_configure(config: Any) -> None:
    for name in ("pairs", "seed"):
        value = config.getoption("--graze-" + name)
        if value is not None:
            os.environ["GRAZE_" + name.upper()] = value


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(call: Any) -> Generator[None, Any, None]:
    report = (yield).get_result()
    if call.excinfo and getattr(call.excinfo.value, "graze_says_all", False):
        report.longrepr = str(call.excinfo.value)
