# SPDX-License-Identifier: Apache-2.0
"""Numbers for docs/results, from the records in docs/measurements. This module puts marks around each number that it
returns as text, so that a test finds numbers without a record."""
import decimal
import math

import measurements
from verdicts_apart import wilson

BEGIN, END = "\x02", "\x03"


class Unsupported(Exception):
    """The records no longer support a sentence."""


class Records:
    """The newest record of each metric. `used` has the requested records."""

    def __init__(self, folder=measurements.RECORDS):
        machines, topics = measurements.read(folder)
        self.found, self.used = {}, {}
        for name, topic in topics.items():
            for record in measurements.current(measurements.records(name, topic, machines)):
                self.found[(name, record["metric"])] = record

    def record(self, topic, metric):
        if (topic, metric) not in self.found:
            raise Unsupported(f"docs/measurements/{topic}.toml has no record of {metric!r}")
        return self.used.setdefault((topic, metric), self.found[(topic, metric)])

    def __call__(self, topic, metric, key="value"):
        return self.record(topic, metric)[key]


def require(truth, sentence):
    if not truth:
        raise Unsupported(f"the records do not support: {sentence}")


def backed(text):
    return f"{BEGIN}{text}{END}"


def plain(text):
    return text.replace(BEGIN, "").replace(END, "")


def digits(x, n=3, towards=None):
    """x with n significant digits; towards: math.floor or math.ceil for a bound, else the nearest."""
    if x == 0:
        return "0"
    scale = n - 1 - math.floor(math.log10(abs(x)))
    scaled = x * 10**scale
    rounded = towards(scaled - 1e-9 if towards is math.ceil else scaled + 1e-9) if towards else round(scaled)
    return f"{rounded / 10**scale:,.{max(scale, 0)}f}"


def count(x):
    """A number, written as in its record."""
    return backed(measurements.text(x))


WORDS = "no one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen".split()


def word(x):
    return backed(WORDS[x] if x < len(WORDS) else f"{x:,}")


def one_in(x, of=1):
    """The share x of `of`, as in "1 in 3,270"."""
    return backed(f"1 in {digits(float(of) / float(x))}")


def times(x, towards=None):
    """A factor, with two digits if it is a bound, otherwise with three."""
    return backed(f"{digits(float(x), 2 if towards else 3, towards)} times")


def one_pair_in(x, what="pair "):
    """The text "1 pair in x"."""
    return backed(f"1 {what}in {x:,}")


def one_in_interval(x, of):
    """The 95 % interval of x of `of`, rounded outward."""
    low, high = wilson(x, of)
    return backed(f"1 in {digits(1 / low, towards=math.ceil)} to 1 in {digits(1 / high, towards=math.floor)}")


def at_most_one_in(of):
    """The 95 % bound of 0 of `of`, rounded outward."""
    return backed(f"1 in {digits(1 / wilson(0, of)[1], towards=math.floor)}")


def percent(x, of=100, n=3, towards=None):
    return backed(f"{digits(100 * float(x) / float(of), n, towards)} %")


def percent_interval(x, of):
    low, high = (100 * share for share in wilson(x, of))
    return backed(f"{digits(low, towards=math.floor)} % to {digits(high, towards=math.ceil)} %")


def at_most_percent(of):
    return backed(f"{digits(100 * wilson(0, of)[1], 2, math.ceil)} %")


def within_points(*shares):
    """The largest half-width of the 95 % intervals of (x, of), in percentage points, rounded outward."""
    halves = [(high - low) / 2 for low, high in (wilson(x, of) for x, of in shares)]
    return backed(f"{digits(100 * max(halves), 1, math.ceil)} percentage points")


def per_million(x, of):
    return backed(digits(1e6 * float(x) / float(of)))


def number(x):
    return float(x) if isinstance(x, decimal.Decimal) else x
