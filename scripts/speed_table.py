# SPDX-License-Identifier: Apache-2.0
"""speed_table.py HOST.json [DEVICE.json]: prints the results of graze_fuzz_bench and graze_device_bench as Markdown.
The files are JSON from Google Benchmark. Each figure is the median of its repetitions."""
import json
import statistics
import sys

EXACT, PROPER, CUDA = "exact/f32/cpu", "exact/f32/cpu,proper", "exact/f32/cuda"
OF_DOUBLES = "/f64"  # ends the names of benchmarks on pairs of doubles
DOUBLES, THESIS = "guigue_devillers_2003/f64/cpu", "interval_overlap/f32/cpu"
BESIDE = {
    EXACT: EXACT,
    DOUBLES: DOUBLES,
    THESIS: THESIS,
    "cgal_epick": "CGAL EPICK",
    "cgal_epeck": "CGAL EPECK",
    "cgal_verdict": "CGAL, Graze's oracle",
    "gmp_contact": "GMP",
}
STAGES = ("bounded", "doubles", "int128", "wide")


def read(path):
    """The file's context, and {decision: {stratum: run}} for float32 pairs and for pairs of doubles. Each value of a
    run is the median of its repetitions."""
    with open(path, encoding="utf-8") as file:
        document = json.load(file)
    repetitions = {}
    for run in document["benchmarks"]:
        if run.get("error_occurred"):
            sys.exit(f"speed_table: {path}: expected figures of {run['name']}, found: {run['error_message']}")
        if run["run_type"] == "iteration":
            repetitions.setdefault(run["run_name"].removesuffix("/manual_time"), []).append(run)
    results, of_doubles = {}, {}
    for name, runs in repetitions.items():
        decision, stratum = name.removesuffix(OF_DOUBLES).rsplit("/", 1)
        (of_doubles if name.endswith(OF_DOUBLES) else results).setdefault(decision, {})[stratum] = {
            key: statistics.median(run[key] for run in runs)
            for key, value in runs[0].items()
            if isinstance(value, (int, float))
        }
    if not results:
        sys.exit(f"speed_table: {path}: the file has no benchmark results")
    context = document["context"]
    context["repetitions"] = max(len(runs) for runs in repetitions.values())
    return context, results, of_doubles


def table(head, rows):
    return "".join(f"| {' | '.join(line)} |\n" for line in (head, ["---"] + ["---:"] * (len(head) - 1), *rows))


def figure(x):
    return f"{x:,.0f}" if x >= 100 else f"{x:.3g}"


def lanes_by_strata(results, unit):
    strata = dict.fromkeys(stratum for runs in results.values() for stratum in runs)
    return table(
        ["lane", *strata],
        [[decision, *(unit(runs[s]) if s in runs else "-" for s in strata)] for decision, runs in results.items()],
    )


def in_doubles(lane, of_doubles, unit, beside):
    """The exact lane on pairs of doubles; empty without such benchmarks. beside: headings and cells of more columns."""
    rows = [[s, unit(run), *(cell(s, run) for cell in beside.values())] for s, run in of_doubles.get(lane, {}).items()]
    return f"\n### Pairs of doubles\n{table(['stratum', lane, *beside], rows)}" if rows else ""


def host(context, results, of_doubles):
    nanoseconds = lambda run: figure(1e9 / run["items_per_second"])
    most = max(run["pairs"] for run in results[EXACT].values())
    rows = []
    for stratum, exact in results[EXACT].items():
        of = {decision: results[decision].get(stratum) for decision in (*BESIDE, PROPER)}
        ratio = lambda l, r: f"{of[r]['items_per_second'] / of[l]['items_per_second']:.2f}" if of[l] and of[r] else "-"
        proper = of["cgal_epick"]["pairs"] / exact["pairs"] if of["cgal_epick"] else 0
        rows.append(
            [
                stratum,
                *(nanoseconds(of[d]) if of[d] else "-" for d in BESIDE),
                ratio(EXACT, DOUBLES),
                ratio("cgal_epick", PROPER),
                f"{100 * proper:.3g} %",
            ]
        )
    epick, of_proper = of_doubles.get("cgal_epick", {}), of_doubles.get("exact/f64/cpu,proper", {})
    beside = {
        "CGAL EPICK": lambda s, run: nanoseconds(epick[s]) if s in epick else "-",
        "EPICK / exact": lambda s, run: (
            f"{of_proper[s]['items_per_second'] / epick[s]['items_per_second']:.2f}" if s in epick else "-"
        ),
    }
    return f"""## CPU: nanoseconds per pair on one core
{context['processor']}, {context['num_cpus']} cores; {context['compiler']}, `{context['flags']}`; commit `{context['commit']}`.
Median of {context['repetitions']} repetitions, CPU time, on the same pairs of each stratum (seed 1, at most {most:,.0f}). They are in the cache, so arithmetic and branches limit the speed, not memory.
All exact decisions agreed with the oracle on every timed pair. CGAL's `do_intersect` (on triangles made beforehand) takes only pairs without degenerate triangles: its times, and EPICK / exact, cover only these pairs. The last column has their share.

{table(["stratum", *BESIDE.values(), "exact / gd f64", "EPICK / exact", "not degenerate"], rows)}
### Every host lane, with CGAL and GMP for comparison
`proper`: over the pairs that CGAL takes.

{lanes_by_strata(results, nanoseconds)}{in_doubles("exact/f64/cpu", of_doubles, nanoseconds, beside)}"""


def device(context, results, of_doubles):
    memory = {kind: results[kind]["memory"]["bytes_per_second"] for kind in ("copy", "read")}
    giga = lambda run: figure(run["items_per_second"] / 1e9)
    share = lambda run, kind: f"{100 * run['bytes_per_second'] / memory[kind]:.3g} %"
    read_doubles = of_doubles["read"]["memory"]["bytes_per_second"] if of_doubles else 0
    of_read = lambda s, run: f"{100 * run['bytes_per_second'] / read_doubles:.3g} %"
    rows = [
        [
            stratum,
            giga(run),
            share(run, "copy"),
            share(run, "read"),
            *(f"{100 * run[stage] / sum(run[s] for s in STAGES):.3g} %" for stage in STAGES),
        ]
        for stratum, run in results[CUDA].items()
    ]
    lanes = {decision: runs for decision, runs in results.items() if decision not in memory}
    return f"""## GPU: 10^9 pairs per second, resident pairs
{context['device']}, CUDA {context['driver']}; nvcc {context['nvcc']}, `{context['flags']}`; commit `{context['commit']}`.
The limit is the memory: each pair takes 72 bytes to read. Measured in the same run: a copy moves {memory['copy'] / 1e12:.3g} * 10^12 bytes/s (read and written), which is {memory['copy'] / 72e9:.3g} * 10^9 pairs/s; a kernel that only reads the pairs, {memory['read'] / 72e9:.3g} * 10^9.
Median of {context['repetitions']} repetitions on 2^24 pairs of each stratum (seed 1). The exact lane gave the host's bits on the first 65,536 of each.

{table(["stratum", CUDA, "of copy", "of read", *(f"decided by {stage}" for stage in STAGES)], rows)}
### Every CUDA lane

{lanes_by_strata(lanes, giga)}{in_doubles("exact/f64/cuda", of_doubles, giga, {"of read": of_read})}"""


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    print("# Speed\nWritten by `scripts/benchmark`.\n")
    print(host(*read(sys.argv[1])))
    if len(sys.argv) == 3:
        print(device(*read(sys.argv[2])))
