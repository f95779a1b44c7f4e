# SPDX-License-Identifier: Apache-2.0
"""Output of torture for stand-ins for graze: no violation for a correct stand-in, and the right violation for each
wrong one."""
import contextlib
import io
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest
from unittest import mock

from loaded import loaded

SCRIPT = pathlib.Path(__file__).with_name("torture")
torture = loaded("torture")

# A campaign of eight rows, 50 ms each. MODE selects its misbehaviour.
GRAZE = r"""#!%(python)s -BS
import fcntl, os, pathlib, shutil, signal, sqlite3, stat, subprocess, sys, time
MODE = "%(mode)s"
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
words = sys.argv[1:]
option = lambda name: words[words.index(name) + 1] if name in words else None
out = option("--out")


def fail(line):
    os.write(2, f"graze: {line}\n".encode(errors="surrogateescape"))
    os._exit(1)


def damaged(file):
    if MODE == "hangs":
        time.sleep(1000)
    if MODE == "crashes":
        os.kill(os.getpid(), signal.SIGSEGV)
    if MODE == "babbles":
        fail(f"{file}: expected a file\nfound damage")
    fail("expected a file" if MODE == "mumbles" else f"{file}: expected a file, found damage")


def write(file, text):
    try:
        there = os.stat(file).st_mode if os.path.exists(file) else 0
        if stat.S_ISDIR(there):
            fail(f"{file}: is a folder")
        if MODE == "replaces" and os.path.lexists(file):
            os.unlink(file)
        with open(file, "w") as to:
            to.write(text)
        if MODE == "litters":
            pathlib.Path(f"{file}.part").touch()
    except OSError:
        fail(f"{file}: no room")


def lock(folder):
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        if MODE != "collides":
            fail(f"{folder}: another process is at work in it")
        fail(f"{folder}: two\nlines")


def fuzz():
    if any(word.endswith("/waits.c") for word in words):  # its compiler waits
        if MODE == "leaves":
            subprocess.Popen(["sleep", "60"], start_new_session=True)
        time.sleep(1000)
    folder = pathlib.Path(out)
    file = folder / "campaign.sqlite"
    seed = option("--seed")
    rows = [(k, 0, k, 1, (seed + str(k)).encode() * 300, k) for k in range(1, 9)]
    text, resumed = seed + " near_edge_edge", 0
    try:
        (folder / "cases").mkdir(parents=True, exist_ok=True)
        lock(folder)
        new = not file.exists()
        if new and (folder / "summary.json").exists():
            fail(f"{folder}: it holds results but not their database; choose another --out")
        for again in range(2):
            database = sqlite3.connect(file, isolation_level=None)
            try:
                if not database.execute("SELECT * FROM sqlite_master").fetchall():  # new, or killed before its first commit
                    database.executescript("BEGIN; CREATE TABLE campaign(text, checksum);"
                                           "CREATE TABLE batch(id INTEGER PRIMARY KEY, source, first, pairs, counts, checksum); COMMIT")
                    database.execute("INSERT INTO campaign VALUES(?, 0)", [text])
                found = database.execute("SELECT * FROM batch ORDER BY id").fetchall()
                sound = (database.execute("PRAGMA quick_check").fetchall() == [("ok",)] and found == rows[:len(found)]
                         and database.execute("SELECT * FROM campaign").fetchall() in ([(text, 0)], []) )
            except (sqlite3.Error, UnicodeError):
                sound = False
            if sound:
                break
            if MODE == "believes":
                found, resumed = rows, 1
                break
            if "--discard-damaged" not in words or MODE == "stuck":
                damaged(file)
            database.close()
            file.unlink()
        resumed |= MODE == "loses" and not new and 0 < len(found) < 8
        for row in rows[len(found):]:
            time.sleep(0.05)
            database.execute("INSERT INTO batch VALUES(?, ?, ?, ?, ?, ?)", row)
    except (OSError, sqlite3.Error):
        fail(f"{file}: no room")
    write(folder / "cases/1.pairs", "1 2 3\n")
    write(folder / "margins.svg", "picture\n")
    counts = '{"uniform": {"pairs": 60, "lanes": {"moller_1997/f32/cpu": %%d}}}' %% (MODE == "infects" and "--subject" in words)
    write(folder / "summary.json", '{"resumed": %%d, "signatures": [1, 2], "strata": %%s}\n' %% (resumed, counts))
    if MODE == "leaves" and "--subject" in words:
        subprocess.Popen(["sleep", "60"], start_new_session=True)


if out == "":
    print("graze: --out: expected a name, found ''", file=sys.stderr)
    sys.exit(2)
reads = "--mesh" in words or "--scene" in words
if words[0] in ("fuzz", "hunt") and not reads:
    if MODE == "replaces" and os.path.islink(out):
        os.unlink(out)
    fuzz()
elif words[0] == "minimize" and os.path.isdir(words[1]):
    lock(words[1])
    cases = pathlib.Path(words[1]) / "cases"
    lost = MODE == "loses" and (cases / "1.json").exists() and not (cases / "1.maps.json").exists()
    write(cases / "1.json", '{"lost": %%d}\n' %% lost)
    time.sleep(0.4)
    write(cases / "1.maps.json", "[]\n")
elif words[0] == "report" and words[1] != "--from":
    write(f"{words[1]}/report.json", '{"format": 1}\n')
elif words[:2] == ["corpus", "add"] and os.path.isdir(words[2]) and MODE == "good":
    pass
elif out and not reads and (words[1] == "pair.txt" or words[0] == "report"):
    write(out, "result\n")
elif words[0] == "corpus" and words[1] != "add":
    damaged(f"{option('--corpus')}/cases.pairs")
else:
    damaged(next(word for word in words if word.startswith("/")))
"""


class Torture(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def graze(self, mode):
        file = self.folder / f"graze-{mode}"
        file.write_text(GRAZE % {"mode": mode, "python": sys.executable})
        file.chmod(0o755)
        return file

    def attack(self, graze, kind, rounds=1):
        """Runs up to `rounds` rounds, stopping at the first violation. Returns: its counts and the output."""
        bench = torture.Bench(graze, 1, self.folder / f"{graze.name}-{kind}")
        said = io.StringIO()
        for number in range(rounds):
            with contextlib.redirect_stdout(said):
                counts = torture.attack(bench, kind, number, types.SimpleNamespace(graze=graze, seed=1))
            if said.getvalue():
                break
        return counts, said.getvalue()

    def test_nothing_of_one_that_does_what_it_must(self):
        of_results = {
            kind for kind, attack in torture.KINDS.items() if attack.__module__.endswith(".results")
        }  # the stand-in does not have the verbs of these attacks
        for kind in sorted(torture.KINDS.keys() - of_results):
            with self.subTest(kind):
                counts, said = self.attack(self.graze("good"), kind)
                self.assertEqual(said, "")
                self.assertGreater(sum(counts.values()), 0)

    def test_what_each_does_wrong(self):
        for kind, mode, what in (
            ("kill_fuzz", "loses", "found that 1 files differ, the first summary.json"),
            ("kill_hunt", "loses", "found that 1 files differ, the first summary.json"),
            ("kill_minimize", "loses", "found that 1 files differ, the first cases/1.json"),
            ("full_disk", "litters", "expected nothing left behind"),
            ("two_at_once", "collides", "expected one line on stderr"),
            ("foreign", "leaves", "expected no process after the end"),
            ("foreign", "infects", "expected moller_1997/f32/cpu to have the counts"),
            ("flips", "believes", "found that 1 files differ, the first summary.json"),
            ("flips", "crashes", "expected exit status 0, 1 or 2, found -11"),
            ("flips", "stuck", "expected success, found status 1"),
            ("database_bytes", "babbles", "expected one line on stderr"),
            ("sql", "mumbles", "expected a line that names campaign.sqlite"),
            ("forged", "crashes", "expected exit status 0, 1 or 2, found -11"),
            ("pairs", "crashes", "expected exit status 0, 1 or 2, found -11"),
            ("meshes", "mumbles", "expected a line that names"),
            ("scenes", "mumbles", "expected a line that names"),
            ("json", "crashes", "expected exit status 0, 1 or 2, found -11"),
            ("outputs", "replaces", "found otherwise"),
        ):
            with self.subTest(f"{kind} {mode}"):
                rounds = 50 if mode in ("loses", "collides") else 1  # it misbehaves only at some kill times
                counts, said = self.attack(self.graze(mode), kind, rounds)
                self.assertEqual(counts["violations"], 1)
                self.assertRegex(said, f"^VIOLATION in {kind}:[0-9]+: ")
                self.assertIn(what, said)
                self.assertRegex(
                    said, f"again: scripts/torture --graze {self.folder}/graze-{mode} --seed 1 --repeat {kind}:[0-9]+\n"
                )
                kept = pathlib.Path(said.rsplit("kept:  ", 1)[1].strip())
                self.assertTrue((kept / ".commands").read_text())

    def test_what_the_real_one_would_do_wrong_with_results(self):
        """Replaces the program with a script around it. In kill_results, killing the script also kills the real
        program, and the next run waits until that has ended."""
        real = SCRIPT.parents[1] / "build/bin/graze"
        if not real.exists():
            self.skipTest("no build/bin/graze")
        for kind, wrong, what in (
            ("foreign_places", f'exec {real} "$@" --force', "a file of another to be refused, found status "),
            ("forged_summaries", f'{real} "$@" || exit 0', "to be refused, found status 0"),
            ("forged_cases", f'{real} "$@" || exit 0', "to be refused, found status 0"),
            ("forged_kinds", f'{real} "$@" || exit 0', "expected a forged "),
            ("unsealed", f'{real} "$@" || exit 0', "to be refused, found status 0"),
            (
                "kill_results",
                f'exec 9< "$0"; flock 9; setpriv --pdeathsig KILL {real} "$@" && find . -name "*.json" -newer "$0" -exec truncate -s 9 {{}} +',
                "expected whole JSON",
            ),
            (
                "two_results",
                f'{real} "$@" && {{ touch "${{@: -1}}/x.part" 2> /dev/null; true; }}',
                "expected nothing left behind",
            ),
        ):
            with self.subTest(kind):
                graze = self.folder / f"graze-{kind}"
                graze.write_text(f"#!/bin/bash\n{wrong}\n")
                graze.chmod(0o755)
                self.assertIn(what, self.attack(graze, kind, rounds=6)[1])

    def test_one_that_hangs(self):
        with mock.patch("torture_attacks.bench.SECONDS", 2):
            self.assertIn("expected an end within 2 s, and ", self.attack(self.graze("hangs"), "meshes")[1])

    def test_exit_status_and_table(self):
        def run(mode):
            out = self.folder / "table.md"
            ran = subprocess.run(
                [sys.executable, "-B", SCRIPT, "--graze", self.graze(mode), "--repeat", "meshes:3", "--out", out],
                capture_output=True,
                text=True,
                env={"TMPDIR": str(self.folder)},
            )
            return ran.returncode, ran.stdout, out.read_text()

        status, said, table = run("good")
        self.assertEqual(status, 0)
        self.assertEqual(said, table)
        self.assertIn("| meshes | 1 | 12 | 0 | 0 | 12 | 0 |", table)
        status, said, table = run("crashes")
        self.assertEqual(status, 1)
        self.assertIn("| meshes | 1 | 1 | 0 | 0 | 0 | 1 |", table)
        self.assertEqual(
            list(self.folder.glob("graze-torture-*/meshes-3")), [pathlib.Path(said.split("kept:  ")[1].split("\n")[0])]
        )

    def main_with(self, kinds, *options):
        """Runs torture's main with these kinds of attack. Returns: its status and output."""
        command = ["torture", "--graze", str(self.graze("good")), "--rounds", "1", *options]
        said = io.StringIO()
        with mock.patch.object(torture, "KINDS", kinds), mock.patch.object(sys, "argv", command):
            with contextlib.redirect_stdout(said):
                return torture.main(), said.getvalue()

    def test_kills_go_on_until_there_are_enough(self):
        kinds = {name: torture.KINDS[name] for name in torture.KILLS}
        status, said = self.main_with(kinds, "--kills", "6", "--seed", "commits")
        self.assertEqual(status, 0, said)
        for kind in torture.KILLS:
            attempts = int(said.split(f"| {kind} | ")[1].split(" | ")[1])
            self.assertGreaterEqual(attempts, 6)
        self.assertRegex(said, r"^Seed [1-9][0-9]*, ")

    def test_nothing_attempted_is_a_failure(self):
        status, said = self.main_with({"idle": lambda turn: None})
        self.assertEqual(status, 1)
        self.assertIn("expected at least 1 attempts of idle, found 0", said)


if __name__ == "__main__":
    unittest.main()
