# SPDX-License-Identifier: Apache-2.0
"""verdicts_apart.py CAMPAIGN SUBJECT ROW,… COLUMN,…: prints as Markdown how often the verdicts of two lanes of a
subject differ. ROW and COLUMN are lane names without the subject, such as f32/cpu. A cell N (A to B) means that one
pair in N differs, with the 95 % interval from A to B, rounded outward. If no pair differs, the cell is 0 (over A)."""
import json
import math
import pathlib
import sys

Z = 1.959964  # 95 %


def refuse(why):
    sys.exit(f"verdicts_apart: {why}")


def read(campaign):
    """The campaign's summary."""
    path = pathlib.Path(campaign, "summary.json")
    try:
        with open(path, encoding="utf-8") as file:
            summary = json.load(file)
    except (OSError, ValueError) as error:
        refuse(f"cannot read {path}: {error}; expected the folder of a finished campaign of graze fuzz")
    if not summary.get("complete"):
        refuse(f"{path}: the campaign is not finished; run it again with the same command")
    return summary


def answers(signatures, subject):
    """[(number of pairs, {lane: how it is wrong})] for the pairs on which a lane of the subject is wrong."""
    found = []
    for signature in signatures:
        place, lanes = signature["key"].split(":", 1)
        if place.rsplit("/", 1)[1] == subject:
            found.append((signature["count"], {lane[1:]: lane[0] for lane in lanes.split(";")}))
    return found


def wilson(count, of):
    """95 % interval of a share, by Wilson's score."""
    middle, half = count + Z * Z / 2, Z * math.sqrt(count * (of - count) / of + Z * Z / 4)
    return (middle - half) / (of + Z * Z), (middle + half) / (of + Z * Z)


def cell(count, of):
    low, high = wilson(count, of)
    if count == 0:
        return f"0 (over {math.floor(1 / high):,})"
    return f"{of / count:,.0f} ({math.floor(1 / high):,} to {math.ceil(1 / low):,})"


def main(campaign, subject, rows, columns):
    summary = read(campaign)
    rows, columns = rows.split(","), columns.split(",")
    strata = summary["strata"].values()
    for lane in rows + columns:
        if not all(f"{subject}/{lane}" in stratum["lanes"] for stratum in strata):
            refuse(f"{campaign}: no lane {subject}/{lane}; its summary.json lists the lanes")
    pairs, wrong = sum(stratum["pairs"] for stratum in strata), answers(summary["signatures"], subject)
    print(f"| {pairs:,} pairs |" + "".join(f" `{column}` |" for column in columns))
    print("|---|" + "---|" * len(columns))
    for row in rows:
        apart = (sum(n for n, how in wrong if how.get(row) != how.get(column)) for column in columns)
        print(f"| `{row}` |" + "".join(f" {cell(count, pairs)} |" for count in apart))


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
