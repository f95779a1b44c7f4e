# SPDX-License-Identifier: Apache-2.0
"""Reads a function's answer about two triangles. `graze try` contains this file too, so it must not need NumPy."""
import numbers
from typing import Any

DISJOINT, INTERSECTS, DECLINED = range(3)  # the library's numbers for verdicts


def verdict_of(answer: Any, function: str) -> int:
    """The verdict of a bool or an int, including NumPy's. Raises TypeError for other answers."""
    kind = type(answer)
    is_bool = kind.__module__ == "numpy" and kind.__name__ in ("bool", "bool_")  # not a numbers.Integral
    if not is_bool and not isinstance(answer, numbers.Integral):
        found = "None" if answer is None else f"a {kind.__name__}"
        raise TypeError(f"{function} returned {found}; return a bool or an int, below 0 for declined")
    return DECLINED if answer < 0 else INTERSECTS if answer else DISJOINT
