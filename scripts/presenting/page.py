# SPDX-License-Identifier: Apache-2.0
"""docs/results/README.md: all results, in their order, as Markdown, and their figures as files."""
import measurements
from presenting.builds import fast_math, hosts, processors, riddle
from presenting.inputs import stored
from presenting.methods import epsilon, league, price, which
from presenting.records import plain

RESULTS = (riddle, hosts, price, which, fast_math, processors, stored, league, epsilon)

# A paragraph of a Markdown file is one line.
HEAD = (
    "# What Graze found\n"
    "Graze runs triangle-triangle intersection tests on pairs of triangles whose exact answer it knows. Here are "
    "its main results, for readers who do not run Graze. Most of its pairs nearly touch, are degenerate or are "
    "coplanar, because tests fail on such pairs. A *stratum* is a family of pairs. Shares of wrong verdicts compare "
    "tests on the same pairs; on your own data they are far smaller. Intervals and bounds have 95 % confidence and are "
    "rounded outward. The [glossary](../glossary.md) defines the terms.\n\n"
)
TAIL = (
    "## More\n"
    "- [toolchains.md](toolchains.md): the same source under many compilers and processors.\n"
    "- [2012.md](2012.md): which toolchains of 2012 come near the difference that the thesis saw; `2012.toml` has its "
    "hosts and devices for `--toolchains`.\n"
    "- [measurements.md](../measurements.md): every record, including those of speed.\n\n"
    "`scripts/results` writes this page and its figures from the records in "
    "[docs/measurements](../measurements/README.md); do not edit the page. A test fails if a record changes and "
    "the page does not, or if the page has a number without a record. `scripts/results --site DIR` writes this page "
    "as a web site, which shows some of the pairs in 3-D.\n"
)


def results(records):
    """Returns: the results, each with the records that it uses. Throws: Unsupported."""
    found = []
    for write in RESULTS:
        records.used = {}
        found.append(write(records))
        found[-1].records = records.used
    return found


def sources(result):
    """Returns: (topic, commit and machine) of the records, the main one first, without duplicates."""
    order = sorted(result.records, key=lambda key: key != result.main)
    found = {}
    for key in order:
        record = result.records[key]
        place = f"{measurements.commit_of(record)}, {record['machine']}, {record['toolkit']}, {record['date']}"
        found[(key[0], place)] = None
    return list(found)


def command(result):
    return result.records[result.main]["command"]


def section(result):
    records = "; ".join(f"[{topic}](../measurements/{topic}.toml) ({place})" for topic, place in sources(result))
    return plain(
        f"## {result.headline}\n![{result.alt}]({result.name}.svg)\n\n{result.paragraph}\n\n"
        f"*Reproduce:* {command(result)}.\n\n*Records:* {records}.\n\n"
    )


def files(results):
    """Returns: the text of each generated file of docs/results."""
    page = HEAD + "".join(section(result) for result in results) + TAIL
    return {"README.md": page} | {f"{result.name}.svg": result.figure for result in results}


def read(path):
    return path.read_text(encoding="utf-8") if path.exists() else None
