# SPDX-License-Identifier: Apache-2.0
"""Pairs of triangles that are hard to decide, and the exact answers.

A pair is two triangles of three vertices x y z: a float32 or float64 array of shape (2, 3, 3). Many pairs are one
array of shape (n, 2, 3, 3). A triangle is the closed hull of its vertices, so touching counts as intersecting.

>>> import graze
>>> pairs = graze.pairs("near_edge_edge", seed=1, count=1000)
>>> pairs.shape, pairs.dtype
((1000, 2, 3, 3), dtype('float32'))
>>> right = graze.truth(pairs)
>>> wrong = graze.verdicts("moller_1997/f32/cpu", pairs) != right
>>> 0 < wrong.sum() < 1000
True
"""
from graze._arrays import (
    CONTACTS,
    DECLINED,
    DISJOINT,
    INTERSECTS,
    Pair,
    intersections,
    lanes,
    margin,
    meets,
    pairs,
    relation,
    self_intersections,
    strata,
    truth,
    verdicts,
)
from graze._given import example, given
from graze._program import campaign

__all__ = [
    "CONTACTS",
    "DECLINED",
    "DISJOINT",
    "INTERSECTS",
    "Pair",
    "campaign",
    "example",
    "given",
    "intersections",
    "lanes",
    "margin",
    "meets",
    "pairs",
    "relation",
    "self_intersections",
    "strata",
    "truth",
    "verdicts",
]
