# SPDX-License-Identifier: Apache-2.0
"""Pairs, truths and verdicts as NumPy arrays."""
import ctypes
import html
import math
from decimal import Decimal
from typing import Any

import numpy as np

from graze import _library, _program

DISJOINT, INTERSECTS, DECLINED = 0, 1, -1
CONTACTS = ("none", "point", "segment", "area", "unknown")  # indexed by `contact`

_RELATION = np.dtype(
    [(name, np.int8) for name in ("verdict", "contact", "margin_sign", "dimension_a", "dimension_b", "coplanar")]
)


class Pair:
    """Two triangles, made from 18 numbers in a string or an array. `array` holds them as float32, of shape (2, 3, 3). A
    notebook shows the pair in 3-D if the program `graze` is installed.

    >>> touching = Pair("0 0 0  1 0 0  0 1 0   0 0 0  0 0 1  0 1 1")
    >>> touching.relation["contact"] == CONTACTS.index("point")
    True
    >>> touching
    Pair('0 0 0  1 0 0  0 1 0   0 0 0  0 0 1  0 1 1')
    """

    def __init__(self, numbers: Any):
        found = np.array(
            [_float32(word) for word in numbers.split()]
            if isinstance(numbers, str)
            else _library.unmasked(numbers, "pair")
        )
        if found.size != 18:
            raise ValueError(f"a pair has 18 numbers, not {found.size}")
        self.array = np.asarray(found, np.float32).reshape(2, 3, 3)
        if not np.array_equal(self.array.ravel(), found.ravel(), equal_nan=True):
            raise ValueError("a pair's numbers are float32; round them yourself: numpy.asarray(x, numpy.float32)")

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        found = self.array if dtype is None else self.array.astype(dtype)
        return found.copy() if copy else found

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pair) and self.array.tobytes() == other.array.tobytes()

    def __hash__(self) -> int:
        return hash(self.array.tobytes())

    def __str__(self) -> str:
        vertices = [" ".join(_shortest(x) for x in vertex) for vertex in self.array.reshape(6, 3)]
        return "  ".join(vertices[:3]) + "   " + "  ".join(vertices[3:])

    def __repr__(self) -> str:
        return f"Pair('{self}')"

    @property
    def relation(self) -> np.void:
        return relation(self.array)[0]

    def _repr_html_(self) -> str:
        try:
            page = _program.viewer_page(str(self))
        except (FileNotFoundError, RuntimeError) as failure:
            return f"<pre>{html.escape(repr(self))}\n{html.escape(str(failure))}</pre>"
        return f'<iframe srcdoc="{html.escape(page)}" style="width:100%;height:560px;border:0"></iframe>'


def _float32(word: str) -> np.float32:
    """The nearest float32. numpy.float32(word) would round twice, first to a double. Here the first rounding is to odd,
    so that the second is correct (S. Boldo and G. Melquiond, Emulation of FMA and correctly rounded sums: proved
    algorithms using rounding to odd, 2008)."""
    near = float(word)
    if near != 0 and math.isfinite(near) and Decimal(word) != near and np.float64(near).view(np.int64) % 2 == 0:
        near = float(np.nextafter(near, math.inf if Decimal(word) > near else -math.inf))
    with np.errstate(over="ignore"):
        rounded = np.float32(near)
    if np.isinf(rounded) and "inf" not in word.lower():
        raise ValueError(f"a pair's numbers are float32, and {word} is too large for one")
    return rounded


def _shortest(number: np.float32) -> str:
    text = np.format_float_positional(number, trim="-")
    return text if len(text) < 16 else np.format_float_scientific(number, trim="-")


def strata() -> list[str]:
    """The names of all strata (families of pairs), such as "near_edge_edge"."""
    return _library.names("strata")


def lanes() -> list[str]:
    """The names of all lanes that run here, such as "moller_1997/f32/cpu". A policy may be appended: "…/cpu/rel:8"."""
    return _library.names("lanes")


def pairs(strata: str = "*", *, seed: int = 1, count: int = 1000, coordinates: str = "f32") -> np.ndarray:
    """Draws pairs, divided evenly among the strata. They are ordered by stratum, as in strata().

    strata: names with * and ?, separated by commas; "!x" leaves out x. A pair depends only on the seed, its stratum and
    its index in the stratum, and is the same on every machine. coordinates: "f32", or "f64" for doubles, for which
    there are more strata.
    Returns: float32 or float64, shape (count, 2, 3, 3).   Raises: ValueError.
    """
    if coordinates not in ("f32", "f64"):
        raise ValueError(f"coordinates: 'f32' or 'f64' is needed, not {coordinates!r}")
    doubles = ctypes.c_int(coordinates == "f64")
    seed, count = _library.count_of(seed, "seed"), _library.count_of(count, "count")
    names = _library.name_of(strata, "strata")

    def draw(first: int, some: int, to: Any = None) -> None:
        _library.call("pairs", names, *map(ctypes.c_uint64, (seed, count, first, some)), to, doubles)

    draw(0, 0)  # checks the names before memory is allocated
    drawn = np.empty((count, 2, 3, 3), np.float64 if coordinates == "f64" else np.float32)
    _library.in_pieces(count, lambda first, some: draw(first, some, _library.pointer(drawn[first:])))
    return drawn


def _of_elements(function: str, array: np.ndarray, result: np.ndarray, *before: Any, after: tuple = ()) -> np.ndarray:
    """Calls a library function on each piece of the arrays of elements and results."""

    def one(first: int, some: int) -> None:
        arguments = (ctypes.c_uint64(some), _library.pointer(result[first:]))
        _library.call(function, *before, _library.pointer(array[first:]), *after, *arguments)

    _library.in_pieces(len(array), one)
    return result


def _checked(pairs: Any, doubles: bool = True) -> np.ndarray:
    return _library.floats(pairs.array if isinstance(pairs, Pair) else pairs, (2, 3, 3), "pairs", doubles)


def relation(pairs: Any) -> np.ndarray:
    """The exact relation of the triangles of each pair, float32 or float64. Nothing is rounded.

    Returns: a structured array of int8: verdict (1 intersects, 0 disjoint, -1 a coordinate is not finite), contact (an
    index of CONTACTS), margin_sign (1: disjoint; -1: no tiny translation separates them; else 0), dimension_a and
    dimension_b (of the hulls, 0 to 2), coplanar.
    """
    checked = _checked(pairs)
    return _of_elements("relations", checked, np.empty(len(checked), _RELATION), after=(_library.in_doubles(checked),))


def truth(pairs: Any) -> np.ndarray:
    """Whether the triangles of each pair intersect: 1, 0, or -1 where a coordinate is not finite. Exact. int8."""
    return np.ascontiguousarray(relation(pairs)["verdict"])


def margin(pairs: Any) -> np.ndarray:
    """Certified bounds of each pair's margin: the distance between its triangles, or minus the length of the shortest
    translation that separates them. The pairs must be float32.

    Returns: float64, shape (n, 2): at least, at most. NaN where a coordinate is not finite.
    """
    checked = _checked(pairs, doubles=False)
    return _of_elements("margins", checked, np.empty((len(checked), 2)))


def verdicts(lane: str, pairs: Any) -> np.ndarray:
    """The lane's verdict on each pair: 1 intersects, 0 disjoint, -1 declined. int8. CUDA lanes run as twins, which
    replay the kernels on this processor. A float32 lane decides pairs of doubles as a program that stores them in
    float32 would: each coordinate is rounded once.
    Raises: ValueError if there is no such lane, and for doubles if a float64 lane reads only float32."""
    checked = _checked(pairs)
    doubles, name = _library.in_doubles(checked), _library.name_of(lane, "lane")
    return _of_elements("verdicts", checked, np.empty(len(checked), np.int8), name, after=(doubles,))


def _triangles(*arrays: Any) -> list[np.ndarray]:
    """Converts the arguments to arrays of triangles. If one has doubles, all become doubles, which is exact."""
    found = [_library.floats(array, (3, 3), "triangles") for array in arrays]
    doubles = any(array.dtype == np.float64 for array in found)
    return [np.ascontiguousarray(array, np.float64) if doubles else array for array in found]


def meets(reference: Any, triangles: Any) -> np.ndarray:
    """Whether each triangle intersects the reference, of shape (3, 3): 1, 0, or -1 where a coordinate is not finite.
    Exact. int8, shape (n,)."""
    one, many = _triangles(reference, triangles)
    if len(one) != 1:
        raise ValueError(f"reference: one triangle of shape (3, 3) is needed, not {np.shape(reference)}")
    result, doubles = np.empty(len(many), np.int8), _library.in_doubles(many)
    return _of_elements("meets", many, result, _library.pointer(one), after=(doubles,))


def _found(a: np.ndarray, b: "np.ndarray | None", touching: bool) -> np.ndarray:
    count = ctypes.c_uint64()
    indices: list[np.ndarray] = []

    def take() -> None:
        indices.append(np.empty((count.value, 2), np.uint32))
        _library.take(indices[0])

    second = (None, ctypes.c_uint64(0)) if b is None else (_library.pointer(b), ctypes.c_uint64(len(b)))
    first = (_library.pointer(a), ctypes.c_uint64(len(a)))
    arguments = (*first, *second, _library.in_doubles(a), int(not touching), ctypes.byref(count))
    _library.call_in_thread("intersections", *arguments, then=take)
    return indices[0]


def self_intersections(triangles: Any, *, touching: bool = False) -> np.ndarray:
    """The index pairs i < j of triangles of one mesh that pierce each other. Exact. touching: include pairs that only
    touch, such as neighbours.   Returns: uint32, shape (k, 2), sorted."""
    return _found(*_triangles(triangles), None, touching)


def intersections(a: Any, b: Any, *, touching: bool = True) -> np.ndarray:
    """The index pairs of a triangle of `a` and a triangle of `b` that intersect. Exact. touching=False: only those that
    pierce each other.   Returns: uint32, shape (k, 2), sorted."""
    return _found(*_triangles(a, b), touching)
