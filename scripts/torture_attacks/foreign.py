# SPDX-License-Identifier: Apache-2.0
"""Runs subjects that attack their own process (subjects/hostile.c). Their campaigns end, are stopped, or are killed,
sometimes while a subject is compiled. The campaign must end, the other lanes must have the same verdicts as without
these subjects, and no process may be left."""
import json
import os
import pathlib
import re
import signal
import subprocess
import time

from torture_attacks.bench import Violation

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "subjects/hostile.c"
OURS = "moller_1997/f32/cpu"
ATTEMPTS = 3
ENDS = 20  # seconds within which a campaign must end after a request to stop, even on a busy machine


def attacks():
    return re.findall(r"^ATTACK\((\w+),", SOURCE.read_text(), re.MULTILINE)


def library(bench):
    built = bench.folder / "libhostile.so"
    if not built.exists():
        subprocess.run(["cc", "-O1", "-w", "-shared", "-fPIC", SOURCE, "-o", built, "-lpthread"], check=True)
    return built


def left_over(bench):
    """The processes that this bench's graze started, recognised by their environment."""
    mark = f"XDG_CACHE_HOME={bench.folder}".encode()
    found = []
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if mark in (folder / "environ").read_bytes():
                found.append(int(folder.name))
        except OSError:  # the process has ended
            pass
    return found


def must_leave_nothing(turn):
    for _ in range(100):
        if not left_over(turn.bench):
            return
        time.sleep(0.1)
    raise Violation(f"expected no process after the end, found {left_over(turn.bench)}")


def must_end_while_it_compiles(turn):
    """The compiler waits forever, for a header or for data that is a pipe."""
    pipe, source = turn.folder / "pipe", turn.folder / "waits.c"
    os.mkfifo(pipe)
    reads = turn.random.choice([f'#include "{pipe}"\n', f'__asm__(".incbin \\"{pipe}\\"");\n'])
    source.write_text(reads + "int intersects(const float a[9], const float b[9]) { return 1; }\n")
    started = turn.start("fuzz", "--subject", f"w={source}", "--lanes", "w/*", "--pairs", "10", "--out", "never")
    time.sleep(0.2 + turn.random.random())
    way = turn.random.choice([signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
    os.kill(started[0].pid, way)
    ran = turn.finish(started, kill_after=ENDS)
    if ran.late:
        raise Violation(f"expected an end within {ENDS} s of signal {way}, found none")
    if ran.status not in (130, -way):  # graze was stopped properly, or before it began
        raise Violation(f"expected exit status 130, found {ran.status}: {ran.err[-500:]!r}")
    must_leave_nothing(turn)
    if way == signal.SIGKILL:  # if no compiler was running at the kill, a later graze removes the files
        return
    left = list((turn.bench.folder / "cache/graze").glob("unfinished-*"))
    if left:
        raise Violation(f"expected no temporary files, found {left}")


def counts_of_ours(campaign):
    strata = json.loads((campaign / "summary.json").read_text())["strata"]
    return {stratum: (counts["pairs"], counts["lanes"][OURS]) for stratum, counts in strata.items()}


def foreign(turn):
    must_end_while_it_compiles(turn)
    for attempt in range(ATTEMPTS):
        name = turn.random.choice(attacks())
        seed = str(turn.random.randrange(1 << 32))
        few = ["--pairs", "60", "--strata", "uniform", "--seed", seed, "--threads", "2"]
        campaign, alone = turn.folder / f"with-{attempt}", turn.folder / f"without-{attempt}"
        command = ["fuzz", *few, "--subject", f"h={library(turn.bench)}:{name}", "--subject-timeout", "0.1"]
        command += ["--lanes", "h/*", "--lanes", OURS, "--out", campaign]
        way = turn.random.choice(["whole", "stopped", "killed"])
        if way != "whole":
            started = turn.start(*command)
            time.sleep(turn.random.random() * 0.5)
            os.kill(
                started[0].pid, signal.SIGTERM if way == "stopped" else signal.SIGKILL
            )  # the process's id is valid until `finish` waits for it
            ran = turn.finish(started, kill_after=ENDS)
            if ran.late:
                raise Violation(f"expected an end within {ENDS} s of SIGTERM, found none")
            if way == "stopped" and ran.status not in (
                0,
                130,
                -signal.SIGTERM,
            ):  # it had ended; it was stopped properly; it had not begun
                raise Violation(f"expected exit status 130, found {ran.status}: {ran.err[-500:]!r}")
            must_leave_nothing(turn)
        turn.must_succeed(turn.run(*command))
        must_leave_nothing(turn)
        turn.must_succeed(turn.run("fuzz", *few, "--lanes", OURS, "--out", alone))
        if counts_of_ours(campaign) != counts_of_ours(alone):
            raise Violation(f"expected {OURS} to have the counts that it has without {name}, found others")
        turn.count("same")
