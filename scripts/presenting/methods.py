# SPDX-License-Identifier: Apache-2.0
"""Results about tests: their costs, their error rates, and the effect of an epsilon."""
import math
import re

from presenting.figures import bars, curves, dots, ratios
from presenting.records import (
    at_most_one_in,
    at_most_percent,
    count,
    percent,
    percent_interval,
    require,
    times,
    within_points,
    word,
)
from presenting.result import ALGORITHMS, Result, of, wrong_in


STRATA = (
    "uniform thesis near_vertex_face near_edge_edge near_vertex_edge near_vertex_vertex coplanar_lattice coplanar_wide "
    "exact_contact coplanar_rounded parallel sliver degenerate shared_vertex shared_edge far_from_origin extreme_scale "
    "mixed_scale lattice thesis_special nested"
).split()


def price(r):
    cost = lambda stratum, lane: r("policies", f"Cost of a pair by stratum, float32, `{stratum}`: {lane}")
    exact = {stratum: cost(stratum, "`exact`") for stratum in STRATA}
    axes = {stratum: cost(stratum, "`separating_axes`") for stratum in STRATA}
    ratio = {stratum: exact[stratum] / axes[stratum] for stratum in STRATA}
    alone = [
        cost(stratum, "`exact`, one a call") / cost(stratum, "`guigue_devillers_2003`, one a call")
        for stratum in STRATA
    ]
    order = sorted(STRATA, key=ratio.get)
    cheaper, last = sum(x < 1 for x in ratio.values()), order[-1]
    gpu, fastest = (r("policies", f"near strata, resident: `{lane}`") for lane in ("exact", "moller_1997/f32"))
    against = "exact lanes against CGAL, 100,000,000 pairs: pairs that differ"
    require(r("exact", against) == 0 and gpu > fastest, "exact agrees with CGAL, and is dearer on a GPU")
    usual = ("uniform", "near_vertex_face", "near_edge_edge", "near_vertex_edge", "near_vertex_vertex", "shared_vertex")
    require(all(ratio[stratum] < 1 for stratum in usual + ("shared_edge",)), "where exact is cheaper")
    dear = ("coplanar_wide", "degenerate", "mixed_scale", "nested", "exact_contact")
    require(set(order[-5:]) == set(dear), "where exact is dearest")
    alt = (
        "Time of the exact decision over that of separating_axes in float32, by stratum: from "
        f"{times(ratio[order[0]])} on {order[0].replace('_', ' ')} to {times(ratio[last])} on "
        f"{last.replace('_', ' ')}."
    )
    return Result(
        "price",
        f"Exact costs less than float32 on {count(cheaper)} of {count(len(STRATA))} strata, and at most "
        f"{times(ratio[last], math.ceil)} as much on the others",
        f"The exact decision gives the same verdict as CGAL on all {count(of(against))} pairs of nineteen strata (so "
        f"with 95 % confidence they differ on fewer than {at_most_one_in(of(against))}; `thesis_special` and `nested` "
        "were added later). The figure compares its time with "
        "that of `separating_axes` in float32, the published test that also decides several pairs at once in the "
        f"processor's vectors. On `uniform`, exact takes {count(exact['uniform'])} ns a pair and "
        f"`separating_axes` {count(axes['uniform'])} ns. Exact is cheaper on these random pairs, on pairs that "
        "nearly touch, and on pairs that share a vertex or an edge. Exact costs most where triangles are exactly "
        "coplanar or "
        f"degenerate, touch exactly, or have very different sizes: up to {count(exact[last])} ns against "
        f"{count(axes[last])} ns (`{last}`). In calls of one pair, it takes {times(min(alone), math.floor)} to "
        f"{times(max(alone), math.ceil)} as long as `guigue_devillers_2003`. Times are medians on one core of a "
        f"shared machine. On an H200, exact takes {count(gpu)} ns on near pairs, and `moller_1997` in float32 "
        f"{count(fastest)} ns.",
        ratios(
            alt,
            "time of exact over that of separating_axes, float32",
            [(stratum, ratio[stratum], times(ratio[stratum]), "a" if ratio[stratum] < 1 else "b") for stratum in order],
        ),
        alt,
        main=("policies", "Cost of a pair by stratum, float32, `uniform`: `exact`"),
    )


def which(r):
    lanes = {scalar: [f"{name}/{scalar}/cpu" for name in ALGORITHMS] for scalar in ("f32", "f64")}
    wrong = lambda column, lane: wrong_in(r, column, lane)[0]
    groups = ("general", "coplanar", "degenerate", "extreme")
    for scalar, column in ((scalar, column) for scalar in lanes for column in groups):
        least = "guigue_devillers_2003" if (scalar, column) == ("f32", "extreme") else "separating_axes"
        best = min(lanes[scalar], key=lambda lane: wrong(column, lane))
        require(best == f"{least}/{scalar}/cpu", f"{least} errs least in {scalar} on {column} pairs")
    both = lanes["f32"] + lanes["f64"]
    right = [lane for lane in both if wrong("uniform", lane) == 0]
    require(
        {lane.split("/")[0] for lane in both if lane not in right} == {"projected_sat"}, "who errs on uniform pairs"
    )
    logic = [wrong("uniform", lanes[scalar][0]) for scalar in lanes]
    require(logic[0] == logic[1], "projected_sat errs on the same number of uniform pairs in both precisions")
    require(all(wrong(column, "exact/f32/cpu") == 0 for column in groups), "exact is never wrong")
    share = lambda column, lane: percent(*wrong_in(r, column, lane))
    axes, axes32, devillers32 = "separating_axes/f64/cpu", "separating_axes/f32/cpu", "guigue_devillers_2003/f32/cpu"
    others = sorted(wrong("general", lane) for lane in lanes["f64"] if lane != axes)
    pairs = wrong_in(r, "general", axes)[1]
    rows, scalars = [], {"f32": "float32", "f64": "float64"}
    for lane in sorted(both, key=lambda lane: -wrong("general", lane)) + ["exact/f32/cpu"]:
        name, scalar, _ = lane.split("/")
        label = "exact, for float32 and float64" if name == "exact" else f"{name}, {scalars[scalar]}"
        kind = {"f32": "c", "f64": "a"}[scalar] if name != "exact" else "b"
        rows.append((label, 100 * wrong("general", lane) / pairs, share("general", lane), kind))
    alt = (
        f"Share of wrong verdicts on {count(pairs)} pairs of the group general: from "
        f"{percent(wrong('general', lanes['f32'][1]), pairs)} of interval_overlap in float32 to "
        f"{share('general', axes)} of separating_axes in float64; exact has none."
    )
    return Result(
        "which",
        f"In float64 `separating_axes` errs least, on {share('general', axes)} of hard pairs in the group `general`, "
        f"against {percent(others[0], pairs)} to {percent(others[-1], pairs)} for the other {word(len(others))} published "
        "tests",
        f"The default campaign ran every test on {count(wrong_in(r, 'all', axes)[1])} pairs of nineteen strata "
        "(`thesis_special` and `nested` were added later). Most of its pairs are near contact by design, so the "
        "shares compare tests and are not those of your scene. On `uniform`, where "
        f"triangles are random, {word(len(right))} of {word(len(both))} lanes (a test in a precision) are right on "
        f"all {count(wrong_in(r, 'uniform', axes)[1])} pairs (95 %: wrong on at most "
        f"{at_most_percent(wrong_in(r, 'uniform', axes)[1])}); `projected_sat` is wrong on "
        f"{share('uniform', lanes['f64'][0])}, in float64 too, because its logic is wrong. In the group of strata "
        "`general` (triangles of usual shape and size, most of them with near or exact contacts) `separating_axes` in "
        f"float64 is wrong on {share('general', axes)} (95 % interval "
        f"{percent_interval(wrong('general', axes), pairs)}). It also errs least in the groups `coplanar` "
        f"({share('coplanar', axes)}), `degenerate` ({share('degenerate', axes)}) and `extreme` "
        f"({share('extreme', axes)}). A group's name says what its strata aim at, not what each of its pairs is; "
        "`graze strata` describes them. If you must stay in float32, `separating_axes` again errs least "
        f"({share('general', axes32)} in `general`), except in `extreme`, where `guigue_devillers_2003` errs least "
        f"({share('extreme', devillers32)} against {share('extreme', axes32)}). If a wrong verdict matters, use "
        "`exact`, which is wrong on no pair.",
        bars(alt, f"% of {count(pairs)} pairs of the group general on which a test is wrong", rows),
        alt,
        main=("campaign", f"Wrong verdicts of the default campaign, `{axes}`: general"),
    )


# If a library has several lanes, they begin with its name.
LIBRARIES = {
    "cgal": "CGAL",
    "sfcgal": "SFCGAL",
    "opencascade": "OpenCASCADE",
    "fcl": "FCL",
    "tetgen": "TetGen",
    "simbody": "Simbody",
    "wild_magic": "Wild Magic",
    "three_mesh_bvh": "three-mesh-bvh",
    "netgen": "Netgen",
    "libccd": "libccd",
    "gts": "GTS",
    "ode": "ODE",
    "open3d": "Open3D",
    "vtk": "VTK",
    "bullet": "Bullet",
}


def league(r):
    table = "Pairs on which a lane fails, "
    clear = {}
    for topic, metric in r.found:
        found = re.fullmatch(table + "`(.*)`: clear", metric)
        library = found and next((key for key in LIBRARIES if found[1].startswith(key)), None)
        if topic == "league" and library:
            clear[found[1]] = library, r(topic, metric)
    libraries, findings = r("league", "libraries"), r("league", "findings of the league, [docs/findings](findings)")
    pairs = r("league", "pairs that go to the lanes")
    require(
        {library for library, _ in clear.values()} == set(LIBRARIES) and len(LIBRARIES) == libraries, "the libraries"
    )
    bad = {lane: (library, failures) for lane, (library, failures) in clear.items() if failures > 0}
    wrong = {library for library, _ in bad.values()}
    double = sorted({LIBRARIES[library] for lane, (library, _) in bad.items() if "/f64/" in lane}, key=str.lower)
    inexact = [lane for lane in bad if lane.startswith("cgal")]
    require(inexact == ["cgal_simple_cartesian/f32/cpu"], "CGAL is clearly wrong only with floats as its numbers")
    rows = []
    for lane, (library, failures) in sorted(bad.items(), key=lambda item: -item[1][1]):
        name, scalar, _ = lane.split("/")
        function = name.removeprefix(library).removeprefix("_double").strip("_").replace("_", " ")
        label = f"{LIBRARIES[library]} {function}".strip() + {"f32": ", float32", "f64": ", float64"}[scalar]
        rows.append((label, failures, count(failures), "b"))
    most = rows[0]
    alt = (
        f"Clearly wrong verdicts of the {word(len(rows))} library lanes that have any, from {most[2]} "
        f"({most[0].replace(', float32', '').replace(', float64', '')}) to {rows[-1][2]}."
    )
    return Result(
        "league",
        f"{word(len(wrong)).title()} of {count(libraries)} libraries are clearly wrong on proper triangles, and "
        f"{word(findings)} findings are written as bug reports",
        f"The league runs the triangle tests of {count(libraries)} libraries on the same {count(pairs)} pairs; "
        "slow libraries get only the first pairs of each stratum. A wrong verdict is *clearly* wrong if the triangles "
        "are proper, are neither coplanar nor needles, have no extreme coordinates, and are at least 2^12 ulps of "
        "the largest coordinate (in float32) away from touching: no convention and no rounding of the input excuses "
        f"it. The figure shows the {word(len(rows))} lanes, of {count(len(clear))}, with clearly wrong verdicts. "
        f"{word(len(double)).title()} libraries "
        f"have such verdicts in float64 too ({', '.join(double)}). CGAL appears only with its kernel that computes in "
        "plain float32; its exact kernels have no such verdicts. None of the pairs is from an application, and a "
        "library without such verdicts can still fail on closer pairs: [the league](../league.md) has all groups. Each "
        f"of these {word(findings)} findings has the smallest pair and a program that shows the failure with Debian "
        "12's packages; the [list](../league.md#findings) has more, about libraries from npm that are not in the "
        "league. Nothing was sent to the libraries' authors.",
        dots(alt, f"clearly wrong verdicts, of at most {count(pairs)} (logarithmic)", rows, (0, 4)),
        alt,
        main=("league", "pairs that go to the lanes"),
    )


def epsilon(r):
    about = "relocation, `guigue_devillers_2003/f32/cpu`, all strata: "
    at = lambda metric, key="value": r("policies", about + metric, key)
    pairs, sample = at("pairs"), at("pairs of the sweep")
    fixes, breaks = at("wrong verdicts that the best tolerance fixes"), at("right verdicts that it breaks")
    missed, missed_before = at("false negatives"), at("false negatives", "baseline")
    false, false_before = at("false positives"), at("false positives", "baseline")
    require(missed < missed_before and false > false_before, "false negatives fall and false positives rise")
    require(fixes - breaks == missed_before + false_before - missed - false, "what it fixes and breaks")
    table = "Sweep of `plane_distance` of `guigue_devillers_2003/f32/cpu`, all strata, "
    exponents = range(-10, 11)
    points = {
        kind: [(k, 100 * r("policies", f"{table}`rel:2^{k}`: {kind}") / sample) for k in exponents]
        for kind in ("false negatives", "false positives")
    }
    best = at("wrong verdicts of the best value of all sweeps")
    totals = [n + p for (_, n), (_, p) in zip(*points.values())]
    require(min(totals) >= 100 * best / sample > 5, "no value of the sweep removes the errors")
    scene = "terrain, `moller_1997/f32/cpu/rel:0.0625`: "
    misses, hits = (
        [r("policies", scene + kind, key) for key in ("baseline", "value")] for kind in ("misses", "false hits")
    )
    require(misses[0] > misses[1] and hits[0] < hits[1], "the same in the terrain's scene")
    alt = (
        f"False negatives and false positives against the tolerance, on {count(sample)} pairs: false negatives fall "
        f"from {percent(points['false negatives'][0][1])} to {percent(points['false negatives'][-1][1])}, false "
        f"positives rise from {percent(points['false positives'][0][1])} to "
        f"{percent(points['false positives'][-1][1])}."
    )
    return Result(
        "epsilon",
        f"The best epsilon of `guigue_devillers_2003` fixes {count(fixes)} verdicts and breaks {count(breaks)} others",
        "An epsilon makes numbers near zero count as zero. With it, a test finds touching pairs that it would miss "
        "because of rounding, but also calls some disjoint pairs intersecting. We swept the tolerance of the plane "
        f"distances of `guigue_devillers_2003` in float32 over all strata. On {count(pairs)} pairs "
        "other than those on which it was chosen, the best value lowers "
        f"false negatives from {percent(missed_before, pairs)} to {percent(missed, pairs)}, and raises false positives "
        f"from {percent(false_before, pairs)} to {percent(false, pairs)} (each share to within "
        f"{within_points((missed_before, pairs), (false, pairs))}, 95 %). It fixes more than it breaks. But no "
        f"value, at this comparison or another, leaves fewer than {percent(best, sample, 2, math.floor)} of the "
        "verdicts wrong. In a scene of a terrain, `moller_1997` with its best tolerance goes from "
        f"{count(misses[0])} misses to {count(misses[1])}, and from {count(hits[0])} false hits to {count(hits[1])}. "
        "So choose an epsilon for the error that hurts you, and for your own pairs: [docs/tuning.md](../tuning.md).",
        curves(
            alt,
            "tolerance of plane distances, × machine epsilon × size",
            f"% of {count(sample)} verdicts",
            (-10, -6, -2, 2, 6, 10),
            [
                ("false positives", "b", points["false positives"], 3, 1),
                ("false negatives", "a", points["false negatives"], 4, -1),
            ],
        ),
        alt,
        main=("policies", about + "pairs"),
    )
