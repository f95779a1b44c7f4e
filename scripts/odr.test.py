# SPDX-License-Identifier: Apache-2.0
"""With the preset `odr`, a type that two translation units define differently is a link error."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).parent.parent
REPLAY = "namespace graze{} {{ struct Replay {{ {} }}; }}\nusing namespace graze{}; int {}(const Replay& r) {{ return r.steps != 0; }}\n"
COMPILER = sys.argv.pop() if len(sys.argv) > 1 else "g++"


class Odr(unittest.TestCase):
    def link(self, *sources):
        """Returns: the exit status and the output of a build with the preset's own flags."""
        presets = json.loads((ROOT / "CMakePresets.json").read_text(encoding="utf-8"))["configurePresets"]
        chosen = next(preset["cacheVariables"] for preset in presets if preset["name"] == "odr")
        self.assertEqual(chosen["CMAKE_INTERPROCEDURAL_OPTIMIZATION"], "ON")  # which is -flto
        with tempfile.TemporaryDirectory() as folder:
            names = []
            for i, source in enumerate(sources):
                names.append(pathlib.Path(folder) / f"{i}.cpp")
                names[-1].write_text(source, encoding="utf-8")
            command = [COMPILER, "-std=c++20", "-flto", *chosen["CMAKE_CXX_FLAGS_DEBUG"].split(), "-shared", "-fPIC"]
            ran = subprocess.run([*command, *names, "-o", f"{folder}/out.so"], capture_output=True, text=True)
            return ran.returncode, ran.stderr

    def test_two_definitions_of_a_type_are_an_error(self):
        status, said = self.link(REPLAY.format("", "int steps;", "", "f"), REPLAY.format("", "double steps;", "", "g"))
        self.assertNotEqual(status, 0)
        self.assertIn("Replay", said)
        self.assertIn("-Werror=odr", said)

    def test_the_same_twice_or_in_namespaces_of_their_own_is_none(self):
        same = REPLAY.format("", "int steps;", "", "f")
        self.assertEqual(self.link(same, REPLAY.format("", "int steps;", "", "g")), (0, ""))
        self.assertEqual(self.link(same, REPLAY.format("::fuzz", "double steps;", "::fuzz", "g")), (0, ""))


if __name__ == "__main__":
    unittest.main()
