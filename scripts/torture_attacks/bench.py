# SPDX-License-Identifier: Apache-2.0
"""Runs graze under limits and judges the results. Nothing here is specific to one attack."""
import collections
import os
import pathlib
import random
import resource
import select
import shlex
import shutil
import signal
import subprocess
import time

MEMORY_MIB = 1024  # address space; not for sanitizer builds, which need far more
PROCESSOR_SECONDS = 60  # a process that uses more has hung
SECONDS = 600  # a process that takes longer has hung; a loaded machine takes many times as long as an idle one
# The result files, besides those in cases/. Timings and the database's pages may differ.
RESULTS = ("summary.json", "margins.svg", "hunt.json")


class Violation(Exception):
    """graze did something forbidden."""


Ran = collections.namedtuple("Ran", "status out err killed late")


def results_of(campaign):
    """The bytes of all results, by name."""
    files = [campaign / name for name in RESULTS] + sorted((campaign / "cases").glob("*"))
    return {file.relative_to(campaign).as_posix(): file.read_bytes() for file in files if file.is_file()}


def must_agree(found, expected, partial):
    """Requires the same results by name, and no partial files."""
    apart = [name for name in sorted({*found, *expected}) if found.get(name) != expected.get(name)]
    if apart:
        raise Violation(
            f"expected the results of the undisturbed run, found that {len(apart)} files differ, the first {apart[0]}"
        )
    left = [file.name for file in partial]
    if left:
        raise Violation(f"expected nothing left behind, found {left}")


def bytes_of(folder):
    return {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}


class Bench:
    """Shared by all rounds: the program, and the results of undisturbed campaigns."""

    def __init__(self, graze, seed, folder):
        self.graze, self.seed, self.folder = graze, seed, folder
        self.has_sanitizer = any(mark in pathlib.Path(graze).read_bytes() for mark in (b"__asan_init", b"__tsan_init"))
        self.undisturbed, self.seconds = {}, {}

    def campaign(self, name):
        """The arguments of the campaign of that name, or of the hunt, except --out."""
        drawn = random.Random(f"{self.seed} {name}")
        seed = drawn.randrange(1 << 32)
        many = "near_edge_edge,degenerate,uniform,lattice,near_vertex_face,coplanar_wide"
        command = {
            "large": f"fuzz --pairs 240000 --strata {many}",
            "small": f"fuzz --pairs 600 --strata {many}",
            "tiny": "fuzz --pairs 24 --strata near_edge_edge,degenerate",
            "hunt": f"hunt --runs 12000 --coordinates {drawn.choice(['f32', 'f64'])}",
        }[name]
        return f"{command} --seed {seed} --lanes interval_overlap/f32/cpu --threads 2".split()

    def reference(self, name, minimised=False, reported=False, shard=None):
        """The campaign's folder after an undisturbed run. Do not change it."""
        key = (name, minimised, reported) if shard is None else (name, shard)
        if key not in self.undisturbed:
            folder = self.folder / "undisturbed" / "-".join(map(str, key)).replace("/", "of")
            if reported or minimised:
                shutil.copytree(self.reference(name, minimised and reported), folder)
            step = (
                ["report", folder]
                if reported
                else ["minimize", folder]
                if minimised
                else [*self.campaign(name), *(["--shard", shard] if shard else []), "--out", folder]
            )
            start = time.monotonic()
            turn = Round(self, "undisturbed", 0, self.folder / "undisturbed")
            try:
                turn.must_succeed(turn.run(*step))
            except Violation as error:
                raise Violation(f"{turn.commands[-1]}, which nothing disturbed: {error}") from None
            self.seconds[key] = time.monotonic() - start
            self.undisturbed[key] = folder
        return self.undisturbed[key]


class Round:
    """One round of an attack: its random numbers, its folder, its counts."""

    def __init__(self, bench, kind, number, folder):
        self.bench, self.folder = bench, folder
        self.random = random.Random(f"{bench.seed} {kind} {number}")
        self.counts = collections.Counter()
        self.commands = []
        folder.mkdir(parents=True, exist_ok=True)

    def copies(self, campaign, count):
        """Yields copies of a campaign's folder, and removes each after its turn. Keeps the current one after a
        violation."""
        for number in range(count):
            copy = self.folder / f"campaign-{number}"
            shutil.copytree(campaign, copy)
            yield copy
            shutil.rmtree(copy)

    def count(self, outcome, times=1):
        """outcome: "same", "read" or "refused"."""
        self.counts[outcome] += times

    def start(self, *arguments, file_bytes=None):
        """Starts graze in the round's folder."""
        slower = 20 if self.bench.has_sanitizer else 1

        def limit():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS * slower, PROCESSOR_SECONDS * slower + 1))
            if not self.bench.has_sanitizer:
                resource.setrlimit(resource.RLIMIT_AS, (MEMORY_MIB << 20, MEMORY_MIB << 20))
            if file_bytes is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (file_bytes, file_bytes))

        arguments = [os.fspath(argument) for argument in arguments]
        shown = shlex.join(
            os.fsencode(word).decode(errors="backslashreplace") for word in [self.bench.graze, *arguments]
        )
        self.commands.append(
            f"cd {self.folder} && {shown}"
            + (f"  # files of at most {file_bytes} bytes" if file_bytes is not None else "")
        )
        number = len(self.commands)
        out, err = (self.folder / f".{number}.{stream}" for stream in ("out", "err"))
        with open(out, "wb") as to_out, open(err, "wb") as to_err:
            process = subprocess.Popen(
                [self.bench.graze, *arguments],
                cwd=self.folder,
                stdin=subprocess.DEVNULL,
                stdout=to_out,
                stderr=to_err,
                env={**os.environ, "MALLOC_ARENA_MAX": "2", "XDG_CACHE_HOME": os.fspath(self.bench.folder / "cache")},
                preexec_fn=limit,
            )
        return process, out, err

    def finish(self, started, kill_after=None, judged=True):
        """Waits for the process, or kills it after `kill_after` seconds."""
        process, out, err = started
        handle = os.pidfd_open(process.pid)
        try:
            waiting = select.poll()
            waiting.register(handle, select.POLLIN)
            ended = waiting.poll(1000 * (SECONDS if kill_after is None else kill_after))
        finally:
            os.close(handle)
        if not ended:
            process.send_signal(signal.SIGKILL)
        status = process.wait()
        ran = Ran(
            status, out.read_bytes(), err.read_bytes().decode(errors="replace"), status == -signal.SIGKILL, not ended
        )
        out.unlink()
        err.unlink()
        if kill_after is None and judged:
            self.must_end(ran)
        return ran

    def run(self, *arguments, kill_after=None, file_bytes=None):
        return self.finish(self.start(*arguments, file_bytes=file_bytes), kill_after)

    def must_end(self, ran):
        """Requires that graze ended by itself, in time, with a documented exit status, and that an error message is one
        line."""
        if ran.late or ran.status == -signal.SIGXCPU:
            raise Violation(f"expected an end within {SECONDS} s, and {PROCESSOR_SECONDS} s of a processor, found none")
        if ran.status not in (0, 1, 2):
            raise Violation(f"expected exit status 0, 1 or 2, found {ran.status}: {ran.err[-500:]}")
        failed_check = ran.status == 1 and not ran.err and ran.out
        lines = ran.err.split("\n")
        if ran.status != 0 and not failed_check and (len(lines) != 2 or lines[1] or not ran.err.startswith("graze: ")):
            raise Violation(f"expected one line on stderr that begins with 'graze: ', found {ran.err[-500:]!r}")

    def is_refused(self, ran, *names):
        """Whether graze refused. Requires that the message contains one of the names."""
        if ran.status == 0 or not ran.err:
            return False
        if names and not any(name in ran.err for name in names):
            raise Violation(f"expected a line that names {' or '.join(names)}, found {ran.err!r}")
        return True

    def must_refuse(self, ran, what, *names):
        """Requires that graze refused, with one of the names in its message, and counts that."""
        if not self.is_refused(ran, *names):
            raise Violation(f"expected {what} to be refused, found status {ran.status}: {ran.out[-200:]!r}")
        self.count("refused")

    def must_succeed(self, ran):
        if ran.status != 0:
            raise Violation(f"expected success, found status {ran.status}: {ran.err[-500:]!r}")

    def must_be_same(self, campaign, reference):
        """Requires results equal to the reference byte for byte, and no partial file."""
        must_agree(results_of(campaign), results_of(reference), campaign.rglob("*.part*"))
