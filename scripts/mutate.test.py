# SPDX-License-Identifier: Apache-2.0
"""scripts/mutate on a small project: mutants of each kind have the right result, and a resumed run repeats no test. All
mutants in Graze's own list exist."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).with_name("mutate")
CMAKE = """cmake_minimum_required(VERSION 3.25)
project(small CXX)
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
include_directories(${PROJECT_SOURCE_DIR})
add_library(small STATIC part/small.cpp)
add_executable(small_test part/small.test.cpp)
target_link_libraries(small_test small)
"""
HEADER = """#pragma once
inline int twice(int x) { return x + x; }  // 1 + 1 in a comment is no token
inline int size(const int* x) { return x ? sizeof(int[1]) == 4 : 0; }
int clamped(int x);
int count(long x);
"""
SOURCE = """#include "part/small.h"
// At 10 either gives 10.
int clamped(int x) { return x < 10 ? x : 10; }
int count(long x) {
  int n = 0;
  while (x > 0) { ++n; x -= 1; }
  return n;
}
int unseen(int x) { return x * x; }
"""
TEST = """#include "part/small.h"
#include <cstdio>
int fails(const char* name) { std::printf("[  FAILED  ] %s\\n", name); return 1; }
int main() {
  if (twice(3) != 6) return fails("Small.Twice");
  if (clamped(3) != 3 || clamped(20) != 10) return fails("Small.Clamped");
  if (count(3) != 3) return fails("Small.Count");
  static int array[1];
  if (size(array) != 1) return fails("Small.Size");
}
"""
CONFIG = """
[[group]]
name = "small"
program = "small_test"
files = ["part/small.h", "part/small.cpp"]
tests = ["part/small.test.cpp"]
%s
[[planted]]
name = "twice is thrice"
program = "small_test"
file = "part/small.h"
before = "x + x; }"
after = "x + x + x; }"
tests = ["part/small.test.cpp"]
caught_by = "Small.Twice"
"""
EQUIVALENT = """
[equivalent."part/small.cpp"]
"at 10 both give 10" = [
  ["int clamped(int x) { return x < 10 ? x : 10; }",
   "int clamped(int x) { return x <= 10 ? x : 10; }"],
]
"""


class Mutate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="graze-mutate-")))
        for folder in ["scripts", "part"]:
            (cls.root / folder).mkdir()
        for name, text in [
            ("CMakeLists.txt", CMAKE),
            ("part/small.h", HEADER),
            ("part/small.cpp", SOURCE),
            ("part/small.test.cpp", TEST),
        ]:
            (cls.root / name).write_text(text)
        build = ["cmake", "-G", "Ninja", "-S", cls.root, "-B", cls.root / "build"]
        subprocess.run(build, check=True, capture_output=True)
        subprocess.run(["cmake", "--build", cls.root / "build"], check=True, capture_output=True)

    def run_script(self, *options, config=CONFIG % EQUIVALENT):
        (self.root / "scripts/mutants.toml").write_text(config)
        out = self.root / self.id()
        command = [sys.executable, SCRIPT, "--root", self.root, "--out", out, "--patience", "1", *options]
        ran = subprocess.run(command, capture_output=True, text=True)
        lines = (out / "results.jsonl").read_text().splitlines() if (out / "results.jsonl").exists() else []
        return ran, [json.loads(line) for line in lines]

    def test_each_ends_as_it_must(self):
        ran, results = self.run_script()
        states = {(r["file"], r["old"], r["new"], r["line"]): (r["state"], r["by"]) for r in results}
        self.assertEqual(states["part/small.h", "+", "-", 2], ("killed", "Small.Twice"))
        self.assertNotIn(("part/small.cpp", "<", "<=", 3), states)  # listed as equivalent
        self.assertEqual(states["part/small.cpp", "-=", "+=", 6], ("timed out", ""))
        self.assertEqual(states["part/small.cpp", "++", "--", 6], ("killed", "Small.Count"))
        self.assertEqual(states["part/small.cpp", "*", "+", 9], ("survived", ""))
        self.assertEqual(states["part/small.h", "==", "!=", 3], ("killed", "Small.Size"))
        self.assertNotIn(("part/small.h", "+", "-", 1), states)
        self.assertEqual(ran.returncode, 1)
        self.assertIn("SURVIVED part/small.cpp:9:30 * -> +", ran.stdout)
        total = ran.stdout[ran.stdout.index("| all |") :].split("\n")[0].split("|")
        self.assertEqual(int(total[2]), sum(int(cell) for cell in total[3:8]))
        self.assertEqual(total[5].strip(), "1")
        self.assertEqual(list(self.root.glob("*/mutant-*")), [])

    def test_goes_on_where_it_was_and_is_the_same_for_a_seed(self):
        _, some = self.run_script("--count", "2", "--seed", "5")
        _, more = self.run_script("--count", "4", "--seed", "5")
        self.assertEqual(some, more[:2])
        self.assertGreater(len(more), len(some))
        again, same = self.run_script("--count", "4", "--seed", "5")
        self.assertEqual(same, more)
        self.assertNotIn("pass without a mutant", again.stdout)

    def test_is_not_delayed_by_tests_that_were_timed_before(self):
        first, _ = self.run_script()
        # For the header, the test is recompiled. For the source, the test's existing object is used.
        self.assertRegex(
            first.stdout, r"(?m)^small part/small.test.cpp part/small.test.cpp: pass without a mutant, in \d"
        )
        self.assertRegex(first.stdout, r"(?m)^small part/small.test.cpp: pass without a mutant, in \d")
        again, _ = self.run_script("--again", "survived")
        self.assertIn("survived     part/small.cpp:9:30", again.stdout)
        self.assertNotIn("pass without a mutant", again.stdout)

    def test_tests_that_fail_without_a_mutant_are_refused(self):
        self.addCleanup((self.root / "part/small.h").write_text, HEADER)
        (self.root / "part/small.h").write_text(HEADER.replace("x + x", "x + x + 1"))
        ran, results = self.run_script("--count", "1", config=CONFIG % "")
        self.assertEqual((ran.returncode, results), (1, []))
        self.assertIn("expected the tests of group small to pass without a mutant", ran.stderr)

    def test_a_listed_mutant_that_does_not_exist_is_named(self):
        ran, _ = self.run_script("--list", config=CONFIG % EQUIVALENT.replace("<= 10", "> 10"))
        self.assertEqual(ran.returncode, 1)
        self.assertIn("expected a mutant of part/small.cpp, found none", ran.stdout)

    def test_planted_defects_need_the_test_that_is_named(self):
        ran, _ = self.run_script("--planted")
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)
        ran, _ = self.run_script("--planted", config=(CONFIG % "").replace('"Small.Twice"', '"Small.Count"'))
        self.assertEqual(ran.returncode, 1)
        self.assertIn("twice is thrice: NOT CAUGHT, killed", ran.stdout)

    def test_the_projects_own_list_names_mutants_that_exist(self):
        ran = subprocess.run([sys.executable, SCRIPT, "--list"], capture_output=True, text=True)
        self.assertEqual(ran.returncode, 0, ran.stdout)
        self.assertRegex(ran.stdout, r"^[1-9]\d* mutants of [1-9]\d* files")


if __name__ == "__main__":
    unittest.main()
