# SPDX-License-Identifier: Apache-2.0
"""The published algorithms, reimplemented from their headers in core/algorithms. Each comparison names its source
line."""
import collections
import pathlib
import re

from auditing.numbers import Fused, outcome, root_of

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


# The source line of a comparison: the only line of the header that contains this text, ignoring the numbers of
# questions and choices.
_sources = {}
NUMBERS = (
    (re.compile(r"At\((Site::\w+), [^)]*\)"), r"\1"),
    (re.compile(r", policy, \d+\)"), ", policy)"),
    (re.compile(r"chosen\(policy, [^,]*, (\w+ [!=]= Real\(0\))\)"), r"\1"),
)


def without_numbers(line):
    for pattern, text in NUMBERS:
        line = pattern.sub(text, line)
    return line


def lines_of(path):
    if path not in _sources:
        _sources[path] = [without_numbers(line) for line in (ROOT / path).read_text().splitlines()]
    return _sources[path]


def at(file, text):
    path = "core/vec3.h" if file == "vec3.h" else "core/algorithms/" + file
    found = [i + 1 for i, line in enumerate(lines_of(path)) if text in line]
    if len(found) != 1:
        raise SystemExit(f"audit_explanations: {path} has {len(found)} lines with '{text}', not one; adapt this script")
    return f"{path}:{found[0]}"


Seen = collections.namedtuple("Seen", "line left relation right held")


class Run:
    """A run of an algorithm with one number type, forced along a path: its comparisons and its verdict."""

    def __init__(self, name, kind, coordinates, lead=(), rule="none"):
        self.rule, self.uses, self.known_uses = rule, [], []
        self._decide(name, kind, coordinates, lead)
        if rule != "none":  # how often a product is used is known only after a whole run
            self.known_uses, self.uses = self.uses, []
            self._decide(name, kind, coordinates, lead)

    def _decide(self, name, kind, coordinates, lead):
        make = (lambda x: Fused(kind(x), self)) if self.rule != "none" else kind
        self.seen, self.lead = [], lead
        self.zero = Fused(kind(0), self, True) if self.rule != "none" else kind(0)
        v = [make(x) for x in coordinates]
        a, b = [v[0:3], v[3:6], v[6:9]], [v[9:12], v[12:15], v[15:18]]
        self.intersects = ALGORITHMS[name](self, a, b)

    def path(self):
        """The outcomes of all comparisons, as the algorithm saw them."""
        return tuple(self.lead) + tuple(s.held for s in self.seen[len(self.lead) :])

    def compare(self, line, left, relation, right):
        held = outcome(left, relation, right)
        i = len(self.seen)
        self.seen.append(Seen(line, left, relation, right, held))
        return self.lead[i] if i < len(self.lead) else held

    def snap(self, x):
        return Fused(x.v, self) if isinstance(x, Fused) else x  # a snapped value is no longer a product


def add(u, v):
    return [u[0] + v[0], u[1] + v[1], u[2] + v[2]]


def sub(u, v):
    return [u[0] - v[0], u[1] - v[1], u[2] - v[2]]


def times(v, s):
    return [v[0] * s, v[1] * s, v[2] * s]


def dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


MAGNITUDE = at("vec3.h", "return x < Real(0) ? -x : x;")
DOMINANT = at("vec3.h", "return x < y ? (y < z ? 2 : 1)")


def dominant_axis(r, v):
    x, y, z = [-c if r.compare(MAGNITUDE, c, "<", r.zero) else c for c in v]
    if r.compare(DOMINANT, x, "<", y):
        return 2 if r.compare(DOMINANT, y, "<", z) else 1
    return 2 if r.compare(DOMINANT, x, "<", z) else 0


def drop(v, axis):
    return [v[1], v[2]] if axis == 0 else [v[0], v[2]] if axis == 1 else [v[0], v[1]]


RANGE_LO = at("range.h", "range.lo = t < range.lo")
RANGE_HI = at("range.h", "range.hi = t > range.hi")
OVERLAP = [at("range.h", f"!policy.less(Site::separation, {high}.hi") for high in "st"]


def project(r, direction, v):
    lo = hi = dot(direction, v[0])
    for i in (1, 2):
        t = dot(direction, v[i])
        if r.compare(RANGE_LO, t, "<", lo):
            lo = t
        if r.compare(RANGE_HI, t, ">", hi):
            hi = t
    return lo, hi


def overlap(r, axis, a, b):
    t = project(r, axis, b)  # g++ evaluates arguments from last to first
    s = project(r, axis, a)
    return not r.compare(OVERLAP[0], s[1], "<", t[0]) and not r.compare(OVERLAP[1], t[1], "<", s[0])


def normalised(v):
    length = root_of(dot(v, v))
    return [v[0] / length, v[1] / length, v[2] / length]


class Plane:
    def __init__(self, r, v):
        self.normal, self.point = cross(sub(v[1], v[0]), sub(v[2], v[0])), v[0]
        self.d = self.distance([r.zero] * 3)

    def distance(self, v):
        return dot(self.normal, sub(v, self.point))


ONE_SIDE = [at("plane.h", "(distance[0] > zero &&"), at("plane.h", "(distance[0] < zero &&")]


def strictly_one_side(r, d):
    return all(r.compare(ONE_SIDE[0], x, ">", r.zero) for x in d) or all(
        r.compare(ONE_SIDE[1], x, "<", r.zero) for x in d
    )


def plane_distances(r, plane, v):
    return [r.snap(plane.distance(x)) for x in v]


def projections_intersect(r, a, b, plane):
    n = normalised(plane.normal)
    pa = [sub(v, times(n, dot(v, n) + plane.d)) for v in a]
    pb = [sub(v, times(n, dot(v, n) + plane.d)) for v in b]
    for i in range(3):
        for p in (pa, pb):
            if not overlap(r, cross(n, sub(p[(i + 1) % 3], p[i])), pa, pb):
                return False
    return True


def projected_sat(r, a, b):
    plane_a = Plane(r, a)
    if strictly_one_side(r, plane_distances(r, plane_a, b)):
        return False
    if strictly_one_side(r, plane_distances(r, Plane(r, b), a)):
        return False
    return projections_intersect(r, a, b, plane_a)


IO = {
    key: at("interval_overlap.h", text)
    for key, text in {
        "denominator": "if (denominator != Real(0))",
        "positive": "if (distance[i] > zero)",
        "negative": "} else if (distance[i] < zero)",
        "difference": "difference == Real(0) ? Real(0)",
        "order": "return t[0] < t[1] ? Range",
        "from": "policy.at_most(Site::separation, range.lo, t)",
        "to": "policy.at_most(Site::separation, t, range.hi)",
        "parallel_0": "policy.snap(Site::parallel, direction.x) == zero",
        "parallel_1": "policy.snap(Site::parallel, direction.y) == zero",
        "parallel_2": "policy.snap(Site::parallel, direction.z) == zero",
    }.items()
}


def vertex_to_put_last(r, d):
    positive = negative = 0
    first_positive = first_negative = first_zero = 2
    for i in (2, 1, 0):
        if r.compare(IO["positive"], d[i], ">", r.zero):
            positive, first_positive = positive + 1, i
        elif r.compare(IO["negative"], d[i], "<", r.zero):
            negative, first_negative = negative + 1, i
        else:
            first_zero = i
    on_line = 3 - positive - negative
    if on_line == 0:
        return first_negative if positive == 2 else first_positive if negative == 2 else 2
    if on_line == 1 and positive == 1 and negative == 1:
        return 0 if first_zero == 2 else 2
    return 2 if on_line == 3 else first_zero


def section(r, point, direction, v, distance):
    last = vertex_to_put_last(r, distance)
    on_line, d = [], []
    for i in range(3):
        source = last if i == 2 else 2 if i == last else i
        on_line.append(add(point, times(direction, dot(direction, sub(v[source], point)))))
        d.append(distance[source])
    t = []
    for i in (0, 1):
        difference = d[i] - d[2]
        share = r.zero if r.compare(IO["difference"], difference, "==", r.zero) else d[i] / difference
        t.append(dot(direction, sub(add(on_line[i], times(sub(on_line[2], on_line[i]), share)), point)))
    return t if r.compare(IO["order"], t[0], "<", t[1]) else [t[1], t[0]]


def contains(r, interval, t):
    return r.compare(IO["from"], interval[0], "<=", t) and r.compare(IO["to"], t, "<=", interval[1])


def interval_overlap(r, a, b):
    plane_a = Plane(r, a)
    distance_b = plane_distances(r, plane_a, b)
    if strictly_one_side(r, distance_b):
        return False
    plane_b = Plane(r, b)
    direction = cross(plane_a.normal, plane_b.normal)
    if all(r.compare(IO[f"parallel_{i}"], r.snap(direction[i]), "==", r.zero) for i in range(3)):
        return projections_intersect(r, a, b, plane_a)
    distance_a = plane_distances(r, plane_b, a)
    if strictly_one_side(r, distance_a):
        return False
    n_dot, p_square, q_square = (
        dot(plane_a.normal, plane_b.normal),
        dot(plane_a.normal, plane_a.normal),
        dot(plane_b.normal, plane_b.normal),
    )
    denominator = n_dot * n_dot - p_square * q_square
    s = t = r.zero
    if not r.compare(IO["denominator"], denominator, "==", r.zero):
        s = (plane_b.d * n_dot - plane_a.d * q_square) / denominator
        t = (plane_a.d * n_dot - plane_b.d * p_square) / denominator
    total = add(times(plane_a.normal, s), times(plane_b.normal, t))
    point, unit = [-total[0], -total[1], -total[2]], normalised(direction)
    sa, sb = section(r, point, unit, a, distance_a), section(r, point, unit, b, distance_b)
    return contains(r, sa, sb[0]) or contains(r, sa, sb[1]) or contains(r, sb, sa[0]) or contains(r, sb, sa[1])


M = {
    key: at("moller_1997.h", text)
    for key, text in {
        "cross": "if ((f > zero && d >= zero && d <= f)",
        "cross_e": "return f > zero ? e >= zero && e <= f",
        "inside": "return d0 * d1 > Real(0)",
        "alone_01": "if (d[0] * d[1] > zero) return 2;",
        "alone_02": "if (d[0] * d[2] > zero) return 1;",
        "alone_12": "if (d[1] * d[2] > zero ||",
        "alone": "return d[1] != zero ? 1",
        "du": "if (du[0] * du[1] > zero",
        "dv": "if (dv[0] * dv[1] > zero",
        "apart_0": "const bool apart = policy.less",
        "apart_1": "policy.less(Site::separation, t0 < t1 ? t1 : t0",
    }.items()
}


def segments_cross(r, p, q, u, s):
    z = r.zero
    ax, ay, bx, by, cx, cy = q[0] - p[0], q[1] - p[1], u[0] - s[0], u[1] - s[1], p[0] - u[0], p[1] - u[1]
    f = ay * bx - ax * by
    d = by * cx - bx * cy
    w, e = M["cross"], M["cross_e"]
    if (r.compare(w, f, ">", z) and r.compare(w, d, ">=", z) and r.compare(w, d, "<=", f)) or (
        r.compare(w, f, "<", z) and r.compare(w, d, "<=", z) and r.compare(w, d, ">=", f)
    ):
        g = ax * cy - ay * cx
        if r.compare(e, f, ">", z):
            return r.compare(e, g, ">=", z) and r.compare(e, g, "<=", f)
        return r.compare(e, g, "<=", z) and r.compare(e, g, ">=", f)
    return False


def line_side(q, s, p):
    a, b = s[1] - q[1], -(s[0] - q[0])
    c = -a * q[0] - b * q[1]
    return a * p[0] + b * p[1] + c


def strictly_inside(r, p, t):
    d0, d1, d2 = line_side(t[0], t[1], p), line_side(t[1], t[2], p), line_side(t[2], t[0], p)
    return r.compare(M["inside"], d0 * d1, ">", r.zero) and r.compare(M["inside"], d0 * d2, ">", r.zero)


def moller_coplanar(r, normal, a, b):
    axis = dominant_axis(r, normal)
    u, v = [drop(x, axis) for x in a], [drop(x, axis) for x in b]
    for i in range(3):
        for j in range(3):
            if segments_cross(r, u[i], u[(i + 1) % 3], v[j], v[(j + 1) % 3]):
                return True
    return strictly_inside(r, u[0], v) or strictly_inside(r, v[0], u)


def alone_vertex(r, d):
    z = r.zero
    if r.compare(M["alone_01"], d[0] * d[1], ">", z):
        return 2
    if r.compare(M["alone_02"], d[0] * d[2], ">", z):
        return 1
    if r.compare(M["alone_12"], d[1] * d[2], ">", z) or not r.compare(M["alone_12"], d[0], "==", z):
        return 0
    if not r.compare(M["alone"], d[1], "==", z):
        return 1
    return 2 if not r.compare(M["alone"], d[2], "==", z) else -1


def section_from(t, d, alone):
    i, j = 1 if alone == 0 else 0, 1 if alone == 2 else 2
    return t[alone], (t[i] - t[alone]) * d[alone], (t[j] - t[alone]) * d[alone], d[alone] - d[i], d[alone] - d[j]


def moller_1997(r, a, b):
    z = r.zero
    n1 = cross(sub(a[1], a[0]), sub(a[2], a[0]))
    d1 = -dot(n1, a[0])
    du = [r.snap(dot(n1, x) + d1) for x in b]
    if r.compare(M["du"], du[0] * du[1], ">", z) and r.compare(M["du"], du[0] * du[2], ">", z):
        return False
    n2 = cross(sub(b[1], b[0]), sub(b[2], b[0]))
    d2 = -dot(n2, b[0])
    dv = [r.snap(dot(n2, x) + d2) for x in a]
    if r.compare(M["dv"], dv[0] * dv[1], ">", z) and r.compare(M["dv"], dv[0] * dv[2], ">", z):
        return False
    axis = dominant_axis(r, cross(n1, n2))
    ta, tb = [x[axis] for x in a], [x[axis] for x in b]
    alone_a, alone_b = alone_vertex(r, dv), alone_vertex(r, du)
    if alone_a < 0 or alone_b < 0:
        return moller_coplanar(r, n1, a, b)
    s_at, s_p, s_q, s_x0, s_x1 = section_from(ta, dv, alone_a)
    t_at, t_p, t_q, t_x0, t_x1 = section_from(tb, du, alone_b)
    xx, yy = s_x0 * s_x1, t_x0 * t_x1
    xxyy = xx * yy
    s_at, t_at = s_at * xxyy, t_at * xxyy
    s0, s1 = s_at + s_p * s_x1 * yy, s_at + s_q * s_x0 * yy
    t0, t1 = t_at + t_p * xx * t_x1, t_at + t_q * xx * t_x0

    def less(line, s_first):  # arguments are evaluated from last to first
        if s_first:
            r_low = t0 if r.compare(line, t0, "<", t1) else t1
            l_high = s1 if r.compare(line, s0, "<", s1) else s0
        else:
            r_low = s0 if r.compare(line, s0, "<", s1) else s1
            l_high = t1 if r.compare(line, t0, "<", t1) else t0
        return r.compare(line, l_high, "<", r_low)

    return not (less(M["apart_0"], True) or less(M["apart_1"], False))


G_TEXT = {
    "c0": "if (d[0] > zero) return d[1] > zero",
    "c1": "if (d[0] < zero) return d[1] < zero",
    "c2": "if (d[1] < zero) return d[2] < zero",
    "c3": "if (d[1] > zero) return d[2] > zero",
    "c4": "return d[2] > zero ? Canonical{2, false}",
    "v0": "if (orient2d(r2, q2, q1, policy) <= zero) {",
    "v1": "if (orient2d(p1, p2, q1, policy) > zero) return orient2d(p1, q2, q1",
    "v2": "return orient2d(p1, p2, r1, policy) >= zero && orient2d(q1, r1, p2",
    "v3": "return orient2d(p1, q2, q1, policy) <= zero && orient2d(r2, q2, r1",
    "v4": "           orient2d(q1, r1, q2, policy) >= zero;",
    "v5": "if (orient2d(r2, p2, r1, policy) < zero) return false;",
    "v6": "if (orient2d(q1, r1, r2, policy) >= zero) return",
    "v7": "return orient2d(q1, r1, q2, policy) >= zero && orient2d(r2, r1, q2",
    "e1": "if (orient2d(p1, p2, q1, policy) >= zero) return orient2d(p1, q1, r2",
    "e2": "return orient2d(q1, r1, p2, policy) >= zero && orient2d(r1, p1, p2",
    "e3": "return orient2d(r2, p2, r1, policy) >= zero && orient2d(p1, p2, r1",
    "e4": "(orient2d(p1, r1, r2, policy) >= zero ||",
    "pq": "const bool left_of_pq",
    "qr": "const bool left_of_qr",
    "rp": "const bool left_of_rp",
    "turn1": "const bool turn1 =",
    "turn2": "const bool turn2 =",
    "da": "if (da[0] * da[1] > zero",
    "db": "if (db[0] * db[1] > zero",
    "first": "dot(q2 - q1, cross(p2 - q1, p1 - q1))) > zero",
    "second": "dot(r2 - p1, cross(p2 - p1, r1 - p1))) > zero",
}
G = {key: at("guigue_devillers_2003.h", text) for key, text in G_TEXT.items()}


def first_lines():
    """`if (orient2d(r2, p2, q1, policy) >= zero) {` is the first line of vertex_region and of edge_region, in this
    order."""
    lines = lines_of("core/algorithms/guigue_devillers_2003.h")
    found = [i + 1 for i, line in enumerate(lines) if "if (orient2d(r2, p2, q1, policy) >= zero) {" in line]
    assert len(found) == 2, found
    return [f"core/algorithms/guigue_devillers_2003.h:{i}" for i in found]


G["vertex"], G["edge"] = first_lines()


def canonical(r, d):
    z = r.zero
    if r.compare(G["c0"], d[0], ">", z):
        return (
            (2, True)
            if r.compare(G["c0"], d[1], ">", z)
            else (1, True)
            if r.compare(G["c0"], d[2], ">", z)
            else (0, False)
        )
    if r.compare(G["c1"], d[0], "<", z):
        return (
            (2, False)
            if r.compare(G["c1"], d[1], "<", z)
            else (1, False)
            if r.compare(G["c1"], d[2], "<", z)
            else (0, True)
        )
    if r.compare(G["c2"], d[1], "<", z):
        return (0, False) if r.compare(G["c2"], d[2], "<", z) else (1, True)
    if r.compare(G["c3"], d[1], ">", z):
        return (0, True) if r.compare(G["c3"], d[2], ">", z) else (1, False)
    return (
        (2, False)
        if r.compare(G["c4"], d[2], ">", z)
        else (2, True)
        if r.compare(G["c4"], d[2], "<", z)
        else (-1, False)
    )


def turn(r, key, p, q, s, relation):
    return r.compare(G[key], r.snap((p[0] - s[0]) * (q[1] - s[1]) - (p[1] - s[1]) * (q[0] - s[0])), relation, r.zero)


def vertex_region(r, p1, q1, r1, p2, q2, r2):
    if turn(r, "vertex", r2, p2, q1, ">="):
        if turn(r, "v0", r2, q2, q1, "<="):
            if turn(r, "v1", p1, p2, q1, ">"):
                return turn(r, "v1", p1, q2, q1, "<=")
            return turn(r, "v2", p1, p2, r1, ">=") and turn(r, "v2", q1, r1, p2, ">=")
        return turn(r, "v3", p1, q2, q1, "<=") and turn(r, "v3", r2, q2, r1, "<=") and turn(r, "v4", q1, r1, q2, ">=")
    if turn(r, "v5", r2, p2, r1, "<"):
        return False
    if turn(r, "v6", q1, r1, r2, ">="):
        return turn(r, "v6", p1, p2, r1, ">=")
    return turn(r, "v7", q1, r1, q2, ">=") and turn(r, "v7", r2, r1, q2, ">=")


def edge_region(r, p1, q1, r1, p2, r2):
    if turn(r, "edge", r2, p2, q1, ">="):
        if turn(r, "e1", p1, p2, q1, ">="):
            return turn(r, "e1", p1, q1, r2, ">=")
        return turn(r, "e2", q1, r1, p2, ">=") and turn(r, "e2", r1, p1, p2, ">=")
    return (
        turn(r, "e3", r2, p2, r1, ">=")
        and turn(r, "e3", p1, p2, r1, ">=")
        and (turn(r, "e4", p1, r1, r2, ">=") or turn(r, "e4", q1, r1, r2, ">="))
    )


def counterclockwise_intersect(r, p1, q1, r1, p2, q2, r2):
    pq, qr, rp = turn(r, "pq", p2, q2, p1, ">="), turn(r, "qr", q2, r2, p1, ">="), turn(r, "rp", r2, p2, p1, ">=")
    if pq and qr:
        return rp or edge_region(r, p1, q1, r1, p2, r2)
    if pq and rp:
        return edge_region(r, p1, q1, r1, r2, q2)
    if qr and rp:
        return edge_region(r, p1, q1, r1, q2, p2)
    if pq:
        return vertex_region(r, p1, q1, r1, p2, q2, r2)
    if qr:
        return vertex_region(r, p1, q1, r1, q2, r2, p2)
    return vertex_region(r, p1, q1, r1, r2, p2, q2)


def guigue_coplanar(r, normal, a, b):
    axis = dominant_axis(r, normal)
    (p1, q1, r1), (p2, q2, r2) = [drop(x, axis) for x in a], [drop(x, axis) for x in b]
    turn1, turn2 = turn(r, "turn1", p1, q1, r1, "<"), turn(r, "turn2", p2, q2, r2, "<")
    return counterclockwise_intersect(
        r, p1, r1 if turn1 else q1, q1 if turn1 else r1, p2, r2 if turn2 else q2, q2 if turn2 else r2
    )


def guigue_devillers_2003(r, a, b):
    z = r.zero
    n2 = cross(sub(b[0], b[2]), sub(b[1], b[2]))
    da = [r.snap(dot(sub(x, b[2]), n2)) for x in a]
    if r.compare(G["da"], da[0] * da[1], ">", z) and r.compare(G["da"], da[0] * da[2], ">", z):
        return False
    n1 = cross(sub(a[1], a[0]), sub(a[2], a[0]))
    db = [r.snap(dot(sub(x, a[2]), n1)) for x in b]
    if r.compare(G["db"], db[0] * db[1], ">", z) and r.compare(G["db"], db[0] * db[2], ">", z):
        return False
    first_a, flip_a = canonical(r, da)
    if first_a < 0:
        return guigue_coplanar(r, n1, a, b)
    ib = [0, 2, 1] if flip_a else [0, 1, 2]
    first_b, flip_b = canonical(r, [db[i] for i in ib])
    if first_b < 0:
        return guigue_coplanar(r, n1, a, b)
    p1, q1, r1 = a[first_a], a[(first_a + (2 if flip_b else 1)) % 3], a[(first_a + (1 if flip_b else 2)) % 3]
    p2, q2, r2 = b[ib[first_b]], b[ib[(first_b + 1) % 3]], b[ib[(first_b + 2) % 3]]
    if r.compare(G["first"], r.snap(dot(sub(q2, q1), cross(sub(p2, q1), sub(p1, q1)))), ">", z):
        return False
    return not r.compare(G["second"], r.snap(dot(sub(r2, p1), cross(sub(p2, p1), sub(r1, p1)))), ">", z)


def separating_axes(r, a, b):
    ea, eb = [sub(a[1], a[0]), sub(a[2], a[1]), sub(a[0], a[2])], [sub(b[1], b[0]), sub(b[2], b[1]), sub(b[0], b[2])]
    na, nb = cross(ea[0], ea[1]), cross(eb[0], eb[1])

    def separates(axis):
        return not overlap(r, axis, a, b)

    if separates(na) or separates(nb):
        return False
    if any(separates(cross(e, f)) for e in ea for f in eb):
        return False
    return not any(separates(cross(na, ea[i])) or separates(cross(nb, eb[i])) for i in range(3))


ALGORITHMS = {
    f.__name__: f for f in (projected_sat, interval_overlap, moller_1997, guigue_devillers_2003, separating_axes)
}
ROOTS = ("projected_sat", "interval_overlap")
