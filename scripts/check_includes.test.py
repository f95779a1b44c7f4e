# SPDX-License-Identifier: Apache-2.0
"""check_includes.py fails on each kind of violation, planted in a small tree, and when there is nothing to check."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import check_includes

SCRIPT = pathlib.Path(__file__).with_name("check_includes.py")


class IncludeDirection(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.write("CMakeLists.txt", "add_subdirectory(core)\nadd_subdirectory(oracle)\nadd_subdirectory(cuda)\n")
        self.write("core/pair.h", "#pragma once\n#include <cstdint>\n")
        self.write("oracle/truth.cpp", '#include "core/pair.h"\n#include <gmpxx.h>\n#include <CGAL/intersections.h>\n')
        self.write(
            "cuda/lanes/kernels.cu",
            '#include "cuda/lanes/kernels.cuh"\n#include "core/pair.h"\n#include <cub/cub.cuh>\n',
        )
        self.write("cuda/lanes/kernels.cuh", '#include <cuda_runtime.h>\n#include "build_info.h"\n')

    def write(self, name, text):
        file = self.root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def said(self, exceptions=None):
        return check_includes.check(self.root, exceptions or {})[1]

    def test_a_tree_without_violations_is_green(self):
        self.assertEqual(check_includes.check(self.root, {}), (4, []))

    def test_each_kind_of_violation_is_told_by_line(self):
        for file, line, found in [
            ("core/pair.test.cpp", '#include "oracle/truth.h"', '"oracle/truth.h"'),
            ("core/pair.test.cpp", "  #  include <cuda/lanes/kernels.cuh>", '"cuda/lanes/kernels.cuh"'),
            ("oracle/deep/er.inl", '#include "cuda/lanes/kernels.cuh"', '"cuda/lanes/kernels.cuh"'),
            ("cuda/lanes/late.cu", '#include "analysis/tally.h"', '"analysis/tally.h"'),
            ("cuda/lanes/near.cuh", '#include "kernels.cuh"', '"kernels.cuh"'),
            ("core/pair.bench.cpp", "#include <gmp.h>", "<gmp.h>"),
            ("core/pair.bench.cpp", "#include <boost/multiprecision/mpfr.hpp>", "<boost/multiprecision/mpfr.hpp>"),
            ("cuda/lanes/box.cu", "#include <CGAL/Bbox_3.h>", "<CGAL/Bbox_3.h>"),
            ("oracle/device.cpp", "#include <cuda_runtime.h>", "<cuda_runtime.h>"),
            ("oracle/device.cpp", "#include <cub/cub.cuh>", "<cub/cub.cuh>"),
        ]:
            with self.subTest(file=file, line=line):
                self.write(file, "// a comment\n" + line + "\n")
                said = self.said()
                self.assertEqual(len(said), 1, said)
                self.assertTrue(said[0].startswith(f"{file}:2: expected "), said)
                self.assertTrue(said[0].endswith(f"found {found}"), said)
                (self.root / file).unlink()

    def test_only_backends_ask_what_runs_a_lane(self):
        for text, found in [
            ("if (lane.is_cuda()) return;\n", "is_cuda()"),
            ("f(cuda::block_on_host(lane));\n", "block_on_host("),
        ]:
            for file in ["cuda/lanes/asks.cpp", "core/asks.test.cpp"]:
                self.write(file, text)
                self.assertEqual(self.said(), [])
            self.write("oracle/asks.cpp", text)
            said = self.said()
            self.assertEqual(len(said), 1, said)
            self.assertTrue(said[0].startswith("oracle/asks.cpp:1: ") and said[0].endswith(f"found {found}"), said)
            (self.root / "oracle/asks.cpp").unlink()

    def test_a_list_of_files_names_no_later_folder(self):
        self.write("oracle/CMakeLists.txt", "add_library(oracle truth.cpp ../core/pair.cpp)\n")
        self.assertEqual(self.said(), [])
        self.write("core/CMakeLists.txt", "add_library(core pair.cpp ../oracle/truth.cpp)\n")
        self.assertEqual(self.said(), ["core/CMakeLists.txt: expected files of core, found one of oracle"])

    def test_folders_inside_have_no_cycle(self):
        self.write("cuda/twin/twin.h", '#include "cuda/lanes/kernels.cuh"\n')
        self.write("cuda/no_device.cpp", '#include "cuda/twin/twin.h"\n')
        self.write("cuda/lanes/twins.test.cpp", '#include "cuda/twin/twin.h"\n')
        self.assertEqual(self.said(), [])
        self.write("cuda/lanes/device.cu", '\n#include "cuda/twin/twin.h"\n')
        self.assertEqual(len(self.said()), 1, self.said())
        for arrow in [
            'cuda/lanes/device.cu:2 includes "cuda/twin/twin.h"',
            'cuda/twin/twin.h:1 includes "cuda/lanes/kernels.cuh"',
        ]:
            self.assertIn(arrow, self.said()[0])

    def test_no_algorithm_includes_another(self):
        info = "struct Sat { static constexpr AlgorithmInfo kInfo{}; };\n"
        self.write("core/algorithms/sat.h", '#include "core/algorithms/plane.h"\n' + info)
        self.write("core/algorithms/plane.h", "struct Plane;\n")
        self.write("core/algorithms/list.h", '#include "core/algorithms/sat.h"\n')
        self.assertEqual(self.said(), [])
        self.write("core/algorithms/moller.h", '#include "core/algorithms/sat.h"\n' + info)
        self.assertEqual(
            self.said(), ['core/algorithms/moller.h:1: expected no other algorithm, found "core/algorithms/sat.h"']
        )

    def test_an_exception_is_for_its_library_and_must_be_used(self):
        reads = {"core/mesh*.cpp": ("CGAL, GMP and MPFR", "reads meshes")}
        self.assertIn("found none", self.said(reads)[0])
        self.write("core/mesh.cpp", "#include <CGAL/Bbox_3.h>\n")
        self.assertEqual(self.said(reads), [])
        self.write("core/mesh.cpp", "#include <CGAL/Bbox_3.h>\n#include <cuda_runtime.h>\n")
        self.assertEqual(len(self.said(reads)), 1)

    def run_script(self, *arguments):
        return subprocess.run([sys.executable, SCRIPT, *arguments], capture_output=True, text=True).returncode

    def test_its_exit_status_tells(self):
        self.assertEqual(self.run_script(), 2)
        self.assertEqual(self.run_script(self.root / "core"), 2)
        self.write("core/pair.h", '#include "cuda/lanes/kernels.cuh"\n')
        self.assertEqual(self.run_script(self.root), 1)
        self.write("CMakeLists.txt", "add_subdirectory(empty)\n")
        self.assertEqual(self.run_script(self.root), 1)
        self.assertEqual(check_includes.check(self.root, {}), (0, []))


if __name__ == "__main__":
    unittest.main()
