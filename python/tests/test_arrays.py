# SPDX-License-Identifier: Apache-2.0
"""Compares the array functions with the program `graze` and with fractions, and tests invalid arguments."""
import csv
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
import weakref
from fractions import Fraction

import graze
import numpy as np


def dumped(stratum):
    """Returns: the rows that `graze dump` prints for 40 pairs of the stratum, and their coordinates."""
    words = [os.environ["GRAZE"], "dump", stratum + ":3", "--pairs", "40"]
    table = csv.DictReader(subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines())
    rows = list(table)
    columns = [name for name in table.fieldnames if re.fullmatch("[ab][0-2][xyz]", name)]
    return rows, np.array([[row[name] for name in columns] for row in rows], float)


class Arrays(unittest.TestCase):
    def test_pairs_truths_and_contacts_are_those_of_the_program(self):
        for stratum in graze.strata():
            rows, known = dumped(stratum)
            self.assertEqual(len(rows), 40)
            drawn = graze.pairs(stratum, seed=3, count=40)
            self.assertEqual(known.astype(np.float32).tobytes(), drawn.tobytes(), stratum)
            relation = graze.relation(drawn)
            self.assertEqual([row["truth"] == "intersects" for row in rows], (relation["verdict"] == 1).tolist())
            self.assertEqual([row["contact"] for row in rows], [graze.CONTACTS[c] for c in relation["contact"]])
            said = np.array([float(row["margin"]) for row in rows])  # read as a double, which rounds once more
            least, most = graze.margin(drawn).T
            slack = 1e-14 * np.abs(said)
            self.assertTrue(((least <= said + slack) & (said - slack <= most)).all(), stratum)

    def test_doubles_are_those_of_the_program(self):
        for stratum in ("near_edge_edge", "large_offset", "stored", "mixed_scale"):
            rows, known = dumped(stratum + "/f64")
            drawn = graze.pairs(stratum, seed=3, count=40, coordinates="f64")
            self.assertEqual((drawn.dtype, known.tobytes()), (np.float64, drawn.tobytes()), stratum)
            relation = graze.relation(drawn)
            self.assertEqual([row["truth"] == "intersects" for row in rows], (relation["verdict"] == 1).tolist())
            self.assertEqual([row["contact"] for row in rows], [graze.CONTACTS[c] for c in relation["contact"]])

    def test_truth_of_doubles_is_that_of_fractions(self):
        drawn = graze.pairs("decimal_born,lattice_15,large_offset,stored,degenerate", count=300, coordinates="f64")
        said = graze.truth(drawn)
        self.assertTrue(50 < said.sum() < 250)
        for pair, verdict in zip(drawn, said):
            self.assertEqual(verdict, intersect(pair), pair)

    def test_verdicts_on_doubles(self):
        drawn = graze.pairs("stored,near_*", count=6000, coordinates="f64")
        right, stored = graze.truth(drawn), graze.truth(drawn.astype(np.float32))
        self.assertTrue((right != stored).sum() > 900)
        for lane, expected in (("exact/f64/cpu", right), ("exact/f32/cpu", stored)):
            self.assertTrue((graze.verdicts(lane, drawn) == expected).all(), lane)
        for lane in ("moller_1997/f32/cpu", "moller_1997/f32/cuda-fma"):
            of_stored = graze.verdicts(lane, drawn.astype(np.float32))
            self.assertTrue((graze.verdicts(lane, drawn) == of_stored).all(), lane)
        for lane in (
            "moller_1997/f64/cuda-nofma",
            "separating_axes/f64/cuda-nofma",
            "moller_1997/f64/cuda-nofma/rel:9",
        ):
            of_cpu = graze.verdicts(lane.replace("cuda-nofma", "cpu"), drawn)
            self.assertTrue((graze.verdicts(lane, drawn) == of_cpu).all(), lane)
        wrong = {
            lane: (graze.verdicts(f"moller_1997/{lane}", drawn) != right).mean() for lane in ("f32/cpu", "f64/cpu")
        }
        self.assertTrue(0 < wrong["f64/cpu"] < wrong["f32/cpu"], wrong)

    def test_meshes_of_doubles(self):
        near, far = graze.pairs("large_offset,stored,uniform", count=90, coordinates="f64")[:, :, :, :].swapaxes(0, 1)
        expected = [(i, j) for i in range(90) for j in np.flatnonzero(graze.meets(near[i], far) == 1)]
        for i in range(0, 90, 7):
            pairs = np.stack([np.broadcast_to(near[i], far.shape), far], 1)
            self.assertEqual(graze.meets(near[i], far).tolist(), graze.truth(pairs).tolist())
        self.assertEqual([tuple(row) for row in graze.intersections(near, far)], expected)
        self.assertNotEqual(graze.intersections(near.astype(np.float32), far.astype(np.float32)).tolist(), expected)
        walls = np.array([[[x, 0, 0], [x, 1, 0], [x, 0, 1]] for x in (1000000.01, 1000000.02)])
        self.assertEqual(len(graze.self_intersections(walls, touching=True)), 0)
        self.assertEqual(len(graze.self_intersections(walls.astype(np.float32))), 1)
        huge = walls * 1e300
        self.assertEqual(graze.self_intersections(np.concatenate([huge, huge])).tolist(), [[0, 2], [1, 3]])
        mixed = graze.intersections(walls, walls.astype(np.float32))
        self.assertEqual(len(mixed), 0)

    def test_a_range_of_pairs_does_not_depend_on_the_pieces(self):
        piece = graze._library._PIECE
        whole = graze.pairs("uniform,lattice", count=1000)
        try:
            graze._library._PIECE = 7
            self.assertEqual(graze.pairs("uniform,lattice", count=1000).tobytes(), whole.tobytes())
            self.assertEqual(graze.margin(whole).shape, (1000, 2))
        finally:
            graze._library._PIECE = piece

    def test_truth_is_that_of_fractions(self):
        """Compares the truth with linear programming in fractions, on triangles with small integer coordinates."""
        drawn = graze.pairs("lattice,coplanar_lattice,degenerate", count=600)
        said = graze.truth(drawn)
        self.assertTrue(0 < said.sum() < 600)
        for pair, verdict in zip(drawn, said):
            self.assertEqual(verdict, intersect(pair), graze.Pair(pair))

    def test_text_is_rounded_once(self):
        middle, beyond = "1.00000005960464477539062500000", "1.00000005960464477539062500001"  # 1 and half an ulp
        smallest = "0." + str(5**150).zfill(150)  # 2^-150, half the smallest float32
        words = [
            middle,
            beyond,
            "-" + beyond,
            "1e-400",
            "1e-99999999999999999999",
            smallest,
            smallest + "1",
            "inf",
            "0.1",
        ]
        expected = [1, 1 + 2**-23, -1 - 2**-23, 0, 0, 0, 2**-149, np.inf, np.float32(0.1)]
        found = graze.Pair(" ".join(words + ["0"] * 9)).array.ravel()
        self.assertEqual(found[:9].tolist(), [float(x) for x in expected])

    def test_relations(self):
        same = graze.Pair("0 0 0  1 0 0  0 1 0   0 0 0  1 0 0  0 1 0").relation
        self.assertEqual(graze.CONTACTS[same["contact"]], "area")
        self.assertEqual((same["verdict"], same["margin_sign"], same["coplanar"], same["dimension_a"]), (1, 0, 1, 2))
        point = graze.Pair("0 0 0  0 0 0  0 0 0   0 0 1  1 0 1  0 1 1")
        self.assertEqual((point.relation["verdict"], point.relation["dimension_a"]), (0, 0))
        least, most = graze.margin(point.array)[0]
        self.assertTrue(least <= 1 <= most and most - least < 1e-12)
        self.assertTrue(np.isnan(graze.margin(point.array * np.float32(np.nan))).all())

    def test_exact_lanes_and_twins(self):
        drawn = graze.pairs("near_*", count=20000)
        right = graze.truth(drawn)
        self.assertTrue((graze.verdicts("exact/f32/cpu", drawn) == right).all())
        for lane in ("moller_1997/f32/cpu", "moller_1997/f32/cuda-fma", "moller_1997/f32/cpu/rel:24"):
            wrong = (graze.verdicts(lane, drawn) != right).mean()
            self.assertTrue(0.01 < wrong < 0.9, (lane, wrong))
        self.assertIn("moller_1997/f32/cpu", graze.lanes())

    def test_meshes(self):
        triangles = graze.pairs("near_*,exact_contact", count=60)[:, 0]
        others = graze.pairs("uniform,thesis", count=60)[:, 1]
        for touching in (False, True):
            expected = []
            for i, first in enumerate(triangles):
                at = graze.relation(np.stack([np.broadcast_to(first, others.shape), others], 1))
                only_touch = (at["margin_sign"] == 0) & (at["contact"] != graze.CONTACTS.index("area"))
                expected += [(i, j) for j in np.flatnonzero((at["verdict"] == 1) & (touching | ~only_touch))]
                self.assertTrue((graze.meets(first, others) == at["verdict"]).all())
            found = graze.intersections(triangles, others, touching=touching)
            self.assertTrue(len(expected) > 20)
            self.assertEqual([tuple(row) for row in found], expected)
        both = graze.self_intersections(np.concatenate([triangles, triangles]), touching=True)
        self.assertTrue(set(zip(range(60), range(60, 120))) <= {tuple(row) for row in both})
        self.assertTrue((both[:, 0] < both[:, 1]).all())

    def test_no_copies_of_contiguous_arrays(self):
        drawn = graze.pairs(count=10)
        self.assertTrue(np.shares_memory(graze._library.floats(drawn, (2, 3, 3), ""), drawn))
        pair = graze.Pair(drawn[0])
        self.assertFalse(np.shares_memory(np.array(pair), pair.array))
        self.assertFalse(np.shares_memory(pair.array, drawn))
        turned = np.asfortranarray(drawn)
        self.assertEqual(graze.truth(turned).tolist(), graze.truth(drawn).tolist())
        drawn.flags.writeable = False
        self.assertEqual(len(graze.truth(drawn)), 10)

    def test_wrong_arguments(self):
        drawn = graze.pairs(count=10)
        for error, words, call in (
            (TypeError, "int64", lambda: graze.truth(drawn.astype(np.int64))),
            (TypeError, "float16", lambda: graze.meets(drawn[0, 0].astype(np.float16), drawn[:, 1])),
            (TypeError, "float64", lambda: graze.margin(drawn.astype(float))),
            (ValueError, "coordinates", lambda: graze.pairs(coordinates="f16")),
            (ValueError, "large_offset", lambda: graze.pairs("large_offset")),
            (ValueError, r"\(n, 2, 3, 3\)", lambda: graze.truth(drawn[0, 0])),
            (ValueError, "no_such", lambda: graze.pairs("no_such")),
            (ValueError, "seed", lambda: graze.pairs(seed=-1)),
            (ValueError, "count", lambda: graze.pairs(count=1.5)),
            (ValueError, "count", lambda: graze.pairs(count=None)),
            ((MemoryError, ValueError), "", lambda: graze.pairs(count=1 << 60)),
            (TypeError, "strata", lambda: graze.pairs(["uniform"])),
            (TypeError, "lane", lambda: graze.verdicts("exact/f32/cpu\0", drawn)),
            (ValueError, "18 numbers", lambda: graze.Pair("1 2 3")),
            (ValueError, "float32", lambda: graze.Pair([0.1] * 18)),
            (ValueError, "1e39", lambda: graze.Pair("1e39" + " 0" * 17)),
            (ValueError, "1e400", lambda: graze.Pair("1e400" + " 0" * 17)),
            (ValueError, "no lane", lambda: graze.verdicts("no/f32/cpu", drawn)),
            (ValueError, "no lane", lambda: graze.verdicts("exact/f32/cpu/rel:1", drawn)),
            (ValueError, "no twin", lambda: graze.verdicts("moller_1997/f32/cuda-fma/bound", drawn)),
            (ValueError, "policy", lambda: graze.verdicts("moller_1997/f32/cpu/rel:x", drawn)),
            (ValueError, "reference", lambda: graze.meets(drawn[:, 0], drawn[:, 1])),
            (ValueError, "either", lambda: graze.given(either="sometimes")),
        ):
            with self.assertRaisesRegex(error, words):
                call()
        records = np.zeros(4, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]))
        records["corners"] = drawn[:4, 0]
        self.assertTrue(
            (graze.meets(records["corners"][1], records["corners"]) == graze.meets(drawn[1, 0], drawn[:4, 0])).all()
        )
        for empty in (drawn[:0], np.empty((0, 2, 3, 3), np.float32)):
            self.assertEqual(len(graze.truth(empty)), 0)
        self.assertEqual(len(graze.self_intersections(drawn[:0, 0])), 0)
        infinite = np.full((2, 2, 3, 3), np.inf, np.float32)
        self.assertEqual(graze.truth(infinite).tolist(), [graze.DECLINED] * 2)
        self.assertEqual(len(graze.self_intersections(infinite[:, 0])), 0)

    def test_masked_values_are_refused(self):
        drawn = graze.pairs(count=10)
        whole = np.ma.masked_array(drawn, mask=False)
        self.assertEqual(graze.truth(whole).tolist(), graze.truth(drawn).tolist())
        some = whole.copy()
        some[3, 1, 2, 0] = some[4, 0] = np.ma.masked
        one = some[3]
        for what, count, call in (
            ("pairs", 10, lambda: graze.truth(some)),
            ("pairs", 10, lambda: graze.verdicts("exact/f32/cpu", some)),
            ("pairs", 10, lambda: graze.margin(some)),
            ("pairs", 1, lambda: graze.truth([[drawn[0, 0], drawn[0, 1]], [one[0], one[1]]])),
            ("pair", 1, lambda: graze.Pair(one)),
            ("triangles", 9, lambda: graze.meets(drawn[0, 0], some[:, 0])),
            ("triangles", 1, lambda: graze.meets(one[1], drawn[:, 0])),
            ("triangles", 9, lambda: graze.self_intersections(some[:, 0])),
            ("triangles", 1, lambda: graze.intersections(drawn[:, 0], some[:, 1])),
        ):
            with self.assertRaisesRegex(ValueError, rf"^{what}: masked values \({count}\)"):
                call()

    def test_ctrl_c_ends_long_calls(self):
        for call in (
            "graze.pairs(count=10**8)",
            "graze.self_intersections(graze.pairs(count=60000).reshape(-1, 3, 3), touching=True)",
            "graze.given(pairs=10**9)(lambda a, b: True)()",
        ):
            code = f"import graze\nprint('begun', flush=True)\n{call}"
            with subprocess.Popen(
                [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
            ) as process:
                self.assertEqual(process.stdout.readline(), "begun\n")
                time.sleep(0.3)
                process.send_signal(signal.SIGINT)
                self.assertIn("KeyboardInterrupt", process.communicate(timeout=120)[1], call)

    def test_ctrl_c_while_a_search_begins_ends_it(self):
        triangles = graze.pairs(count=20000).reshape(-1, 3, 3)

        class Interrupted(threading.Thread):
            def start(self):
                super().start()
                raise KeyboardInterrupt

        threads = threading.active_count()
        with unittest.mock.patch("threading.Thread", Interrupted), self.assertRaises(KeyboardInterrupt):
            graze.self_intersections(triangles, touching=True)
        self.assertEqual(threading.active_count(), threads)
        self.assertGreater(len(graze.self_intersections(triangles[:2].repeat(2, axis=0), touching=True)), 0)

    def test_an_interrupted_search_leaves_others_alone(self):
        triangles = graze.pairs(count=3000).reshape(-1, 3, 3)
        expected = graze.self_intersections(triangles, touching=True)
        others: list = []

        def search():
            others.append(graze.self_intersections(triangles, touching=True))

        caller = threading.current_thread()

        class Interrupted(threading.Thread):
            def join(self, timeout=None):
                if threading.current_thread() is caller:
                    raise KeyboardInterrupt
                super().join(timeout)

        threads = [threading.Thread(target=search) for _ in range(8)]
        for thread in threads:
            thread.start()
        with unittest.mock.patch("threading.Thread", Interrupted), self.assertRaises(KeyboardInterrupt):
            graze.self_intersections(graze.pairs(count=20000).reshape(-1, 3, 3), touching=True)
        for thread in threads:
            thread.join()
        self.assertEqual([len(found) for found in others], [len(expected)] * 8)

    def test_arrays_live_as_long_as_their_address(self):
        array = np.zeros(3, np.float32)
        freed = []
        weakref.finalize(array, freed.append, True)
        address = graze._library.pointer(array)
        del array
        self.assertEqual(freed, [])
        del address
        self.assertEqual(freed, [True])

    def test_campaign_and_drawing(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "near"
            summary = graze.campaign(out, pairs=300, strata="near_edge_edge", lanes="moller_1997/f32/cpu")
            self.assertEqual(summary["strata"]["near_edge_edge"]["pairs"], 300)
            with self.assertRaisesRegex(RuntimeError, "no_such"):
                graze.campaign(out, strata="no_such")
            with self.assertRaisesRegex(ValueError, "graze merge"):
                graze.campaign(out, shard="1/2")
        pair = graze.Pair("0 0 0  1 0 0  0 1 0   0 0 0  0 0 1  0 1 1")
        program = os.environ["GRAZE"]
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "pair.txt"
            file.write_text(str(pair), encoding="utf-8")
            viewer = subprocess.run([program, "view", file, "--out", file.with_suffix(".html")], capture_output=True)
        self.assertIn("<iframe srcdoc=" if viewer.returncode == 0 else "<pre>Pair", pair._repr_html_())
        del os.environ["GRAZE"]
        path, os.environ["PATH"] = os.environ["PATH"], folder
        try:
            self.assertIn("<pre>Pair", pair._repr_html_())
        finally:
            os.environ.update(GRAZE=program, PATH=path)


def intersect(pair):
    """Whether the hulls of two triangles have a common point, by linear programming in fractions: 0 lies in the hull of
    the differences of their vertices."""
    points = [tuple(Fraction(float(x)) - Fraction(float(y)) for x, y in zip(p, q)) for p in pair[0] for q in pair[1]]
    return int(holds_origin(points))


def holds_origin(points):
    """Whether the hull of the points contains 0. It does not if all points lie strictly on one side of a plane through
    0. If all points lie on one side or in the plane, those in the plane decide, in one dimension less."""
    points = list(dict.fromkeys(points))
    if any(all(x == 0 for x in p) for p in points):
        return True
    if not points:
        return False
    if len(points[0]) == 1:
        return min(p[0] for p in points) < 0 < max(p[0] for p in points)
    for normal in normals(points):
        sides = [sum(n * x for n, x in zip(normal, p)) for p in points]
        for sign in (1, -1):
            if all(sign * s >= 0 for s in sides):
                return holds_origin(flattened([p for p, s in zip(points, sides) if s == 0], normal))
    return True


def normals(points):
    """Normals of the planes through 0 that points and axes span. They include every plane that supports the hull."""
    size = len(points[0])
    axes = [tuple(Fraction(int(i == k)) for i in range(size)) for k in range(size)]
    spanning = points + axes
    if size == 2:
        return [(-p[1], p[0]) for p in spanning]
    crosses = []
    for i, p in enumerate(spanning):
        for q in spanning[:i]:
            n = (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])
            if any(n):
                crosses.append(n)
    return crosses


def flattened(points, normal):
    """Projects points of a plane: drops a coordinate in which the plane's normal is not 0."""
    drop = next(k for k, n in enumerate(normal) if n)
    return [p[:drop] + p[drop + 1 :] for p in points]


if __name__ == "__main__":
    unittest.main()
