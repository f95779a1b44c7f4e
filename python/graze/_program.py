# SPDX-License-Identifier: Apache-2.0
"""Calls the program `graze` for campaigns and drawings, which are not in the library."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
from typing import Any


def program() -> str:
    """The program's path: the environment variable GRAZE, or `graze` on the PATH. Raises FileNotFoundError."""
    found = os.environ.get("GRAZE") or shutil.which("graze")
    if not found:
        raise FileNotFoundError("there is no program `graze` on the PATH; install Graze, or set GRAZE to its path")
    return found


def run(*arguments: str) -> str:
    """Runs `graze ARGUMENTS`.   Returns: its output.   Raises: RuntimeError with its last line if it fails."""
    done = subprocess.run([program(), *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = (done.stderr or done.stdout).strip().splitlines() or [f"exit status {done.returncode}"]
        raise RuntimeError(f"graze {arguments[0]}: {lines[-1].removeprefix('graze: ')}")
    return done.stdout


def campaign(out: "str | os.PathLike[str]", **options: Any) -> dict[str, Any]:
    """Runs `graze fuzz --out OUT` with these options, such as pairs=10_000, lanes="*/f32/cpu", subject="own=own.cpp:f".
    A list repeats an option; True passes the option without a value.

    Returns: the campaign's summary.json, whose keys docs/formats.md lists.
    Raises: FileNotFoundError if there is no program; RuntimeError with the program's message if it fails; ValueError
    for a shard, which has no summary until `graze merge` has run.
    """
    if "shard" in options:
        raise ValueError("a shard has no summary.json; run `graze fuzz --shard` and `graze merge` instead")
    arguments = ["fuzz", "--out", os.fspath(out)]
    for name, value in options.items():
        for one in value if isinstance(value, (list, tuple)) else [value]:
            arguments += ["--" + name.replace("_", "-")] + ([] if one is True else [str(one)])
    run(*arguments)
    return json.loads((pathlib.Path(out) / "summary.json").read_text(encoding="utf-8"))


def viewer_page(numbers: str) -> str:
    """The page that `graze view` writes for a pair of 18 numbers.   Raises: as campaign does."""
    with tempfile.TemporaryDirectory() as folder:
        file, page = os.path.join(folder, "pair.txt"), os.path.join(folder, "view.html")
        pathlib.Path(file).write_text(numbers + "\n", encoding="utf-8")
        run("view", file, "--out", page)
        return pathlib.Path(page).read_text(encoding="utf-8")
