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
# Each file is a section of the page, in this order.
TOPICS = (
    "agreement",
    "discrepancy",
    "hosts_2012",
    "toolchains",
    "campaign",
    "stored",
    "league",
    "exact",
    "gpu_engine",
    "cpu_engine",
    "query",
    "policies",
    "minimiser",
    "search",
    "invariants",
    "subjects",
    "tests",
    "viewer",
    "scale",
    "build",
)

NUMBER = "a number or [low, high]"
# The keys of a record and its run: required, then optional.
RECORD = {"metric": str, "value": NUMBER, "unit": str}
RECORD |= {"machine": str, "toolkit": str, "date": datetime.date, "command": str}
RECORD_MAY = {"commit": str, "by": str, "before": str, "baseline": NUMBER, "limit": NUMBER, "run": dict, "grid": dict}
GRID, GRID_MAY = {"metric": str, "rows": str, "columns": list, "cells": dict}, {"units": list}
COMMIT = re.compile("[0-9a-f]{7,12}")
HEAD = """# Measurements
Written by `scripts/measurements.py` from the records in [docs/measurements](measurements/README.md); do not edit.

- **value** is the newest value of the metric on that machine; a range is written "low to high".
- **before** is the value that the same run measured for the commit before a change; otherwise it is the previous record's value.
- **limit** is the best value that the hardware or the method allows, or the largest value that is permitted.
- **commit** names the sources that were measured. If that commit was not recorded, "by" names the commit that added the figure.
- **how** is the number of the command in the list under the table.

[measurements/not_taken.md](measurements/not_taken.md) lists ideas that were tried and rejected.

| machine | |
|---|---|
"""


class Malformed(Exception):
    """A record violates the format in docs/measurements/README.md."""


def is_a(kind, value):
    if kind == NUMBER:
        pair = value if isinstance(value, list) and len(value) == 2 else [value]
        return all(isinstance(x, (int, decimal.Decimal)) and not isinstance(x, bool) for x in pair)
    return isinstance(value, kind)


def check(where, found, required, optional):
    for key, kind in required.items():
        if key not in found:
            raise Malformed(f"{where}: `{key}` is missing")
    for key, value in found.items():
        kind = required.get(key) or optional.get(key)
        if kind is None:
            raise Malformed(f"{where}: unknown key `{key}`")
        if not is_a(kind, value) or (value == "" and key != "unit"):
            raise Malformed(f"{where}: `{key}` is {value!r}; it must be {kind if kind == NUMBER else kind.__name__}")


def grid_records(where, grid, unit):
    check(f"{where}, grid", grid, GRID, GRID_MAY)
    columns = grid["columns"]
    units = grid.get("units", [unit] * len(columns))
    for row, values in grid["cells"].items():
        if len(values) != len(columns) or len(units) != len(columns):
            raise Malformed(f"{where}, grid: {row} or the units are not as many as the {len(columns)} columns")
        for column, value, its_unit in zip(columns, values, units):
            if value != "":
                metric = f"{grid['metric']}, {row}: {column}"
                yield {"metric": metric, "value": value, "unit": its_unit, "grid": grid}


def records(name, topic, machines):
    """Returns: one record for each measurement, oldest first, with its run under "run". Throws: Malformed."""
    found = []
    for i, run in enumerate(topic["run"], 1):
        where = f"{name}.toml, run {i}"
        of_run = {"run": run} | {key: run[key] for key in run if key not in ("results", "grid", "note")}
        if not is_a(str, run.get("note", "none")):
            raise Malformed(f"{where}: `note` is {run['note']!r}; it must be str")
        measured = list(run.get("results", []))
        if "grid" in run:
            measured += grid_records(where, run["grid"], run.get("unit", ""))
        if not measured:
            raise Malformed(f"{where}: has neither `results` nor `grid`")
        for record in (of_run | result for result in measured):
            check(f"{where}, {record.get('metric', 'a result')}", record, RECORD, RECORD_MAY)
            if ("commit" in record) == ("by" in record):
                raise Malformed(f"{where}: needs `commit` or `by`, and not both")
            for key in {"commit", "by", "before"} & record.keys():
                if not COMMIT.fullmatch(record[key]):
                    raise Malformed(f"{where}: `{key}` is {record[key]!r}, which is no abbreviated commit")
            if record["machine"] not in machines:
                raise Malformed(f"{where}: machine {record['machine']!r} is not in machines.toml")
            if found and record["date"] < found[-1]["date"]:
                raise Malformed(f"{where}: runs must be in the order of their dates, the newest last")
            found.append(record)
    return found


def current(found):
    """Returns: the newest record for each metric and machine, in the order of the metrics' first records."""
    newest = {}
    for record in found:
        key, run = (record["metric"], record["machine"]), record["run"]
        if key in newest and newest[key]["run"] is run:
            raise Malformed(f"{key[0]!r} is measured twice in one run")
        older = {"baseline": newest[key]["value"]} if key in newest else {}
        newest[key] = older | record
    return list(newest.values())


def read(folder=RECORDS):
    """Returns: the machines, and the topics by name. Throws: Malformed."""
    files = {
        path.stem: tomllib.loads(path.read_text(encoding="utf-8"), parse_float=decimal.Decimal)
        for path in sorted(folder.glob("*.toml"))
    }
    machines = files.pop("machines", {})
    if set(files) != set(TOPICS):
        raise Malformed(f"{folder}: TOPICS and the files differ by {sorted(set(files) ^ set(TOPICS))}")
    for name, topic in files.items():
        check(f"{name}.toml", topic, {"title": str, "run": list}, {"about": str})
    return machines, {name: files[name] for name in TOPICS}


def text(value, unit=""):
    """A number as it is written, with thousands separators, and its unit."""
    if value is None:
        return ""
    number = " to ".join(
        f"{x:,f}" if isinstance(x, decimal.Decimal) else f"{x:,}"
        for x in (value if isinstance(value, list) else [value])
    )
    return number + ("" if not unit else f" × {unit}" if unit.startswith("10^") else f" {unit}")


def commit_of(run):
    return f"`{run['commit']}`" if "commit" in run else f"by `{run['by']}`"


def line(*cells):
    return f"| {' | '.join(cells)} |\n"


def table_of_results(newest, how):
    page = "\n" + line("metric", "value", "before", "limit", "machine", "commit", "how")
    page += "|---|---:|---:|---:|---|---|---|\n"
    for record in newest:
        numbers = text(record["value"], record["unit"]), text(record.get("baseline")), text(record.get("limit"))
        page += line(record["metric"], *numbers, record["machine"], commit_of(record), how(record))
    return page


def table_of_grid(newest, how):
    run, grid = newest[0]["run"], newest[0]["grid"]
    values = {record["metric"]: text(record["value"]) for record in newest}
    head = [f"{column} ({unit})" if unit else column for column, unit in zip(grid["columns"], grid.get("units", []))]
    unit = f", {run['unit']}" if not head and run["unit"] else ""
    page = f"\n**{grid['metric']}**{unit} ({run['machine']}, {commit_of(run)}, how: {how(newest[0])})\n\n"
    page += line(grid["rows"], *(head or grid["columns"])) + line("---", *["---:"] * len(grid["columns"]))
    for row in grid["cells"]:
        page += line(row, *(values.get(f"{grid['metric']}, {row}: {column}", "") for column in grid["columns"]))
    return page


def section(name, topic, machines):
    newest = sorted(current(records(name, topic, machines)), key=lambda record: list(machines).index(record["machine"]))
    runs = [run for run in topic["run"] if any(record["run"] is run for record in newest)]
    how = lambda record: str(next(i for i, run in enumerate(runs, 1) if run is record["run"]))
    page = f"\n## {topic['title']}\n" + (topic["about"].strip() + "\n" if "about" in topic else "")
    results = [record for record in newest if "grid" not in record]
    if results:
        page += table_of_results(results, how)
    for run in runs:
        cells = [record for record in newest if record["run"] is run and "grid" in record]
        if cells:
            page += table_of_grid(cells, how)
    page += "\nHow:\n"
    for i, run in enumerate(runs, 1):
        before = f" Before: `{run['before']}`." if "before" in run else ""
        note = f" {run['note'].strip()}" if "note" in run else ""
        page += f"{i}. {run['command']}; {run['toolkit']}; {run['date']}.{before}{note}\n"
    return page


def render(folder=RECORDS):
    """Returns: the text of the page. Throws: Malformed."""
    machines, topics = read(folder)
    return (
        HEAD
        + "".join(line(name, what) for name, what in machines.items())
        + "".join(section(name, topic, machines) for name, topic in topics.items())
    )


if __name__ == "__main__":
    try:
        PAGE.write_text(render(), encoding="utf-8")
    except (Malformed, tomllib.TOMLDecodeError) as why:
        sys.exit(f"measurements: {why}")
