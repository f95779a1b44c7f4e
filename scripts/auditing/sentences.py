# SPDX-License-Identifier: Apache-2.0
"""Checks the output of `graze explain --json` for a pair against the second program."""
import math
import re
from collections import Counter
from fractions import Fraction

from auditing.numbers import Root, value_of
from auditing.pair import MOST_DECIDING, Audited

MOST_BITS = 512  # graze::oracle::kMostBits


def close(text, value, digits):
    """Whether the number in the text equals the value to `digits` digits."""
    if isinstance(value, Root):
        value = "nan" if value.p is None else value.number() if value.sign() else Fraction(0)
    if value == "nan" or isinstance(value, float) and not math.isfinite(value):
        word = "NaN" if value == "nan" or math.isnan(value) else "infinity" if value > 0 else "-infinity"
        return text == word
    if text in ("NaN", "infinity", "-infinity"):
        return False
    said, value = Fraction(text), Fraction(value)
    return (
        said == 0 if value == 0 else abs(said - value) <= abs(value) * Fraction(11, 20) / Fraction(10) ** (digits - 1)
    )


SENTENCE = re.compile(r"(\w+)/(f32|f64) \(([^)]*)\) says (\w+), but (.*?): (.*)\.$", re.S)
TURNS = re.compile(
    r"(?:a signed distance|a component of the normals' cross product|an orientation|the gap between two interval ends|a number|"
    r"the difference of two numbers) of exactly (\S+) into (\S+?),? so that"
)
TURNS_TWO = re.compile(r"two (?:numbers|interval ends) of exactly (\S+) and (\S+) into (\S+) and (\S+?),? so that")
LINE = r"core/[\w/]+\.h:\d+"


class Wrong(Exception):
    pass


def expect(holds, what):
    if not holds:
        raise Wrong(what)


def check_lane(pair, lane, counts):
    """Checks the JSON of one lane."""
    name, scalar, variant = lane["lane"].split("/")[:3]
    if variant == "cpu-fast" or lane["evidence"] == "none" or lane["lane"].count("/") > 2:
        counts["lanes not replayed"] += 1
        return
    counts["lanes"] += 1
    rule = lane["contracted"]
    run = pair.run(name, scalar, rule)
    expect(pair.verdict(run) == lane["verdict"] != pair.truth, "the verdict")
    exactly = pair.verdict(pair.exactly(name))
    expect(exactly == lane["exactly"], "the verdict in exact arithmetic")
    expect((lane["cause"] == "logic") == (exactly != pair.truth), "logic or not")
    if lane["cause"] == "logic":
        return
    if lane["cause"] == "contraction":
        expect(pair.verdict(pair.run(name, scalar, "none")) == pair.truth, "without contraction it is right")
    found = pair.deciding(name, scalar, rule)
    if found is None:
        expect(
            lane["decisive"] is None and not lane["then"] and lane["settled"] == "not by few comparisons",
            "no small set decides",
        )
        counts["no small set"] += 1
        return
    counts[f"sets of {len(found)}"] += 1
    steps = [lane["steps"][lane["decisive"]]] + lane["then"] if lane["decisive"] is not None else []
    expect(
        lane["deciding"] == [i for i, _ in found],
        f"comparisons {lane['deciding']} decide; it is {[i for i, _ in found]}",
    )
    expect(len(steps) == len(found), "as many steps as comparisons that decide")
    for step, (i, path) in zip(steps, found):
        lead = path[:i]
        seen = pair.run(name, scalar, rule, lead).seen[i]
        expect(
            (step["line"], step["relation"], step["held"], step["holds"])
            == (seen.line, seen.relation, seen.held, not seen.held),
            f"{step['line']} decides; it is {seen.line}",
        )
        for side, value in (("left", seen.left), ("right", seen.right)):
            said, value = step[side]["lane"], float(value_of(value))
            expect(
                said == value
                or (isinstance(said, str) and float(said) == value)
                or (said == "nan" and math.isnan(value)),
                f"{side} is {said}; it is {value}",
            )


def by_cause(pair, name, scalar, rule, cause, i, path):
    """Whether the comparison, without the cause, is right or compares a value that is not finite."""
    seen = pair.run(name, scalar, rule, path[:i]).seen[i]
    finite = all(math.isfinite(value_of(x)) for x in (seen.left, seen.right))
    if cause == "rounding" or not finite:
        return True
    without = (
        pair.run(name, scalar, "none", path)
        if cause == "contraction"
        else pair.sized(name, scalar, rule=rule, lead=path)
    )
    return without.seen[i].held == pair.exact_outcomes(name, path)[i]


def check_sentence(pair, text, lanes, counts):
    match = SENTENCE.match(text)
    expect(match, "a sentence of the known form")
    name, scalar, variants, verdict, phrase, reason = match.groups()
    counts["sentences"] += 1
    told = [next((x for x in lanes if x["lane"] == f"{name}/{scalar}/{v}"), None) for v in variants.split(", ")]
    expect(all(told), "its lanes are wrong")
    rest = reason.split("; also wrong: ")
    also = [] if len(rest) == 1 else [f"{name}/{x.split(' (')[0]}" for x in rest[1].split("), ")]
    expect(
        sorted(also + [x["lane"] for x in told]) == sorted(x["lane"] for x in lanes if x["lane"].split("/")[0] == name),
        "all wrong lanes of the algorithm, once each",
    )
    for x in told:
        expect(x["verdict"] == verdict, "each lane's verdict")
    if pair.contact:
        words = {"point": "meet in a point", "segment": "meet in a segment", "area": "overlap in their common plane"}
        expected = f"the triangles {words[pair.contact]}"
        if pair.inside.startswith("inside"):
            expected += " " + pair.inside
        elif pair.inside:
            expected = pair.inside
        expect(re.sub(r", \S+ deep$", "", phrase) == expected, f"the contact is a {pair.contact}, {pair.inside}")
    else:
        apart = re.match(r"the triangles are (\S+) apart", phrase)
        expect(apart and close(str(Fraction(apart[1]) ** 2), pair.distance_squared, 2), "the distance")
    reason = rest[0]
    known = [x for x in told if x["evidence"] in ("source", "hash")] or [x for x in told if x["evidence"] != "none"]
    if not known:
        counts["of lanes not replayed"] += 1
        return
    lane = known[0]
    cause, rule = lane["cause"], lane["contracted"]
    begins = {
        "rounding": "rounding",
        "logic": "the algorithm itself is wrong here",
        "contraction": ("nvcc fuses", "the compiler fuses"),
        "overflow": f"an intermediate result is too large for {'float32' if scalar == 'f32' else 'float64'}",
        "underflow": f"an intermediate result is too small for {'float32' if scalar == 'f32' else 'float64'}",
    }
    expect(reason.startswith(begins[cause]), "the cause")
    check_remedy(pair, name, scalar, lane, reason, counts)
    if cause == "logic":
        return
    found = pair.deciding(name, scalar, rule)
    if found is None:
        expect(
            f"not settled: it takes more than {MOST_DECIDING} corrected comparisons" in reason, "no small set decides"
        )
        expect("the wrong way" not in reason, "no comparison is named")
        return
    lines = [pair.run(name, scalar, rule, path[:i]).seen[i].line for i, path in found]
    i, path = found[0]
    seen, exact = pair.run(name, scalar, rule, path[:i]).seen[i], pair.exact_seen(name, path)[i]
    first = re.search(
        rf"the comparison at ({LINE})(?: goes the wrong way|, which decides, goes the wrong way without that too)",
        reason,
    )
    expect(first and first[1] == lines[0], f"the first comparison is at {lines[0]}")
    caused = by_cause(pair, name, scalar, rule, cause, i, path)
    expect(caused == ("without that too" not in reason), "whether the cause makes that comparison go wrong")
    later = re.search(
        rf"(?: and, (were it|were each in turn) right, (a later one|later ones) at ((?:{LINE}(?:, | and )?)+)(?:and (\d+) more)?)",
        reason,
    )
    expect(bool(later) == (len(lines) > 1), f"{len(lines)} comparisons decide")
    if later:
        named, distinct = re.findall(LINE, later[3]), list(dict.fromkeys(lines[1:]))
        expect(
            named == distinct[:3] and int(later[4] or 0) == len(distinct) - len(named),
            f"the later comparisons are at {lines[1:]}",
        )
        expect(
            (later[1], later[2])
            == (("were it", "a later one") if len(lines) == 2 else ("were each in turn", "later ones")),
            "how many come later",
        )
    one, two = TURNS.search(reason), TURNS_TWO.search(reason)
    expect(bool(one) + bool(two) == caused, "the numbers that it compares")
    left, right = value_of(seen.left), value_of(seen.right)
    if one:
        expect(
            math.isfinite(left) and math.isfinite(right) or (right == 0 and exact.right.sign() == 0),
            "no gap is formed of what is not finite",
        )
        expect(
            close(one[1], exact.left - exact.right, 6),
            f"exactly it is {float((exact.left - exact.right).number()):.9g}",
        )
        expect(
            close(one[2], left - right, 6) or close(one[2], Fraction(left) - Fraction(right), 6),
            f"the lane has {left - right}",
        )
        counts["numbers"] += 1
    if two:
        expect(
            not (math.isfinite(left) and math.isfinite(right) and math.isfinite(left - right))
            or exact.left.p is None
            or exact.right.p is None,
            "two numbers are told where a difference is not finite",
        )
        expect(close(two[1], exact.left, 6) and close(two[2], exact.right, 6), "exact numbers")
        expect(close(two[3], left, 6) and close(two[4], right, 6), f"the lane compares {left} and {right}")
        counts["numbers that are not finite"] += 1


def check_remedy(pair, name, scalar, lane, reason, counts):
    last = reason.split("; ")[-1]
    native = 24 if scalar == "f32" else 53
    if lane["cause"] == "logic":
        return expect(last == reason, "no remedy")
    if lane["cause"] == "contraction":
        return expect(last == "without contraction it is right", "the remedy")
    bits = re.match(r"(\d+) mantissa bits would be enough", last)
    if bits:
        n = int(bits[1])
        counts["bits"] += 1
        for b in (n, n + 1, n + 2, min(2 * n, MOST_BITS), MOST_BITS):
            expect(pair.verdict(pair.sized(name, scalar, b)) == pair.truth, f"{b} bits are enough")
        if n > native:
            expect(pair.verdict(pair.sized(name, scalar, n - 1)) != pair.truth, f"{n - 1} bits are not")
    elif last.startswith("no mantissa"):
        counts["no number of bits"] += 1
        widths = range(MOST_BITS, MOST_BITS // 2 - 1, -1)
        expect(any(pair.verdict(pair.sized(name, scalar, b)) != pair.truth for b in widths), "no mantissa is enough")
    elif last == "with unlimited exponents it is right":
        expect(
            pair.verdict(pair.sized(name, scalar, rule=lane["contracted"])) == pair.truth
            or pair.verdict(pair.sized(name, scalar)) == pair.truth,
            "with unlimited exponents it is right",
        )
        counts["exponents"] += 1


def audit(explained):
    """Returns: the counts, and the statements that are false."""
    counts, wrong = Counter(pairs=1), []
    coordinates = explained["pair"].split()
    pair = Audited([float.fromhex(c) for c in coordinates])
    where = f"{explained['case']}: {' '.join(coordinates)}"
    if explained["truth"]["verdict"] != pair.truth or (
        explained["truth"]["contact"].replace("none", "") != pair.contact
    ):
        wrong.append(f"{where}: truth {explained['truth']}; it is {pair.truth} {pair.contact}")
    for lane in explained["lanes"]:
        try:
            check_lane(pair, lane, counts)
        except Wrong as what:
            wrong.append(f"{where}: {lane['lane']}: does not hold: {what}")
    for text in explained["sentences"]:
        try:
            check_sentence(pair, text, explained["lanes"], counts)
        except Wrong as what:
            wrong.append(f"{where}: '{text}': does not hold: {what}")
    return counts, wrong
