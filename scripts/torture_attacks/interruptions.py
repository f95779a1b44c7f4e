# SPDX-License-Identifier: Apache-2.0
"""Kills, full disks, two processes at once. At the end, the bytes must be those of an undisturbed run."""
import contextlib
import os
import shutil
import subprocess
import time

from torture_attacks import mutate
from torture_attacks.bench import Violation, bytes_of


def kill_repeatedly(turn, begin, arguments, seconds):
    """Kills the command one to three times, at random moments. `begin` makes it start from the beginning. Returns: how
    often it was killed."""
    kills = 0
    for attempt in range(6):
        # Most problems occur near the beginning and the end, so those moments are chosen more often.
        share = turn.random.choice([turn.random.random(), turn.random.random() * 0.1, 0.8 + turn.random.random() * 0.4])
        if turn.run(*arguments, kill_after=seconds * share).killed:
            kills += 1
            if kills == 3 or turn.random.random() < 0.3:
                break
        elif kills:
            break
        else:
            seconds /= 2
            begin()
    return kills


def kill_fuzz(turn):
    campaign, reference = turn.folder / "campaign", turn.bench.reference("large")
    command = [*turn.bench.campaign("large"), "--out", campaign]
    kills = kill_repeatedly(turn, lambda: shutil.rmtree(campaign), command, turn.bench.seconds["large", False, False])
    written_ahead = campaign / "campaign.sqlite-wal"
    if turn.random.random() < 0.3 and written_ahead.exists() and written_ahead.stat().st_size:
        written_ahead.write_bytes(mutate.any_of(turn.random, written_ahead.read_bytes(), mutate.BINARY))
        if turn.is_refused(turn.run(*command), "campaign.sqlite"):
            turn.must_succeed(turn.run(*command, "--discard-damaged"))
    turn.must_succeed(turn.run(*command))
    turn.must_be_same(campaign, reference)
    turn.count("same", kills)


def kill_hunt(turn):
    """Kills a hunt and its processes. Sometimes damages a stored round afterwards."""
    campaign = turn.folder / "campaign"
    command = [*turn.bench.campaign("hunt"), "--out", campaign]
    ran = turn.run(
        "hunt", "--runs", "1", "--seed", "1", "--lanes", "interval_overlap/f32/cpu", "--out", turn.folder / "one"
    )
    if turn.is_refused(ran):
        if "libFuzzer" not in ran.err:
            raise Violation(f"expected a hunt, found {ran.err!r}")
        return turn.count("refused")
    reference = turn.bench.reference("hunt")
    kills = kill_repeatedly(turn, lambda: shutil.rmtree(campaign), command, turn.bench.seconds["hunt", False, False])
    rounds = sorted((campaign / "hunt").glob("*.round"))
    if rounds and turn.random.random() < 0.3:
        damaged = turn.random.choice(rounds)
        damaged.write_bytes(mutate.any_of(turn.random, damaged.read_bytes(), mutate.BINARY))
    turn.must_succeed(turn.run(*command))
    turn.must_be_same(campaign, reference)
    turn.count("same", kills)


def kill_minimize(turn):
    campaign, reference = turn.folder / "campaign", turn.bench.reference("tiny", minimised=True)

    def begin():
        shutil.rmtree(campaign, ignore_errors=True)
        shutil.copytree(turn.bench.reference("tiny"), campaign)

    begin()
    kills = kill_repeatedly(turn, begin, ["minimize", campaign], turn.bench.seconds["tiny", True, False])
    turn.must_succeed(turn.run("minimize", campaign))
    turn.must_be_same(campaign, reference)
    turn.count("same", kills)


@contextlib.contextmanager
def small_disk(folder, size):
    """A file system of `size` bytes. Yields: a function that enlarges it, or None if it cannot be mounted."""
    folder.mkdir()
    options = f"size={max(size, 4096)},mode=0700"
    have = (
        os.geteuid() == 0
        and subprocess.run(
            ["mount", "-t", "tmpfs", "-o", options, "graze-torture", folder], capture_output=True
        ).returncode
        == 0
    )
    try:
        yield (
            lambda: subprocess.run(["mount", "-o", "remount,size=256m", folder], check=True, capture_output=True)
        ) if have else None
    finally:
        if have:
            subprocess.run(["umount", folder], check=True)


@contextlib.contextmanager
def made_read_only(folder):
    """Mounts the folder read-only for the `with` block. Requires that nothing in it changes."""
    before = bytes_of(folder)
    remount = lambda how: subprocess.run(["mount", "-o", f"remount,{how}", folder], check=True, capture_output=True)
    remount("ro")
    try:
        yield
    finally:
        remount("rw")
    if bytes_of(folder) != before:
        raise Violation("expected a read-only folder to be unchanged, found it changed")


def finish_both(turn, first, second, pauses, name):
    """Runs two commands at once, the second after one of these pauses. At least one must succeed, and an error message
    must contain the name.   Returns: whether one was refused."""
    started = turn.start(*first)
    time.sleep(turn.random.choice(pauses))
    both = [turn.finish(other, judged=False) for other in (turn.start(*second), started)]
    for ran in both:
        turn.must_end(ran)
    refused = [turn.is_refused(ran, name) for ran in both]
    if all(refused):
        raise Violation(
            f"expected one of two processes to continue, found both refused: {both[0].err!r} {both[1].err!r}"
        )
    return any(refused)


def read_only(turn):
    """A killed campaign on a read-only file system. graze must refuse it with one line and change nothing."""
    campaign, reference = turn.folder / "disk" / "campaign", turn.bench.reference("large")
    command = [*turn.bench.campaign("large"), "--out", campaign]
    with small_disk(turn.folder / "disk", 64 << 20) as mounted:
        turn.run(*command, kill_after=turn.bench.seconds["large", False, False] * turn.random.random())
        refused = False
        if mounted:
            with made_read_only(turn.folder / "disk"):
                refused = turn.is_refused(turn.run(*command), "campaign")
        turn.must_succeed(turn.run(*command))
        turn.must_be_same(campaign, reference)
        turn.count("refused" if refused else "same")
        shutil.rmtree(campaign)


def full_disk(turn):
    """Runs first with too little space (a small file system or a file size limit), then with enough."""
    minimises = turn.random.random() < 0.3
    name = "tiny" if minimises else "small"
    before, after = turn.bench.reference(name), turn.bench.reference(name, minimised=minimises)
    sizes = [file.stat().st_size for file in after.rglob("*") if file.is_file()]
    with small_disk(turn.folder / "disk", 1 << 20) as enlarge:
        campaign = turn.folder / "disk" / "campaign"
        if minimises:
            shutil.copytree(before, campaign)
            command = ["minimize", campaign]
        else:
            command = [*turn.bench.campaign(name), "--out", campaign]
        limit = None
        if enlarge and turn.random.random() < 0.5:
            # A tmpfs allocates whole pages, so files take more room than the sum of their sizes. A filler file
            # leaves only `room` bytes free.
            free = os.statvfs(turn.folder / "disk").f_bavail * 4096
            room = turn.random.randrange(0, sum(sizes) * 2)
            with open(turn.folder / "disk" / "filler", "wb") as filler:
                filler.write(bytes(max(0, free - room)))
        else:
            limit = turn.random.randrange(
                1024, max(sizes) + 1
            )  # a smaller limit would cut off graze's message, which is written to a file
        ran = turn.run(*command, file_bytes=limit)
        refused = turn.is_refused(ran, "campaign", "cases")
        (turn.folder / "disk" / "filler").unlink(missing_ok=True)
        if enlarge:
            enlarge()
        turn.must_succeed(turn.run(*command))
        turn.must_be_same(campaign, after)
        turn.count("refused" if refused else "same")
        shutil.rmtree(campaign)


def two_at_once(turn):
    """Two processes in one campaign folder. The second must wait, or be refused with one line. Afterwards the results
    must be right."""
    campaign = turn.folder / "campaign"
    fuzz = [*turn.bench.campaign("tiny"), "--out", campaign]
    large = [*turn.bench.campaign("large"), "--out", campaign]
    minimize = ["minimize", campaign]
    first, second, name, minimised = turn.random.choice(
        [
            (large, large, "large", False),
            (minimize, minimize, "tiny", True),
            (fuzz, minimize, "tiny", True),
            (minimize, fuzz, "tiny", True),
        ]
    )
    if minimised:
        shutil.copytree(turn.bench.reference("tiny"), campaign)
    refused = finish_both(turn, first, second, [0, 0, 0.01, 0.1, 0.5], "campaign")
    if minimised:
        turn.must_succeed(turn.run(*minimize))
    turn.must_be_same(campaign, turn.bench.reference(name, minimised=minimised))
    turn.count("refused" if refused else "same")
