# SPDX-License-Identifier: Apache-2.0
"""graze must not replace a device, pipe, link or folder at the path of --out."""
import os
import pathlib
import stat
import subprocess

from torture_attacks.bench import Violation

PAIR = "0.1 0.2 0.3  0.4 0.9 0.2  0.7 0.1 0.6   0.1 0.2 0.3  0.5 0.5 0.9  -0.3 0.8 0.4\n"
LANE = "guigue_devillers_2003/f32/cpu"


def verbs(turn):
    """Lists of arguments, to which the output file must be appended."""
    (turn.folder / "pair.txt").write_text(PAIR)
    report = turn.bench.reference("tiny", reported=True) / "report.json"
    return [
        ["minimize", "pair.txt", "--lanes", LANE, "--out"],
        ["map", "pair.txt", "--lanes", LANE, "--out"],
        ["report", "--from", report, "--out"],
    ]


def device(folder, minor, name):
    """Makes a separate device node, so that a defect cannot destroy the machine's own. Returns: None if not
    permitted."""
    node = folder / f"{name}.png"
    try:
        os.mknod(node, stat.S_IFCHR | 0o600, os.makedev(1, minor))
        os.close(os.open(node, os.O_WRONLY))
    except PermissionError:
        node.unlink(missing_ok=True)
        return None
    return node


def expect(condition, expected):
    if not condition:
        raise Violation(f"expected {expected}, found otherwise")


def outputs(turn):
    for place, verb in enumerate(verbs(turn)):
        folder = turn.folder / str(place)
        folder.mkdir()
        plain = folder / "plain.png"
        turn.must_succeed(turn.run(*verb, plain))
        expected = plain.read_bytes()
        turn.count("same")
        for attack in (to_devices, to_a_pipe, to_links, to_folders, to_nothing):
            attack(turn, verb, folder, expected)
        left = [file.name for file in folder.rglob("*.part*")]
        expect(not left, f"nothing left behind ({left})")
    campaigns(turn)


def to_devices(turn, verb, folder, _expected):
    for minor, name in ((3, "null"), (7, "full")):
        node = device(folder, minor, name)
        if node is None:
            continue
        ran = turn.run(*verb, node)
        expect(stat.S_ISCHR(os.lstat(node).st_mode), f"{name} to stay a device")
        if name == "null":
            turn.must_succeed(ran)
            turn.count("same")
        else:
            turn.must_refuse(ran, "a full device", node.name)


def to_a_pipe(turn, verb, folder, expected):
    pipe = folder / "pipe.png"
    os.mkfifo(pipe)
    with open(folder / "piped", "wb") as piped:
        reader = subprocess.Popen(["cat", pipe], stdout=piped)
    try:
        turn.must_succeed(turn.run(*verb, pipe))
        expect(stat.S_ISFIFO(os.lstat(pipe).st_mode), "the pipe to stay a pipe")
        reader.wait(30)
        expect((folder / "piped").read_bytes() == expected, "the same bytes through a pipe")
    finally:
        reader.kill()
        reader.wait()
    turn.count("same")


def to_links(turn, verb, folder, expected):
    target, link, dangling, loop = (folder / name for name in ("target.png", "link.png", "dangling.png", "loop.png"))
    target.write_bytes(expected)  # graze's own file; results.foreign_places tests other files
    link.symlink_to(target.name)
    dangling.symlink_to("made.png")
    loop.symlink_to("loop.png")
    for name, behind in ((link, target), (dangling, folder / "made.png")):
        turn.must_succeed(turn.run(*verb, name))
        expect(name.is_symlink() and behind.read_bytes() == expected, "the link to stay a link, to the expected bytes")
        turn.count("same")
    turn.must_refuse(turn.run(*verb, loop), "a link to itself", loop.name)
    expect(loop.is_symlink(), "the link to stay a link")


def to_folders(turn, verb, folder, _expected):
    there = folder / "folder.png"
    there.mkdir()
    (there / "kept").write_text("kept")
    turn.must_refuse(turn.run(*verb, there), "a folder", there.name)
    expect([file.name for file in there.iterdir()] == ["kept"], "the folder to be unchanged")
    missing = folder / "missing" / "file.png"
    turn.must_refuse(turn.run(*verb, missing), "a file in no folder", missing.name)


def to_nothing(turn, verb, _folder, _expected):
    ran = turn.run(*verb, "")
    turn.must_refuse(ran, "--out ''", "--out")
    expect(ran.status == 2, "--out '' to be wrong use")


def campaigns(turn):
    """`fuzz --out`."""
    command, reference = [*turn.bench.campaign("tiny"), "--out"], turn.bench.reference("tiny")
    folder = turn.folder / "campaigns"
    (folder / "behind").mkdir(parents=True)
    (folder / "link").symlink_to("behind")
    turn.must_succeed(turn.run(*command, folder / "link"))
    turn.must_be_same(folder / "behind", reference)
    turn.count("same")
    (folder / "file").write_text("kept")
    (folder / "dangling").symlink_to("nowhere/at/all")
    names = [folder / "file", folder / "file" / "below", folder / "dangling", pathlib.Path("/proc/graze")]
    node = device(folder, 3, "null")
    for name in [*names, *([node] if node else [])]:
        turn.must_refuse(turn.run(*command, name), name, name.name)
    expect((folder / "file").read_text() == "kept", "the file to be unchanged")
    expect(node is None or stat.S_ISCHR(os.lstat(node).st_mode), "the device to stay a device")
    to_nothing(turn, command, folder, b"")
