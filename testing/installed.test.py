#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Installs the test library, then builds and runs another project's tests with it, as that project would."""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys

parser = argparse.ArgumentParser()
for name in ("cmake", "generator", "build", "examples", "prefix", "compiler", "graze"):
    parser.add_argument("--" + name, required=True)
args = parser.parse_args()
prefix = pathlib.Path(args.prefix)
failed = []


def expect(holds, what):
    if not holds:
        failed.append(what)


def run(*words, **more):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, **more)


shutil.rmtree(prefix, ignore_errors=True)
for words in (
    [args.cmake, "--install", args.build, "--component", "test", "--prefix", prefix],
    [args.cmake, "-G", args.generator, "-S", args.examples, "-B", prefix / "build", f"-DCMAKE_PREFIX_PATH={prefix}"]
    # The flags of another project must not reach the library's arithmetic.
    + [f"-DCMAKE_CXX_COMPILER={args.compiler}", "-DCMAKE_CXX_FLAGS=-O2 -ffast-math -Wall -Wextra -Werror"],
    [args.cmake, "--build", prefix / "build"],
):
    done = run(*words)
    if done.returncode != 0:
        sys.exit(done.stdout + done.stderr)

needed = run("ldd", prefix / "lib" / "libgraze_test.so").stdout
expect(not re.search(r"CGAL|gmp|mpfr", needed), "neither CGAL nor GMP, found " + needed)

environment = dict(os.environ, GRAZE_PAIRS="21000")
ran = 0
for framework in ("gtest", "catch2", "doctest"):
    program = prefix / "build" / f"with_{framework}"
    if not program.exists():
        print(f"without {framework}: not installed")
        continue
    ran += 1
    done = run(program, env=environment)
    text = done.stdout + done.stderr
    expect(done.returncode != 0, f"{framework}: a failing test, found status 0")
    expect(re.search(r"overlap is wrong on [\d,]+ of 21,000 pairs", text), f"{framework}: counts in {text}")
    expect("const float a[9] = {" in text, f"{framework}: a pair in {text}")
    passed = {"gtest": r"PASSED  \] 2 tests", "catch2": r"2 \| 1 passed", "doctest": r"2 \| 1 passed"}[framework]
    expect(re.search(passed, text), f"{framework}: one failure alone in {text}")
    if framework != "gtest":
        continue
    # The command in the message must explain the pair in the message.
    command = re.search(r"Why: (echo .*)", text)[1].replace("YOUR_FILE", "own")
    (prefix / "build" / "own.cpp").write_text(f'#include "{args.examples}/overlap.h"\n')
    path = str(pathlib.Path(args.graze).parent) + os.pathsep + os.environ["PATH"]
    explained = run("sh", "-c", command, cwd=prefix / "build", env=dict(os.environ, PATH=path))
    expect(explained.returncode == 0 and "own/f64" in explained.stdout, f"an explanation, found {explained}")
if ran == 0:
    print("SKIPPED: none of the three frameworks is installed")
for what in failed:
    print("expected " + what)
sys.exit(1 if failed else 0 if ran else 77)
