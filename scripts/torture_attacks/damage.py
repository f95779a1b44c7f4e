# SPDX-License-Identifier: Apache-2.0
"""Damages a campaign's database. graze must then give the results of an undisturbed run, or refuse with one line; after
a refusal, --discard-damaged must give these results."""
import shutil
import sqlite3

from torture_attacks import mutate
from torture_attacks.bench import Violation, bytes_of
from torture_attacks.seal import fnv1a

ATTEMPTS = 8
DATABASE = "campaign.sqlite"
NUMBERS = [
    "-1",
    "0",
    "1",
    "2000000",
    "9223372036854775807",
    "-9223372036854775808",
    "1.5",
    "NULL",
    "'x'",
    "x'00'",
    "{0} + 1",
    "{0} - 1",
    "-{0}",
]
ROW = "WHERE id = (SELECT id FROM batch ORDER BY random() LIMIT 1)"
# Each statement leaves a database that SQLite considers valid.
STATEMENTS = [
    "DELETE FROM batch " + ROW,
    "DELETE FROM batch",
    "DELETE FROM campaign",
    "DROP TABLE batch",
    "DROP TABLE campaign",
    "INSERT INTO batch(source, first, pairs, counts, checksum) SELECT source, first, pairs, counts, checksum FROM batch LIMIT 1",
    "INSERT INTO batch(source, first, pairs, counts, checksum) SELECT source + 1, first, pairs, counts, checksum FROM batch LIMIT 1",
    "INSERT INTO campaign SELECT * FROM campaign",
    "UPDATE campaign SET text = replace(text, '\"seed\":', '\"seed\":1')",
    "UPDATE campaign SET text = replace(text, '\"pairs\":600', '\"pairs\":601')",
    "UPDATE campaign SET text = substr(text, 2)",
    "UPDATE campaign SET text = ''",
    "UPDATE campaign SET text = x'ff'",
    "UPDATE campaign SET checksum = checksum + 1",
    "UPDATE campaign SET checksum = 'x'",
    "UPDATE batch SET counts = x'' " + ROW,
    "UPDATE batch SET counts = 'text' " + ROW,
    "UPDATE batch SET counts = 0 " + ROW,
    "UPDATE batch SET counts = randomblob(length(counts)) " + ROW,
    "UPDATE batch SET counts = zeroblob(20000000) " + ROW,
    "UPDATE batch SET counts = substr(counts, 1, length(counts) - 1) " + ROW,
    "UPDATE batch SET counts = (SELECT counts FROM batch ORDER BY id DESC LIMIT 1)",
    "UPDATE batch SET id = -id",
    "UPDATE batch SET id = 9223372036854775807 " + ROW,
    "ALTER TABLE batch ADD COLUMN more INTEGER",
    "ALTER TABLE batch RENAME COLUMN pairs TO pears",
    "CREATE TABLE more(x)",
    "CREATE TRIGGER more AFTER INSERT ON batch BEGIN SELECT 1; END",
    "PRAGMA user_version = 4",
    "PRAGMA user_version = 0",
    "PRAGMA application_id = 1",
    "PRAGMA application_id = 0",
    "PRAGMA journal_mode = WAL",
    "VACUUM",
]


def statement(random):
    if random.random() < 0.5:
        column = random.choice(["source", "first", "pairs", "checksum"])
        return f"UPDATE OR REPLACE batch SET {column} = {random.choice(NUMBERS).format(column)} {ROW if random.random() < 0.7 else ''}"
    return random.choice(STATEMENTS)


def copies(turn):
    """Yields copies of a finished campaign, some without results, which must be restored from the database."""
    for campaign in turn.copies(turn.bench.reference("small"), ATTEMPTS):
        if turn.random.random() < 0.5:
            shutil.rmtree(campaign / "cases")
            (campaign / "summary.json").unlink()
        yield campaign


def judge(turn, campaign):
    """Resumes the campaign whose database was damaged, and counts the outcome."""
    command = [*turn.bench.campaign("small"), "--out", campaign]
    if turn.random.random() < 0.25:
        refuses_another_seed(turn, campaign, command)
    refused = turn.run(*command)
    if turn.is_refused(refused, DATABASE, campaign.name + ": it holds results but not their database"):
        went_on = turn.run(*command, "--discard-damaged")
        # Another program's database, or results without one, do not count as damage. The message says what to do.
        if not (turn.is_refused(went_on, campaign.name) and "choose another --out" in went_on.err):
            turn.must_succeed(went_on)
            turn.must_be_same(campaign, turn.bench.reference("small"))
        turn.count("refused")
    else:
        turn.must_be_same(campaign, turn.bench.reference("small"))
        turn.count("same")


def refuses_another_seed(turn, campaign, command):
    other = list(command)
    other[other.index("--seed") + 1] += "1"
    before = bytes_of(campaign)
    has_rows = b"near_edge_edge" in before.get(campaign / DATABASE, b"")
    ran = turn.run(*other)
    if ran.status == 0 and (has_rows or (campaign / "cases").exists() and campaign / "summary.json" in before):
        raise Violation("expected another seed to be refused, found that the campaign was resumed")
    if ran.status == 0:  # nothing was left of the campaign, so it started again; restore the files
        shutil.rmtree(campaign)
        for file, data in before.items():
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data)


def flips(turn):
    """Flips single bits."""
    for campaign in copies(turn):
        file = campaign / DATABASE
        file.write_bytes(mutate.flip_bit(turn.random, file.read_bytes()))
        judge(turn, campaign)


def database_bytes(turn):
    """Changes bytes, pieces or the end of the database, or replaces it by something else."""
    for campaign in copies(turn):
        file = campaign / DATABASE
        data = file.read_bytes()
        file.unlink()
        choice = turn.random.randrange(20)
        if choice == 0:
            file.mkdir()
            ran = turn.run(*turn.bench.campaign("small"), "--out", campaign)
            turn.must_refuse(ran, "a folder in the database's place", DATABASE)
            continue
        if choice == 1:
            file.write_bytes(turn.random.randbytes(turn.random.choice([1, 100, 5000])))
        elif choice == 2:
            file.write_bytes(b"")
        elif choice == 3:
            (campaign / (DATABASE + "-wal")).write_bytes(turn.random.randbytes(5000))
            file.write_bytes(data)
        elif choice == 4:
            (campaign / (DATABASE + "-journal")).write_bytes(turn.random.randbytes(5000))
            file.write_bytes(data)
        else:
            file.write_bytes(mutate.any_of(turn.random, data, mutate.BINARY))
        judge(turn, campaign)


def signed(number):
    return number - (1 << 64) if number >> 63 else number


def forged(turn):
    """Changes a row and its checksum. graze may accept the row, but nothing may break."""
    for campaign in copies(turn):
        with sqlite3.connect(campaign / DATABASE, isolation_level=None) as database:
            (of_campaign,) = database.execute("SELECT checksum FROM campaign").fetchone()
            rows = database.execute("SELECT id, source, first, pairs, counts FROM batch").fetchall()
            row, *place, counts = turn.random.choice(rows)
            start = f"{of_campaign & (1 << 64) - 1:016x} {' '.join(map(str, place))} ".encode()
            counts = mutate.any_of(turn.random, counts, mutate.BINARY)
            database.execute(
                "UPDATE batch SET counts = ?, checksum = ? WHERE id = ?",
                [counts, signed(fnv1a(counts, fnv1a(start))), row],
            )
        database.close()
        command = [*turn.bench.campaign("small"), "--out", campaign]
        refused = turn.is_refused(turn.run(*command), DATABASE)
        if refused:
            turn.must_succeed(turn.run(*command, "--discard-damaged"))
            turn.must_be_same(campaign, turn.bench.reference("small"))
        turn.count("refused" if refused else "read")


def sql(turn):
    """Changes the database through SQLite, which leaves a valid file."""
    for campaign in copies(turn):
        chosen = [statement(turn.random) for _ in range(turn.random.choice([1, 1, 2]))]
        with sqlite3.connect(campaign / DATABASE, isolation_level=None) as database:
            for each in chosen:
                turn.commands.append(f"sqlite3 {campaign / DATABASE} {each!r}")
                try:
                    database.execute(each).fetchall()
                except (sqlite3.Error, OverflowError):
                    pass  # the second statement may no longer apply; a value that a column rejects does no damage
        database.close()
        judge(turn, campaign)
