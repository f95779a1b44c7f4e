# SPDX-License-Identifier: Apache-2.0
"""scripts/audit_explanations accepts explanations of all kinds of pairs, and rejects planted false ones."""
import copy
import json
import os
import subprocess
import sys
import unittest

try:
    from auditing.sentences import audit
except ImportError:  # perhaps only Debian's Python has numpy
    if sys.executable == "/usr/bin/python3":
        raise
    os.execv("/usr/bin/python3", ["/usr/bin/python3", "-B", *sys.argv])

GRAZE = sys.argv.pop(1)
PAIRS = [
    "mixed_scale:77:5496",
    "extreme_scale:77:475",
    "exact_contact:77:184",
    "extreme_scale:77:2932",
    "exact_contact:1:1",
    "coplanar_rounded:1:3",
    "coplanar_rounded:1:10",
    "near_edge_edge:3:100",
    "extreme_scale:1:2280",
    "lattice:1:27",
    "coplanar_lattice:1:3167",
    "near_vertex_vertex:1:5",
    "degenerate:1:4",
    "shared_edge:1:16",
    "shared_edge:21:21",
    # Coordinates around 2^72: in exact arithmetic, the lane's path needs more bits than the path that exact arithmetic
    # itself takes. Also a pair whose cause can be read from its numbers.
    "extreme_scale:1:105",
    "mixed_scale:1:57",
    "extreme_scale:1:46",
]


def explained(pair):
    ran = subprocess.run([GRAZE, "explain", pair, "--json"], capture_output=True, text=True, check=True)
    return json.loads(ran.stdout)


class Audit(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.explained = [explained(pair) for pair in PAIRS]

    def test_every_explanation_holds(self):
        total = {}
        for one in self.explained:
            counts, wrong = audit(one)
            self.assertEqual(wrong, [])
            for what, n in counts.items():
                total[what] = total.get(what, 0) + n
        print(total)
        for what, least in {"sentences": 20, "sets of 1": 20, "sets of 2": 2, "numbers": 15, "bits": 5}.items():
            self.assertGreaterEqual(total.get(what, 0), least, what)

    # Each change makes a true explanation false, for one or more pairs. The audit must report each of these pairs.
    def planted(self, change):
        tried = 0
        for one in self.explained:
            false = copy.deepcopy(one)
            if not change(false):
                continue
            tried += 1
            self.assertNotEqual(audit(false)[1], [], json.dumps(false["sentences"]))
        self.assertGreater(tried, 0)

    def in_sentences(self, old, new):
        def change(one):
            changed = [text.replace(old, new, 1) for text in one["sentences"]]
            differs, one["sentences"] = changed != one["sentences"], changed
            return differs

        self.planted(change)

    def test_another_line_does_not_hold(self):
        self.in_sentences("range.h:32", "range.h:23")
        self.in_sentences("guigue_devillers_2003.h:117 goes", "guigue_devillers_2003.h:121 goes")

    def test_another_verdict_does_not_hold(self):
        self.in_sentences("says disjoint", "says intersects")
        self.in_sentences("meet in a point", "meet in a segment")

    def test_another_cause_does_not_hold(self):
        self.in_sentences(": rounding turns", ": an intermediate result is too large for float32, which turns")

    def test_numbers_that_were_not_compared_do_not_hold(self):
        self.in_sentences(" of exactly 0 into ", " of exactly 1 into ")
        self.in_sentences(" into -", " into ")

    def test_a_comparison_too_many_does_not_hold(self):
        self.in_sentences(
            " goes the wrong way; ",
            " goes the wrong way and, were it right, a later one at core/algorithms/range.h:32; ",
        )

    def test_a_comparison_too_few_does_not_hold(self):
        def change(one):
            for i, text in enumerate(one["sentences"]):
                begin, end = text.find(" and, were it right"), text.rfind("; ")
                if begin >= 0:
                    one["sentences"][i] = text[:begin] + text[end:]
                    return True
            return False

        self.planted(change)

    def test_fewer_bits_do_not_hold(self):
        def change(one):
            for i, text in enumerate(one["sentences"]):
                if " mantissa bits would" in text and "24 mantissa" not in text:
                    bits = text.split(" mantissa bits would")[0].split()[-1]
                    one["sentences"][i] = text.replace(f"{bits} mantissa", f"{int(bits) - 1} mantissa")
                    return True
            return False

        self.planted(change)

    def test_a_later_comparison_that_mends_as_well_is_not_the_first(self):
        def change(one):
            for lane in one["lanes"]:
                if len(lane["deciding"]) == 1:
                    lane["deciding"][0] += 1
                    return True
            return False

        self.planted(change)


if __name__ == "__main__":
    unittest.main()
