# SPDX-License-Identifier: Apache-2.0
"""Results about builds and processors: the same test, built differently."""
import math

from presenting.figures import bars
from presenting.records import (
    at_most_one_in,
    backed,
    count,
    number,
    one_in,
    one_in_interval,
    one_pair_in,
    per_million,
    percent,
    require,
    word,
)
from presenting.result import ALGORITHMS, Result, of, wrong_in


def riddle(r):
    changed = "verdicts changed by contraction, of 20,000,000 pairs of the thesis: `interval_overlap/f32`"
    without = "CUDA lanes with `-fmad=false` against their `cpu` lanes, 600,000,000 verdicts: verdicts that differ"
    differ, pairs = r("agreement", changed), of(changed)
    saw = r("hosts_2012", "Intel CPU against GPU, as the thesis reports")
    low, high = r("hosts_2012", "Intel CPU against GPU, 95 % interval if it saw one in 1,000 triangles")
    none = r("agreement", without)
    share = differ / pairs * saw
    require(0.28 < share < 0.38, "about a third")
    require(none == 0, "no verdict differs without contraction")
    require(low < pairs / differ < high, "our rate lies in the thesis's interval")
    alt = (
        f"Verdicts of a CPU and a GPU that differ, per million pairs: {per_million(1, saw)} in the thesis, "
        f"{per_million(differ, pairs)} today with contraction, {count(none)} without it."
    )
    figure = bars(
        alt,
        "verdicts that differ, per million pairs",
        [
            ("The thesis of 2012: Intel CPU against GTX 590", 1e6 / saw, f"about {per_million(1, saw)}", "c"),
            ("CPU against H100, nvcc's default: contraction", 1e6 * differ / pairs, per_million(differ, pairs), "a"),
            ("CPU against H100, nvcc -fmad=false", none, count(none), "a"),
        ],
    )
    return Result(
        "riddle",
        f"A thesis of 2012 saw CPU and GPU differ on {one_in(1, saw)} verdicts; contraction explains "
        f"{one_in(differ, pairs)}, about a {backed('third')} of it",
        f"A thesis of 2012 ran its triangle test on an Intel CPU and on a GTX 590. On average {one_in(1, saw)} "
        "verdicts differed, and its author could not say why. We ran its algorithm, `interval_overlap` in float32, on "
        f"{count(pairs)} pairs drawn as the thesis drew them, on an H100 and on a CPU. {count(differ)} verdicts "
        f"differ: {one_in(differ, pairs)} (95 % interval {one_in_interval(differ, pairs)}), which is "
        f"{percent(share, 1)} of the thesis's rate. By default nvcc computes `a * b + c` with one rounding "
        "(*contraction*); our host compiler is told not to contract. Built with `-fmad=false`, the GPU differs from "
        f"the CPU on {count(none)} of {count(of(without))} verdicts of all lanes. The rest of the rate is "
        "unexplained: the thesis gives no counts, no compiler and no flags. If the thesis saw a single difference "
        f"among {count(saw)} triangles, its own 95 % interval is {one_pair_in(high, '')} to {one_pair_in(low, '')}, "
        "and our rate lies within it.",
        figure,
        alt,
        main=("agreement", changed),
    )


def hosts(r):
    table = "Pairs for one verdict that differs, of 10,000,000 with the reference of "
    random, special = table + "random triangles", table + "special cases"
    at = lambda which, device, host: r("hosts_2012", f"{which}, `{device}`: `{host}`")
    around = lambda which, device, host: r("hosts_2012", f"{which}, `{device}`: `{host}`, interval")
    saw = r("hosts_2012", "Intel CPU against GPU, as the thesis reports")
    devices = ("plain", "division", "cuda-fma", "fma-left", "fma-right", "jit-left", "jit-right", "jit-2ulps")
    devices += ("mad-left", "mad-right", "mad-2ulps")
    cells = [(device, host) for device in devices for host in ("cpu", "x87", "x87-O0")]
    cells.remove(("plain", "cpu"))  # which never differ
    last = "jit-2ulps", "x87"
    nearest, its = at(special, *last), around(special, *last)
    best, best_its = at(random, *last), around(random, *last)
    sse, fused, divided = at(special, "fma-left", "cpu"), at(special, "fma-left", "x87"), at(special, "jit-left", "x87")
    for which, least in ((special, nearest), (random, best)):
        require(min(at(which, *cell) for cell in cells) == least, f"the nearest {which}")
    require(best_its[0] > saw, "no model comes to the thesis's rate with the reference of random triangles")
    rows = [
        ("Host SSE; device fuses", sse, "a"),
        ("Host x87; device rounds each operation", at(special, "plain", "x87"), "a"),
        ("Host x87; device fuses", fused, "a"),
        ("Host x87; device fuses, divides by reciprocals", divided, "a"),
        ("Host x87; device fuses, divides badly", nearest, "a"),
        ("The thesis's report", saw, "c"),
        ("The nearest with the other reference triangle", best, "b"),
    ]
    alt = (
        "Verdicts that differ per million pairs, for models of hosts and devices of 2012. With the reference of "
        f"special cases they rise from {per_million(1, sse)} to {per_million(1, nearest)}; the thesis reports "
        f"{per_million(1, saw)}; the nearest with the reference of random triangles is {per_million(1, best)}."
    )
    return Result(
        "hosts",
        f"In the nearest model of the machines of 2012, CPU and GPU differ on {one_pair_in(nearest)}, but only with "
        "the thesis's second reference triangle",
        f"Contraction alone does not explain {one_in(1, saw)}. Which arithmetic of 2012 could? We compared {word(3)} "
        f"hosts with {word(len(devices))} models of devices, on {count(of(special))} pairs for each of the thesis's "
        "reference triangles. With the reference of its special cases, a host that computes on the x87 and a device "
        f"that fuses differ on {one_pair_in(fused)}. If the device also divides as badly as its documentation allows, "
        f"they differ on {one_pair_in(nearest, '')} ({count(its[0])} to {count(its[1])}, 95 %). With the reference of "
        f"the random triangles, the nearest model differs on {one_pair_in(best, '')} ({count(best_its[0])} to "
        f"{count(best_its[1])}). The devices' division is a model, and we ran no GPU of 2012. The thesis does not say "
        "which reference triangle its rate belongs to. So this shows what could explain that rate, not what did. [All "
        "combinations](2012.md).",
        bars(
            alt,
            "verdicts that differ, per million pairs",
            [(label, 1e6 / value, per_million(1, value), kind) for label, value, kind in rows],
        ),
        alt,
        main=("hosts_2012", f"{special}, `jit-2ulps`: `x87`"),
    )


def fast_math(r):
    change = lambda name, build: wrong_in(r, "other than `cpu`", f"{name}/f32/{build}")
    fused, fast = ([change(name, build)[0] for name in ALGORITHMS] for build in ("cpu-fma", "cpu-fast"))
    pairs = change("moller_1997", "cpu-fma")[1]
    errors = [
        [wrong_in(r, "all", f"{name}/{scalar}/{build}")[0] for build in ("cpu", "cpu-fast")]
        for name in ALGORITHMS
        for scalar in ("f32", "f64")
    ]
    more = sum(fast_wrong > wrong for wrong, fast_wrong in errors)
    for lane in (f"{name}/{scalar}" for name in ALGORITHMS[1:] for scalar in ("f32", "f64")):
        require(wrong_in(r, "uniform", f"{lane}/cpu-fast")[0] == 0, "fast math is right on ordinary pairs")
    least_share = min(f / g for f, g in zip(fused, fast))
    require(least_share > 0.6, "contraction alone changes most of what fast math changes")
    rows = []
    for name, f, g in sorted(zip(ALGORITHMS, fused, fast), key=lambda row: -row[2]):
        rows.append((f"{name}: fast math", 100 * g / pairs, percent(g, pairs), "b"))
        rows.append((f"{name}: contraction alone", 100 * f / pairs, percent(f, pairs), "a"))
    alt = (
        f"Share of float32 verdicts that a build changes, of {count(pairs)} pairs: fast math "
        f"{percent(min(fast), pairs)} to {percent(max(fast), pairs)}, contraction alone {percent(min(fused), pairs)} "
        f"to {percent(max(fused), pairs)}."
    )
    return Result(
        "fast_math",
        f"Fast math changes {percent(min(fast), pairs)} to {percent(max(fast), pairs)} of the float32 verdicts on hard "
        f"pairs; contraction alone changes {percent(min(fused), pairs)} to {percent(max(fused), pairs)}",
        "The same source, compiled once with `-O3 -ffast-math -march=x86-64-v3` and once with contraction alone, "
        f"decides the {count(pairs)} pairs of the default campaign, most of them near contact. The figure counts "
        "verdicts that differ from those of the build that rounds every operation as written. For each test, "
        "contraction alone "
        f"changes at least {percent(least_share, 1, 2, math.floor)} as many verdicts as fast math. A changed verdict "
        "may be "
        f"right or wrong: {word(more)} of {word(len(errors))} lanes ({word(len(ALGORITHMS))} tests, float32 and "
        "float64) err more often with fast math, the others less often. With fast math, GCC divides float32 "
        "numbers with an "
        "approximate reciprocal, whose bits depend on the processor's vendor. These counts hold for an AMD EPYC. On "
        "ordinary pairs (`uniform`), no lane that is right without fast math is wrong with it.",
        bars(alt, f"% of {count(pairs)} verdicts that the build changes, float32", rows),
        alt,
        main=("campaign", "Wrong verdicts of the default campaign, `moller_1997/f32/cpu-fast`: other than `cpu`"),
    )


def processors(r):
    table = "Verdicts of a toolchain, of 1,000,020 pairs of all strata"
    lanes = [f"{name}/{scalar}" for name in ALGORITHMS for scalar in ("f32", "f64")]
    cell = lambda lane, column: r("toolchains", f"{table}, `{lane}`: {column}")
    apart = {lane: cell(lane, "`arm64-gcc`, differs") for lane in lanes}
    x86 = {lane: cell(lane, "`x86-gcc-v3`, differs") for lane in lanes}
    both = "ARM64 without contraction against x86-64, ten lanes: "
    pairs, differ = r("toolchains", both + "pairs of a lane"), r("toolchains", both + "verdicts that differ")
    require(differ == 0, "ARM64 and x86-64 agree without contraction")
    gap = max(abs(apart[lane] - x86[lane]) for lane in lanes)
    require(gap <= 0.2, "x86-64 with contraction changes as many verdicts as ARM64")
    rows = [
        (
            lane.replace("/f32", ", float32").replace("/f64", ", float64"),
            number(apart[lane]),
            f"{count(apart[lane])} %",
            "a",
        )
        for lane in sorted(lanes, key=lambda lane: -apart[lane])
    ]
    rows.append(("every lane, contraction off", number(differ), f"{count(differ)}", "b"))
    low, high = min(apart.values()), max(apart.values())
    alt = (
        f"Share of verdicts on which ARM64 and x86-64 differ, both with GCC's defaults: {count(low)} % to "
        f"{count(high)} % of hard pairs; with contraction off, {count(differ)}."
    )
    return Result(
        "processors",
        f"ARM64 and x86-64 give the same verdicts on {count(pairs)} pairs once contraction is off; with GCC's "
        f"defaults {count(low)} % to {count(high)} % differ",
        "GCC contracts by default where the processor has a fused multiply-add. ARM64 has it, and plain x86-64 does "
        f"not. So verdicts of the same source differ on {count(low)} % to {count(high)} % of {count(of(table))} pairs "
        "of all strata, most of them near contact. GCC changes about as many verdicts when it compiles for x86-64 "
        "processors that have fused multiply-adds (`-march=x86-64-v3`). "
        f"With `-ffp-contract=off`, the {word(len(lanes))} lanes have "
        f"{count(differ)} different verdicts on {count(pairs)} pairs each: with 95 % confidence, fewer than "
        f"{at_most_one_in(pairs)} for each lane. ARM64 code ran under QEMU, whose arithmetic `graze toolchain` checks, "
        "and not on an ARM64 processor. [All toolchains](toolchains.md).",
        bars(alt, f"% of {count(of(table))} pairs: GCC, ARM64 against x86-64", rows),
        alt,
        main=("toolchains", f"{table}, `moller_1997/f32`: `arm64-gcc`, differs"),
    )
