# SPDX-License-Identifier: Apache-2.0
"""Mutated files for every reader. graze must read them, or refuse them with one line that names the file."""
import pathlib
import shutil
import struct

from torture_attacks import mutate, seal
from torture_attacks.bench import Violation

ATTEMPTS = 12
PROJECT = pathlib.Path(__file__).resolve().parents[2]
LANES = ["--lanes", "guigue_devillers_2003/f32/cpu,interval_overlap/f32/cpu"]
# A name that is not UTF-8 cannot appear in a message, because messages are UTF-8.
NAMES = ["mutated", "mutated", "mutated", "with space", "umläut", b"\xff", "a:b:c", "-"]


def tetrahedra():
    """Two intersecting tetrahedra: 8 points, 8 triangles."""
    points = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4), (1, 1, 1), (5, 1, 1), (1, 5, 1), (1, 1, -3.5)]
    faces = [
        (a, b, c)
        for base in (0, 4)
        for a, b, c in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
        for a, b, c in [(a + base, b + base, c + base)]
    ]
    return points, faces


def mesh_files():
    points, faces = tetrahedra()
    rows = "".join(f"{x} {y} {z}\n" for x, y, z in points)
    corners = [[points[i] for i in face] for face in faces]
    head = (
        f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\nelement face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )

    def binary(order, counts):
        body = b"".join(struct.pack(order + "3f", *p) for p in points) + b"".join(
            struct.pack(order + "B3i", 3, *f) for f in faces
        )
        return f"ply\nformat {counts} 1.0\n{head}".encode() + body

    stl = "".join(
        "facet normal 0 0 0\n outer loop\n"
        + "".join(f"  vertex {x} {y} {z}\n" for x, y, z in c)
        + " endloop\nendfacet\n"
        for c in corners
    )
    return {
        "off": (
            f"OFF\n{len(points)} {len(faces)} 0\n{rows}" + "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)
        ).encode(),
        "obj": (
            "# two\n"
            + "".join(f"v {row}\n" for row in rows.splitlines())
            + "vn 0 0 1\ng part\n"
            + "".join(f"f {a + 1}//1 {b - 8} {c + 1}\n" for a, b, c in faces)
            + "l 1 2\n"
        ).encode(),
        "stl": f"solid two\n{stl}endsolid two\n".encode(),
        "binary.stl": b"two".ljust(80)
        + struct.pack("<I", len(faces))
        + b"".join(struct.pack("<12fH", 0, 0, 0, *[x for point in c for x in point], 0) for c in corners),
        "ply": (f"ply\nformat ascii 1.0\n{head}{rows}" + "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)).encode(),
        "little.ply": binary("<", "binary_little_endian"),
        "big.ply": binary(">", "binary_big_endian"),
    }


def judge(turn, ran, *names):
    turn.count("refused" if turn.is_refused(ran, *names) else "read")


def named(turn, extension):
    """The path of the mutated file, and the text that a refusal must contain."""
    name = turn.random.choice(NAMES)
    if isinstance(name, bytes):
        return turn.folder / (name + b"." + extension.encode()).decode(errors="surrogateescape"), "." + extension
    return turn.folder / f"{name}.{extension}", f"{name}.{extension}"


def meshes(turn):
    for attempt in range(ATTEMPTS):
        extension, data = turn.random.choice(list(mesh_files().items()))
        extension = (
            turn.random.choice([extension, extension, extension, "off", "obj", "stl", "ply"])
            if attempt % 4 == 3
            else extension
        )
        file, name = named(turn, extension)
        binary = extension.startswith(("binary", "little", "big"))
        file.write_bytes(
            mutate.any_of(turn.random, data, mutate.BINARY if binary and turn.random.random() < 0.7 else mutate.TEXT)
        )
        out = turn.folder / "out"
        judge(turn, turn.run("fuzz", "--mesh", file, *LANES, "--out", out), name)
        shutil.rmtree(out, ignore_errors=True)
        file.unlink()


SCENE = b"""units = "mm"
extent = [[120000, 120800], [-5400, -5000.5], [300, 9e2]]
edges = [0.5, 4, 40]  # shortest to longest
grid = { decimals = 3 }
[mix]
general = 0.75
coplanar = 0.25
[margins]
"0" = 0.5
"+2^5" = 0.5
"""


def scenes(turn):
    """Scenes, and poses of a mesh."""
    for attempt in range(ATTEMPTS):
        poses = attempt % 4 == 3
        file, name = named(turn, "csv" if poses else "toml")
        data = b"1,0,0,0, 0,1,0,0, 0,0,1,0\n1 0 0 0.5 0 1 0 0.25 0 0 1 0\n" if poses else SCENE
        file.write_bytes(mutate.any_of(turn.random, data, mutate.TEXT))
        out = turn.folder / "out"
        mesh = turn.folder / "two.off"
        mesh.write_bytes(mesh_files()["off"])
        ran = (
            turn.run("scene", mesh, "--poses", file)
            if poses
            else turn.run("fuzz", "--scene", file, "--pairs", "200", *LANES, "--out", out)
        )
        # If poses separate the bodies, there are no pairs, and the message names the mesh instead.
        judge(turn, ran, name, "two.off")
        shutil.rmtree(out, ignore_errors=True)
        file.unlink()


def pairs(turn):
    """Pair files, read by all verbs, and the regression corpus."""
    sources = sorted((PROJECT / "corpus").glob("*/*.pairs"))
    cases = sorted((turn.bench.reference("small") / "cases").glob("*.pairs"))
    minimised = sorted((turn.bench.reference("tiny", minimised=True) / "cases").glob("*.pairs"))
    pasted = [
        b"v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -1\nv 1 1 1\nv 5 5 1\nf 1 2 3\nf 4 5 6\n",
        b"{{0.f, 0.f, 0.f}, {4.f, 0.f, 0.f}, {0.f, 4.f, 0.f}},\n{{1.f, 1.f, -1.f}, {1.f, 1.f, 1.f}, {5.f, 5.f, 1.f}}\n",
    ]
    for attempt in range(ATTEMPTS):
        file, name = named(turn, "pairs")
        data = turn.random.choice(
            [
                lambda: turn.random.choice(cases).read_bytes(),
                lambda: turn.random.choice(minimised).read_bytes(),
                lambda: b"".join(
                    turn.random.sample(turn.random.choice(sources).read_bytes().splitlines(keepends=True), 4)
                ),
                lambda: turn.random.choice(pasted),
            ]
        )()
        file.write_bytes(mutate.any_of(turn.random, data, mutate.TEXT))
        commands = [
            ["check", file, *LANES],
            ["check", file, *LANES, "--json"],
            ["check", file, "--truth-only"],
            ["repro", file, *LANES],
            ["repro", file, "--emit", "cpp"],
            ["repro", file, "--emit", "python"],
            ["explain", file, *LANES],
            ["minimize", file, *LANES, "--out", "out.pairs"],
            ["map", file, *LANES, "--out", "out.png"],
            ["corpus", "add", file, "--corpus", "corpus", *LANES],
        ]
        judge(turn, turn.run(*turn.random.choice(commands)), name)
        file.unlink()
        shutil.rmtree(turn.folder / "corpus", ignore_errors=True)
    folder = turn.folder / "kept"
    folder.mkdir()
    for verb in (["verify", *LANES], ["list"], ["verify", "--update", *LANES]):
        data = b"".join((PROJECT / "corpus/regression/cases.pairs").read_bytes().splitlines(keepends=True)[:12])
        (folder / "cases.pairs").write_bytes(mutate.any_of(turn.random, data, mutate.TEXT))
        judge(turn, turn.run("corpus", *verb[:1], "--corpus", folder, *verb[1:]), "cases.pairs")


def json(turn):
    """The files of a campaign: summary, cases and stored data about them, timings, and a report."""
    reported = turn.bench.reference("tiny", minimised=True, reported=True)
    for campaign in turn.copies(reported, ATTEMPTS // 2):
        cases = [file for file in sorted((campaign / "cases").iterdir()) if file.is_file()]
        files = [campaign / "summary.json"] * 3 + [campaign / "report.json"] * 3 + [campaign / "timings.json"]
        for ending in (".pairs", ".maps.json", ".json"):
            files += [file for file in cases if file.name.endswith(ending)][:1]
        file = turn.random.choice(files)
        data = file.read_bytes()
        if file.suffix == ".json" and turn.random.random() < 0.6:
            data = mutate.edit_json(turn.random, data)
            value = seal.loads(data)
            if value.pop("checksum", None) is not None and turn.random.random() < 0.7:  # seal the edit
                data = seal.text(value).encode(errors="surrogatepass")
        else:
            data = mutate.any_of(turn.random, data, mutate.TEXT)
        file.write_bytes(data)
        if file.name == "report.json":
            commands = [["report", "--from", file, "--out", turn.folder / "page.html"]]
        elif file.suffix == ".pairs":
            commands = [
                ["minimize", campaign],
                ["report", campaign],
                ["corpus", "add", campaign, "--corpus", turn.folder / "corpus"],
                ["repro", file],
            ]
        else:
            commands = [
                ["report", campaign],
                ["minimize", campaign],
                ["corpus", "add", campaign, "--corpus", turn.folder / "corpus"],
                ["report", "--compare", reported, campaign],
                [*turn.bench.campaign("tiny"), "--out", campaign],
            ]
        command = turn.random.choice(commands)
        ran = turn.run(*command)
        judge(turn, ran, file.name)
        if (
            command[0] == "fuzz" and ran.status != 0 and file.name != "timings.json"
        ):  # fuzz refuses a damaged timings.json, because its old runs would be lost
            raise Violation(f"expected fuzz to make its files anew, found {ran.err!r}")
