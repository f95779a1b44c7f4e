# SPDX-License-Identifier: Apache-2.0
"""Attacks on the verbs that run no campaign: kills, full disks, read-only disks, and two processes at once. At the end,
the bytes must be those of an undisturbed run, except for timings, and no file may be partial. Also checks that the
verbs do not replace files that are not graze's."""
import json
import os
import shutil
import stat
import time

from torture_attacks import outputs, seal
from torture_attacks.bench import Violation, must_agree
from torture_attacks.interruptions import finish_both, made_read_only, small_disk

ATTEMPTS = 3  # verbs in a round
# JSON keys whose values depend on times, including the checksum.
TIMED = set("machine date near far in_cache from_memory one_a_call dominated sentences costs nanoseconds ns".split())
TIMED |= {"updated", "checksum"}
# Files that are not compared. SQLite's files beside the database are not compared either.
ASIDE = {"front.svg", "league.md", "timings.json", "status.json", "campaign.sqlite"}
SUBJECT = "int intersects(const float a[9], const float b[9]) { return a[0] < b[0]; }\n"


def inputs(bench):
    """The folder of the verbs' input files, made once."""
    folder = bench.folder / "inputs"
    if not folder.exists():
        folder.mkdir(parents=True)
        (folder / "mine.c").write_text(SUBJECT)
        (folder / "subjects.txt").write_text(f"mine={folder / 'mine.c'}\n")
        (folder / "pair.txt").write_text(outputs.PAIR)
    return folder


def command(bench, verb, out):
    """The arguments of the verb."""
    folder = inputs(bench)
    few = "--strata near_edge_edge,degenerate --pairs"
    return {
        "tune": lambda: [*f"tune moller_1997/f32/cpu {few} 2000 --threads 2 --out".split(), out],
        "pareto": lambda: [*f"pareto --lanes moller_1997/f32/cpu,exact/f32/cpu {few} 1000 --out".split(), out],
        "invariants": lambda: [*f"invariants --lanes moller_1997/f32/cpu {few} 300 --threads 2 --out".split(), out],
        "league": lambda: ["league", "--subjects", folder / "subjects.txt", *f"{few} 200 --out".split(), out],
        "merge": lambda: ["merge", *(bench.reference("small", shard=shard) for shard in ("1/2", "2/2")), "--out", out],
        "report": lambda: ["report", out],
        "view": lambda: ["view", folder / "pair.txt", "--out", out / "view.html"],
    }[verb]()


VERBS = ["tune", "pareto", "invariants", "league", "merge", "report", "view"]


def begin(turn, verb, out):
    shutil.rmtree(out, ignore_errors=True)
    if verb == "report":
        shutil.copytree(turn.bench.reference("tiny", minimised=True), out)
    if verb == "view":
        out.mkdir(parents=True)


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(inner) for key, inner in value.items() if key not in TIMED}
    if not isinstance(value, list):
        return value
    if all(isinstance(inner, dict) and "lane" in inner for inner in value):  # the order of lanes depends on costs
        value = sorted(value, key=lambda inner: str(inner["lane"]))
    return [without_times(inner) for inner in value]


def snapshot(out):
    """All results by name, without timings. Throws: Violation for a partial JSON file."""
    found = {}
    for file in sorted(out.rglob("*")):
        name = file.relative_to(out).as_posix()
        if not file.is_file() or name.endswith(".part") or name in ASIDE or name.startswith("campaign.sqlite"):
            continue
        data = file.read_bytes()
        if file.suffix == ".json":
            try:
                value = json.loads(data)
                data = without_times(seal.read(file) if "checksum" in value else value)
            except ValueError:
                raise Violation(f"expected whole JSON in {name}, found {data[:80]!r}") from None
        found[name] = data
    return found


def undisturbed(turn, verb):
    """The results of an undisturbed run of the verb; None if this build lacks the verb."""
    key = ("results", verb)
    if key not in turn.bench.undisturbed:
        out = turn.bench.folder / "undisturbed" / verb
        begin(turn, verb, out)
        start = time.monotonic()
        ran = turn.run(*command(turn.bench, verb, out))
        left_out = ran.status != 0 and "in this build" in ran.err
        if not left_out:
            turn.must_succeed(ran)
        turn.bench.seconds[key] = time.monotonic() - start
        turn.bench.undisturbed[key] = None if left_out else snapshot(out)
    return turn.bench.undisturbed[key]


def on_some_verbs(attack):
    """Turns an attack on one verb into a round of attacks on some verbs."""

    def attack_some(turn):
        for verb in turn.random.sample(VERBS, ATTEMPTS):
            expected = undisturbed(turn, verb)
            if expected is None:
                turn.count("refused")
                continue
            out = turn.folder / verb
            begin(turn, verb, out)
            attack(turn, verb, out, expected)
            shutil.rmtree(out, ignore_errors=True)

    return attack_some


def must_be_whole(out, expected, begun):
    """Requires that no result is partial: each file must be as before the run, or as after a complete one."""
    for name, data in snapshot(out).items():
        if data != expected.get(name) and data != begun.get(name):
            raise Violation(f"expected {name} whole or not at all, found something else")


def must_end_alike(turn, verb, out, expected):
    ran = turn.run(*command(turn.bench, verb, out))
    turn.must_succeed(ran)
    must_agree(snapshot(out), expected, [*out.rglob("*.part*"), *out.parent.glob(out.name + ".graze.part*")])


@on_some_verbs
def kill_results(turn, verb, out, expected):
    begun = snapshot(out)
    for _ in range(2):
        turn.run(
            *command(turn.bench, verb, out),
            kill_after=turn.bench.seconds["results", verb]
            * turn.random.choice([turn.random.random(), 0.9 + 0.2 * turn.random.random()]),
        )
        must_be_whole(out, expected, begun)
        if verb == "merge" and out.exists():  # the merge had finished; it writes only into a new folder
            shutil.rmtree(out)
    must_end_alike(turn, verb, out, expected)
    turn.count("same")


@on_some_verbs
def full_results(turn, verb, out, expected):
    begun = snapshot(out)
    largest = max(len(data) if isinstance(data, bytes) else len(json.dumps(data)) for data in expected.values())
    limit = turn.random.randrange(
        1024, max(largest, 2048)
    )  # a smaller limit would cut off graze's message, which is written to a file
    ran = turn.run(*command(turn.bench, verb, out), file_bytes=limit)
    refused = turn.is_refused(ran, verb, "campaign.sqlite", "room", "memory with a subject", "cannot compile")
    must_be_whole(out, expected, begun)
    if verb == "merge" and out.exists():
        shutil.rmtree(out)
    must_end_alike(turn, verb, out, expected)
    turn.count("refused" if refused else "same")


@on_some_verbs
def read_only_results(turn, verb, out, expected):
    disk = turn.folder / f"disk-{verb}"
    with small_disk(disk, 64 << 20) as mounted:
        there = disk / verb
        begin(turn, verb, there)
        if mounted:
            with made_read_only(disk):
                ran = turn.run(*command(turn.bench, verb, there))
                if not turn.is_refused(ran, verb) or "Read-only file system" not in ran.err:
                    raise Violation(f"expected the system's reason, Read-only file system, found {ran.err!r}")
        must_end_alike(turn, verb, there, expected)
        turn.count("refused" if mounted else "same")


@on_some_verbs
def two_results(turn, verb, out, expected):
    same = command(turn.bench, verb, out)
    refused = finish_both(turn, same, same, [0, 0, 0.01, 0.05], verb)
    if verb == "merge":
        shutil.rmtree(out)
    must_end_alike(turn, verb, out, expected)
    turn.count("refused" if refused else "same")


def leaves(value, kind, place=()):
    """The paths of all values of this type. Booleans do not count as numbers."""
    if isinstance(value, (dict, list)):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(inner, kind, (*place, key))
    elif type(value) is kind:
        yield place


def changed(value, place, by):
    holder = value
    for key in place[:-1]:
        holder = holder[key]
    holder[place[-1]] += by


def forged_summaries(turn):
    """Forges counts in a campaign's JSON. graze must refuse the file and name it, with or without the database."""
    reported = turn.bench.reference("tiny", minimised=True, reported=True)
    for campaign in turn.copies(reported, 4):
        name = turn.random.choice(["summary.json", "summary.json", "failures.json", "report.json"])
        is_summary = name == "summary.json"  # graze checks a summary against the database, not by a checksum
        value = json.loads((campaign / name).read_text()) if is_summary else seal.read(campaign / name)
        part = {
            "summary.json": ["strata", "signatures", "disagreements", "spec"],
            "failures.json": ["kinds"],
            "report.json": ["rates", "strata"],
        }[name]
        counts = {
            "failures.json": {"pairs", "signatures"},
            "report.json": {"count", "of", "pairs", "intersects", "declined"},
        }.get(name)
        places = [
            place for place in leaves({key: value[key] for key in part}, int) if counts is None or place[-1] in counts
        ]
        readers = [
            ["report", campaign],
            ["report", "--compare", reported, campaign],
            ["failures", campaign],
            ["minimize", campaign],
            ["dump", campaign],
            ["corpus", "add", campaign, "--corpus", turn.folder / "corpus"],
        ]
        place = turn.random.choice(places)
        changed(value, place, turn.random.choice([1, 7, 1 << 40]))
        if name == "report.json":
            readers = [["report", "--from", campaign / name, "--out", turn.folder / "page.html"]]
        elif name == "failures.json":
            readers = [["report", campaign], ["failures", campaign]]
        elif turn.random.random() < 0.4:
            (campaign / "campaign.sqlite").unlink()
            value = json.loads((campaign / name).read_text())
            stratum = turn.random.choice(list(value["strata"].values()))
            lane = turn.random.choice(list(stratum["lanes"].values()))
            lane[turn.random.choice(["false_negative", "false_positive", "declined"])] = stratum["pairs"] + 1
        (campaign / name).write_text(json.dumps(value, indent=1) + "\n" if is_summary else seal.text(value))
        ran = turn.run(*turn.random.choice(readers))
        turn.must_refuse(ran, f"{name} with another number at {place}", name)


def forged_kinds(turn):
    """Forges kinds, costs and a status. graze must refuse the file and name it."""
    reported = turn.bench.reference("tiny", minimised=True, reported=True)

    def cost(value):
        lanes = next(run["costs"]["lanes"] for run in value["runs"] if "costs" in run)
        return next(iter(next(iter(lanes.values())).values()))

    readers = {"failures.json": ["failures", "report"], "timings.json": ["report"], "status.json": ["status"]}
    edits = [
        ("failures.json", lambda value: value.update(kinds=[])),
        ("failures.json", lambda value: value.update(kinds=value["kinds"][3:])),
        ("failures.json", lambda value: value["kinds"][0].update(strata={"lattice": 99})),
        ("failures.json", lambda value: value["kinds"][0].update(margins={"banana": 1})),
        ("failures.json", lambda value: value["kinds"][0].update(lanes=["x"])),
        ("timings.json", lambda value: cost(value).update(middle=-1)),
        ("timings.json", lambda value: cost(value).update(pairs=1000000)),
        ("status.json", lambda value: value.update(disagreements=1 << 64)),
        ("status.json", lambda value: value.update(state="unknown")),
        ("status.json", lambda value: value.update(done=1)),
        ("status.json", lambda value: value.update(shard=None)),
    ]
    for campaign, (name, edit) in zip(turn.copies(reported, 4), turn.random.sample(edits, 4)):
        value = seal.read(campaign / name)
        edit(value)
        text = seal.text(value)
        (campaign / name).write_text(
            text[: len(text) // 2] if turn.random.random() < 0.2 and name != "timings.json" else text
        )
        turn.must_refuse(turn.run(turn.random.choice(readers[name]), campaign), f"a forged {name}", name)


def unsealed(turn):
    """Changes a text, so that all counts still agree. In every kind of file, the checksum must reveal the change."""
    reported = turn.bench.reference("tiny", minimised=True, reported=True)
    maps = turn.random.choice(sorted((reported / "cases").glob("*.maps.json"))).relative_to(reported).as_posix()
    page = ["report", "--from", "report.json", "--out", "page.html"]
    attacks = [
        (maps, ["report"]),
        ("failures.json", ["report"]),
        ("failures.json", ["failures"]),
        ("timings.json", ["report"]),
        ("timings.json", ["minimize"]),
        ("status.json", ["status"]),
        ("costs.json", page),
        ("report.json", page),
    ]
    for campaign, (name, reader) in zip(turn.copies(reported, len(attacks)), attacks):
        file = campaign / name
        value = json.loads(file.read_text())
        place = turn.random.choice([place for place in leaves(value, str) if place != ("checksum",)])
        changed(value, place, "x")
        file.write_text(json.dumps(value, indent=1, ensure_ascii=False) + "\n")
        words = [campaign / word if "." in word else word for word in reader[1:]] or [campaign]
        ran = turn.run(reader[0], *words)
        turn.must_refuse(ran, f"{name} with another text at {place}", file.name)


def forged_cases(turn):
    """Forges a case file: another signature's file, a missing pair, or a different pair. graze must refuse the file and
    name it, and the command in its message must restore it."""
    minimised = turn.bench.reference("tiny", minimised=True)
    rows = json.loads((minimised / "summary.json").read_text())["signatures"]
    for campaign in turn.copies(minimised, 4):
        row, other = turn.random.sample(rows, 2)
        file = campaign / row["case"]
        lines = file.read_text().splitlines(keepends=True)
        entries = [place for place, line in enumerate(lines) if not line.startswith(("#", "graze-pairs"))]
        choice = turn.random.randrange(4)
        place = turn.random.choice([place for place in entries if "kind=" not in lines[place]])
        if choice == 0:
            shutil.copy(campaign / other["case"], file)
        elif choice == 1:
            file.write_text("".join(lines[:-1]))
        elif choice == 2:
            numbers = lines[place].split(" ")
            numbers[turn.random.randrange(18)] = turn.random.choice(["0x1.5p+3", "-0x1p+20", "0x1.234568p-3"])
            file.write_text("".join([*lines[:place], " ".join(numbers), *lines[place + 1 :]]))
        else:
            file.write_text(
                "".join([*lines[:place], lines[place].replace(row["key"], other["key"]), *lines[place + 1 :]])
            )
        changed_file = file.read_text() != "".join(lines)
        ran = turn.run(turn.random.choice(["report", "failures", "minimize"]), campaign)
        if changed_file:
            turn.must_refuse(ran, f"{file.name}, changed in way {choice},", file.name)
        else:
            turn.count("same")


def pipes(turn):
    """Puts a pipe in place of a record. No verb may wait for it, and an error message must name it."""
    reported = turn.bench.reference("tiny", minimised=True, reported=True)
    records = ["summary.json", "campaign.sqlite", "timings.json", "status.json", "failures.json", "costs.json"]
    records += [file.relative_to(reported).as_posix() for file in sorted((reported / "cases").iterdir())]
    for campaign in turn.copies(reported, 6):
        record = campaign / turn.random.choice([*records[:6], turn.random.choice(records[6:])])
        record.unlink()
        os.mkfifo(record)
        verbs = [
            ["report", campaign],
            ["minimize", campaign],
            ["status", campaign],
            ["merge", campaign, "--out", turn.folder / "m"],
        ]
        ran = turn.run(*turn.random.choice([*verbs, [*turn.bench.campaign("tiny"), "--out", campaign]]))
        refused = turn.is_refused(ran, record.name)
        if not stat.S_ISFIFO(os.lstat(record).st_mode):
            raise Violation(f"expected {record.name} to stay a pipe, found another file")
        turn.count("refused" if refused else "read")
        shutil.rmtree(turn.folder / "m", ignore_errors=True)


def foreign_places(turn):
    """Results in a folder with a person's own files. graze must refuse with one line and keep them; with --force, it
    must write there."""
    folder = turn.folder / "mine"
    folder.mkdir()
    (folder / "notes.txt").write_text("kept")
    for place, verb in enumerate([*outputs.verbs(turn), ["view", "pair.txt", "--out"]]):
        theirs, link = turn.folder / f"theirs-{place}.png", turn.folder / f"link-{place}.png"
        theirs.write_text("kept")
        link.symlink_to(theirs.name)
        for name in (theirs, link):
            ran = turn.run(*verb, name)
            turn.must_refuse(ran, "a file of another", name.name, "in this build", "build with")
            if theirs.read_text() != "kept" or not link.is_symlink():
                raise Violation(f"expected a file that is not graze's to be kept, found that {verb[0]} replaced it")
        if "--force" in ran.err:
            turn.must_succeed(turn.run(*verb, link, "--force"))
            if theirs.read_bytes() == b"kept":
                raise Violation(f"expected {verb[0]} --force to replace the file, found it as it was")
            turn.count("same")
    theirs = turn.folder / "theirs.txt"
    theirs.write_text("kept")
    os.link(theirs, turn.folder / "linked.html.graze.part")
    turn.run("view", "pair.txt", "--out", turn.folder / "linked.html")
    if theirs.read_text() != "kept":
        raise Violation("expected a hard-linked file to be unchanged, found that view wrote into it")
    turn.count("same")
    campaign = turn.folder / "campaign"
    shutil.copytree(turn.bench.reference("tiny"), campaign)
    case = turn.random.choice(sorted((campaign / "cases").glob("*.pairs")))
    case.write_text("kept")
    ran = turn.run(*turn.bench.campaign("tiny"), "--out", campaign)
    turn.must_refuse(ran, "a case that is not graze's", case.name)
    if case.read_text() != "kept":
        raise Violation("expected a case that is not graze's to be kept, found that fuzz replaced it")
    tiny = [*turn.bench.campaign("tiny"), "--out"]
    for verb in [
        tiny,
        *(command(turn.bench, name, folder)[:-1] for name in ("tune", "pareto", "invariants", "league", "merge")),
    ]:
        ran = turn.run(*verb, folder)
        turn.must_refuse(ran, "a folder of other things", folder.name, "in this build")
        if [file.name for file in folder.iterdir()] != ["notes.txt"]:
            raise Violation(
                f"expected a folder that is not graze's to be unchanged, found that {verb[0]} wrote into it"
            )
    league = turn.folder / "league"
    (league / "league").mkdir(parents=True)
    (league / "league" / "mine.svg").write_text("kept")
    ran = turn.run(*command(turn.bench, "league", league))
    turn.is_refused(ran, "league", "in this build")
    ran = turn.run(*command(turn.bench, "league", league), "--force")
    if (league / "league" / "mine.svg").read_text() != "kept":
        raise Violation("expected league to remove only its own drawings, found that another is missing")
    turn.count("same" if ran.status == 0 else "refused")
