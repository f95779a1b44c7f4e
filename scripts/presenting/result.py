# SPDX-License-Identifier: Apache-2.0
"""A result of docs/results. All numbers in its text come from presenting.records."""
import dataclasses
import re

ALGORITHMS = ("projected_sat", "interval_overlap", "moller_1997", "guigue_devillers_2003", "separating_axes")


@dataclasses.dataclass
class Result:
    name: str  # names its figure, and its section on a page
    headline: str
    paragraph: str
    figure: str
    alt: str
    records: dict = dataclasses.field(default_factory=dict)  # the records that it uses, by topic and metric
    main: tuple = ()  # the topic and metric whose command reproduces the headline


def of(metric):
    """The number of pairs, verdicts or values that a metric's name gives."""
    return int(re.search(r"[0-9]+(,[0-9]{3})+", metric).group().replace(",", ""))


def wrong_in(r, column, lane):
    """Wrong verdicts of a lane of the default campaign, and the number of pairs."""
    cell = lambda row: r("campaign", f"Wrong verdicts of the default campaign, {row}: {column}")
    return cell(f"`{lane}`"), cell("pairs")
