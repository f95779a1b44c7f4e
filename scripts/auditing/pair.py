# SPDX-License-Identifier: Apache-2.0
"""The second program's results for a pair: truth, runs, and the comparisons that decide."""
from fractions import Fraction

import numpy as np

from auditing.algorithms import ROOTS, Run, add, cross, dot, sub, times
from auditing.numbers import Real, Root

MOST_DECIDING = 4  # graze::analysis::kMostDeciding


class Audited:
    """This program's results for a pair, computed for each lane on request. Lanes share runs, which are cached."""

    def __init__(self, coordinates):
        self.floats = coordinates
        self.fractions = [Fraction(c) for c in coordinates]
        k = max(f.denominator for f in self.fractions)
        self.integers = [int(f * k) for f in self.fractions]  # both sides of a comparison have the same degree in k
        self.runs, self.outcomes, self.sets = {}, {}, {}
        self.contact, self.distance_squared, corners = contact_and_distance(self.fractions)
        self.inside = inside(self.fractions, self.contact, corners)
        self.truth = "intersects" if self.contact else "disjoint"

    def run(self, name, scalar, rule, lead=()):
        key = name, scalar, rule, lead
        if key not in self.runs:
            self.runs[key] = Run(name, np.float32 if scalar == "f32" else np.float64, self.floats, lead, rule)
        return self.runs[key]

    def exactly(self, name, lead=()):
        """A run in exact arithmetic, on coordinates scaled to integers."""
        if name in ROOTS:
            return Run(name, lambda x: Root(Fraction(x)), self.integers, lead)
        return Run(name, int, self.integers, lead)

    def exact_outcomes(self, name, path):
        if (name, path) not in self.outcomes:
            self.outcomes[name, path] = [s.held for s in self.exactly(name, path).seen]
        return self.outcomes[name, path]

    def exact_seen(self, name, path):
        """The comparisons of an exact run on the unscaled coordinates."""
        return Run(name, lambda x: Root(Fraction(x)), self.fractions, path).seen

    def sized(self, name, scalar, bits=None, upper=False, lower=False, rule="none", lead=()):
        """A run with a mantissa of `bits` bits, with or without the scalar's exponent limits."""
        single = scalar == "f32"

        class Sized(Real):
            pass

        Sized.bits = bits or (24 if single else 53)
        Sized.upper = Fraction(2) ** (128 if single else 1024) if upper else None
        Sized.lower = (-149 if single else -1074) if lower else None
        return Run(name, lambda x: Sized.made(Fraction(x)), self.fractions, lead, rule)

    def deciding(self, name, scalar, rule):
        """The first of the smallest sets of comparisons whose correction gives the truth: the comparisons' numbers, and
        the path to each. None if such a set has more than MOST_DECIDING comparisons."""
        key = name, scalar, rule
        if key not in self.sets:
            for size in range(1, MOST_DECIDING + 1):
                found = self._with(name, scalar, rule, (), 0, size)
                if found is not None:
                    break
            self.sets[key] = found
        return self.sets[key]

    def _with(self, name, scalar, rule, lead, begin, more):
        """Searches depth first for `more` further comparisons from `begin` on, the earliest first."""
        path = self.run(name, scalar, rule, lead).path()
        exact = self.exact_outcomes(name, path)
        for i in range(begin, len(path)):
            if path[i] == exact[i]:
                continue
            corrected = path[:i] + (exact[i],)
            if more == 1:
                if self.verdict(self.run(name, scalar, rule, corrected)) == self.truth:
                    return [(i, path)]
                continue
            rest = self._with(name, scalar, rule, corrected, i + 1, more - 1)
            if rest is not None:
                return [(i, path)] + rest
        return None

    @staticmethod
    def verdict(run):
        return "intersects" if run.intersects else "disjoint"


def solved(rows, right):
    """The solution of a linear system; None if there is no solution or more than one."""
    rows = [list(row) + [value] for row, value in zip(rows, right)]
    n, rank = len(rows[0]) - 1, 0
    for column in range(n):
        pivot = next((i for i in range(rank, len(rows)) if rows[i][column]), None)
        if pivot is None:
            return None
        rows[rank], rows[pivot] = rows[pivot], rows[rank]
        for i in range(len(rows)):
            if i != rank and rows[i][column]:
                factor = rows[i][column] / rows[rank][column]
                rows[i] = [x - factor * y for x, y in zip(rows[i], rows[rank])]
        rank += 1
    if any(row[n] for row in rows[rank:]):
        return None
    return [rows[i][n] / rows[i][i] for i in range(n)]


FACES = [[0], [1], [2], [0, 1], [1, 2], [0, 2], [0, 1, 2]]


def contact_and_distance(c):
    """The dimension of the common set as a word ('' for none), the squared distance, and the corners of the common set:
    the points in which faces of both triangles meet. The distance is that of the affine hulls of two faces."""
    v = [c[i : i + 3] for i in range(0, 18, 3)]
    points, least = [], None
    for f in FACES:
        for g in FACES:
            origin, other = v[f[0]], v[3 + g[0]]
            columns = [sub(v[i], origin) for i in f[1:]] + [sub(other, v[3 + j]) for j in g[1:]]
            gap = sub(other, origin)
            if columns:
                normal = [[dot(p, q) for q in columns] for p in columns]
                t = solved(normal, [dot(p, gap) for p in columns])
            else:
                t = []
            if t is None:
                continue
            s, u = t[: len(f) - 1], t[len(f) - 1 :]
            if min(s + u, default=0) < 0 or sum(s) > 1 or sum(u) > 1:
                continue
            at_a = origin
            for i, share in enumerate(s):
                at_a = add(at_a, times(columns[i], share))
            rest = gap
            for column, share in zip(columns, t):
                rest = sub(rest, times(column, share))
            square = dot(rest, rest)
            least = square if least is None else min(least, square)
            if not square and at_a not in points:
                points.append(at_a)
    if not points:
        return "", least, points
    edges = [sub(p, points[0]) for p in points[1:]]
    if not edges:
        return "point", least, points
    flat = not any(any(cross(edges[0], e)) for e in edges)
    return "segment" if flat else "area", least, points


def inside(c, contact, corners):
    """The words for a triangle that lies in the other; '' if neither does. A triangle lies in the other if all of its
    ends that are in the other's plane are corners of the common set."""
    v = [c[i : i + 3] for i in range(0, 18, 3)]
    triangles = {"a": v[:3], "b": v[3:]}
    normals = {name: cross(sub(t[1], t[0]), sub(t[2], t[0])) for name, t in triangles.items()}
    edges = [sub(p, v[0]) for p in v[1:]]
    crosses = [cross(p, q) for p in edges for q in edges]
    coplanar = not any(dot(n, e) for n in crosses for e in edges)
    if not contact or not coplanar and (contact != "segment" or not all(any(n) for n in normals.values())):
        return ""

    def ends(inner, outer):
        if coplanar:
            return triangles[inner]
        heights = [dot(normals[outer], sub(p, triangles[outer][0])) for p in triangles[inner]]
        found = [p for p, h in zip(triangles[inner], heights) if not h]
        for i, j in ((0, 1), (1, 2), (0, 2)):
            if heights[i] * heights[j] < 0:
                p, q = triangles[inner][i], triangles[inner][j]
                found.append(add(p, times(sub(q, p), heights[i] / (heights[i] - heights[j]))))
        return found

    lies = {(p, q): all(end in corners for end in ends(p, q)) for p, q in (("a", "b"), ("b", "a"))}
    if all(lies.values()):
        return "a and b cover the same points" if coplanar else ""
    for (inner, outer), yes in lies.items():
        if yes:
            return f"{inner} lies inside {outer}, coplanar" if coplanar else f"inside {outer}"
    return ""
