# SPDX-License-Identifier: Apache-2.0
"""measurements.py: writes docs/measurements.md from the records in docs/measurements/*.toml (README.md there)."""
import datetime
import decimal
import pathlib
import re
import sys
import tomllib

DOCS = pathlib.Path(__file__).resolve().parent.parent / "docs"
RECORDS, PAGE = DOCS / "measurements", DOCS / "measurements.md"
# One section of the page for each file, in this order.
TOPICS = ("agreement", "exact", "gpu_engine", "cpu_engine", "query", "policies", "minimiser", "search", "laws", "subjects",
          "tests", "viewer", "scale", "build")

NUMBER = "a number or [low, high]"
RUN = {"machine": str, "toolkit": str, "date": datetime.date, "command": str}  # what every run has
RUN_MAY = {"commit": str, "by": str, "before": str, "unit": str, "note": str, "results": list, "grid": dict}
RESULT, RESULT_MAY = {"metric": str, "value": NUMBER}, {"unit": str, "baseline": NUMBER, "limit": NUMBER}
GRID, GRID_MAY = {"metric": str, "rows": str, "columns": list, "cells": dict}, {"units": list}
COMMIT = re.compile("[0-9a-f]{7,12}")
HEAD = """# Measurements
Written by `scripts/measurements.py` from the records in [docs/measurements](measurements/README.md); do not edit.

- **value** is the newest value of the metric on that machine; a range is written "low to high".
- **before** is the value that the same run measured for the commit before a change, or else the previous record's value.
- **limit** is the best that the hardware or the method allows, or the most that is permitted.
- **commit** names the sources that were measured. "by" names the commit that added the figure, where the sources were not noted.
- **how** is the number of the command under the table.

What was tried and not taken: [measurements/not_taken.md](measurements/not_taken.md).

| machine | |
|---|---|
"""


class Malformed(Exception):
    """A record that is not as docs/measurements/README.md says."""


def is_a(kind, value):
    if kind == NUMBER:
        pair = value if isinstance(value, list) and len(value) == 2 else [value]
        return all(isinstance(x, (int, decimal.Decimal)) and not isinstance(x, bool) for x in pair)
    return isinstance(value, kind)


def check(where, found, required, optional):
    for key, kind in required.items():
        if key not in found: raise Malformed(f"{where}: `{key}` is missing")
    for key, value in found.items():
        kind = required.get(key) or optional.get(key)
        if kind is None: raise Malformed(f"{where}: unknown key `{key}`")
        if not is_a(kind, value) or (value == "" and key != "unit"): raise Malformed(f"{where}: `{key}` is {value!r}; it must be {kind if kind == NUMBER else kind.__name__}")


def check_run(where, run, machines):
    check(where, run, RUN, RUN_MAY)
    if ("commit" in run) == ("by" in run): raise Malformed(f"{where}: needs `commit` or `by`, and not both")
    for key in {"commit", "by", "before"} & run.keys():
        if not COMMIT.fullmatch(run[key]): raise Malformed(f"{where}: `{key}` is {run[key]!r}, which is no abbreviated commit")
    if run["machine"] not in machines: raise Malformed(f"{where}: machine {run['machine']!r} is not in machines.toml")
    if "results" not in run and "grid" not in run: raise Malformed(f"{where}: has neither `results` nor `grid`")
    for i, result in enumerate(run.get("results", []), 1):
        check(f"{where}, result {i}", result, RESULT, RESULT_MAY)
        if "unit" not in result and "unit" not in run: raise Malformed(f"{where}, result {i}: `unit` is missing")
    if "grid" in run:
        grid = run["grid"]
        check(f"{where}, grid", grid, GRID, GRID_MAY)
        if "units" not in grid and "unit" not in run: raise Malformed(f"{where}, grid: `unit` is missing")
        for row in (grid.get("units", grid["columns"]), *grid["cells"].values()):
            if len(row) != len(grid["columns"]): raise Malformed(f"{where}, grid: expected {len(grid['columns'])} columns, found {row}")
        for name, row in grid["cells"].items():
            for value in row:
                if value != "" and not is_a(NUMBER, value): raise Malformed(f"{where}, grid: {name} has {value!r}; it must be {NUMBER}, or \"\"")


def read(folder=RECORDS):
    """Returns: the machines, and the topics by name. Throws: Malformed."""
    files = {path.stem: tomllib.loads(path.read_text(encoding="utf-8"), parse_float=decimal.Decimal) for path in sorted(folder.glob("*.toml"))}
    machines = files.pop("machines", {})
    if set(files) != set(TOPICS): raise Malformed(f"{folder}: TOPICS and the files differ by {sorted(set(files) ^ set(TOPICS))}")
    for name, topic in files.items():
        check(f"{name}.toml", topic, {"title": str, "run": list}, {"about": str})
        for i, run in enumerate(topic["run"], 1): check_run(f"{name}.toml, run {i}", run, machines)
        dates = [run["date"] for run in topic["run"]]
        if dates != sorted(dates): raise Malformed(f"{name}.toml: runs must stand in the order of their dates, the newest last")
    return machines, {name: files[name] for name in TOPICS}


def records(topic):
    """Returns: one record a measurement, oldest first: its own keys and those of its run, which is under "run"."""
    found = []
    for run in topic["run"]:
        of_run = {"run": run, **{key: run[key] for key in run if key not in ("results", "grid", "note")}}
        found += [{**of_run, **result} for result in run.get("results", [])]
        grid = run.get("grid", {"cells": {}})
        for row, values in grid["cells"].items():
            for i, value in enumerate(values):
                if value == "": continue
                unit = grid["units"][i] if "units" in grid else run["unit"]
                found.append({**of_run, "metric": f"{grid['metric']}, {row}: {grid['columns'][i]}", "value": value, "unit": unit})
    return found


def current(found):
    """Returns: of each metric and machine the newest record, in the order in which metrics first came."""
    newest = {}
    for record in found:
        key, run = (record["metric"], record["machine"]), record["run"]
        if key in newest and newest[key]["run"] is run: raise Malformed(f"{key[0]!r} is measured twice in one run")
        older = {"baseline": newest[key]["value"]} if key in newest else {}
        newest[key] = {**older, **record}
    return list(newest.values())


def text(value, unit=""):
    """A number as it was written, with separators of thousands, and its unit."""
    if value is None: return ""
    number = " to ".join(f"{x:,f}" if isinstance(x, decimal.Decimal) else f"{x:,}" for x in (value if isinstance(value, list) else [value]))
    return number + ("" if not unit else f" × {unit}" if unit.startswith("10^") else f" {unit}")


def commit_of(run):
    return f"`{run['commit']}`" if "commit" in run else f"by `{run['by']}`"


def line(cells):
    return f"| {' | '.join(cells)} |\n"


def table_of_grid(run, how, shown):
    grid = run["grid"]
    units = grid.get("units", [""] * len(grid["columns"]))
    head = [grid["rows"], *(f"{column} ({unit})" if unit else column for column, unit in zip(grid["columns"], units))]
    page = f"\n**{grid['metric']}**{'' if 'units' in grid or not run['unit'] else ', ' + run['unit']} ({run['machine']}, {commit_of(run)}, how: {how})\n\n"
    page += line(head) + line(["---", *["---:"] * len(grid["columns"])])
    for row, values in grid["cells"].items():
        names = (f"{grid['metric']}, {row}: {column}" for column in grid["columns"])
        page += line([row, *(text(value) if name in shown and value != "" else "" for name, value in zip(names, values))])
    return page


def section(topic, machines):
    newest = sorted(current(records(topic)), key=lambda record: list(machines).index(record["machine"]))
    runs = [run for run in topic["run"] if any(record["run"] is run for record in newest)]
    how = {id(run): i for i, run in enumerate(runs, 1)}
    page = f"\n## {topic['title']}\n" + (topic["about"].strip() + "\n" if "about" in topic else "")
    of_grids = {id(run): {record["metric"] for record in newest if record["run"] is run} - {result["metric"] for result in run.get("results", [])}
                for run in runs}
    rows = [record for record in newest if record["metric"] not in of_grids[id(record["run"])]]
    if rows:
        page += "\n" + line(["metric", "value", "before", "limit", "machine", "commit", "how"]) + "|---|---:|---:|---:|---|---|---|\n"
    for record in rows:
        page += line([record["metric"], text(record["value"], record["unit"]), text(record.get("baseline")), text(record.get("limit")),
                      record["machine"], commit_of(record), str(how[id(record["run"])])])
    for run in runs:
        if of_grids[id(run)]: page += table_of_grid(run, how[id(run)], of_grids[id(run)])
    page += "\nHow:\n"
    for run in runs:
        before = f" Before: `{run['before']}`." if "before" in run else ""
        note = f" {run['note'].strip()}" if "note" in run else ""
        page += f"{how[id(run)]}. {run['command']}; {run['toolkit']}; {run['date']}.{before}{note}\n"
    return page


def render(folder=RECORDS):
    """Returns: the text of the page. Throws: Malformed."""
    machines, topics = read(folder)
    return HEAD + "".join(line([name, what]) for name, what in machines.items()) + "".join(section(topic, machines) for topic in topics.values())


if __name__ == "__main__":
    try:
        PAGE.write_text(render(), encoding="utf-8")
    except (Malformed, tomllib.TOMLDecodeError) as why:
        sys.exit(f"measurements: {why}")
