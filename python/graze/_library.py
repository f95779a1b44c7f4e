# SPDX-License-Identifier: Apache-2.0
"""Loads the shared library beside this file, and passes arrays and failures through it. ctypes releases the
interpreter's lock during a call."""
import contextlib
import ctypes
import pathlib
import sys
import threading
import time
from typing import Any, Callable, Iterator

import numpy as np

_PIECE = 1 << 18  # elements per call; Python handles Ctrl+C between calls

_library = ctypes.CDLL(str(pathlib.Path(__file__).with_name("libgraze_python.so")))
for _name in ("error", "strata", "lanes", "text"):
    getattr(_library, "graze_py_" + _name).restype = ctypes.c_char_p


class Options(ctypes.Structure):
    _fields_ = [
        ("strata", ctypes.c_char_p),
        ("pairs", ctypes.c_uint64),
        ("seed", ctypes.c_uint64),
        ("max_wrong", ctypes.c_double),
        ("touching", ctypes.c_int),
        ("coplanar", ctypes.c_int),
        ("degenerate", ctypes.c_int),
        ("shared", ctypes.c_int),
    ]


class Result(ctypes.Structure):
    _fields_ = [
        ("passed", ctypes.c_int),
        ("has_smallest", ctypes.c_int),
        ("smallest", ctypes.c_float * 18),
    ]


Decide = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(ctypes.c_float), ctypes.c_uint64, ctypes.POINTER(ctypes.c_uint8))


def call(function: str, *arguments: Any) -> None:
    """Calls graze_py_FUNCTION. Raises ValueError with the library's message, or KeyboardInterrupt if it was stopped."""
    status = getattr(_library, "graze_py_" + function)(*arguments)
    if status == 2:
        raise KeyboardInterrupt
    if status != 0:
        raise ValueError(_library.graze_py_error().decode())


@contextlib.contextmanager
def failures_on_entering(callback: Callable[..., Any], end: Callable[[BaseException], None]) -> Iterator[None]:
    """Passes to end() an exception that a signal handler raises on entry to the callback. ctypes would only print
    it."""
    before = sys.unraisablehook

    def hook(unraisable: Any) -> None:
        if unraisable.object == callback and unraisable.exc_value is not None:
            end(unraisable.exc_value)
        else:
            before(unraisable)

    sys.unraisablehook = hook
    try:
        yield
    finally:
        sys.unraisablehook = before


def call_in_thread(function: str, *arguments: Any, then: Callable[[], None]) -> None:
    """Runs a long call in a separate thread. The function's last argument is a flag that asks it to stop. Ctrl+C sets
    the flag and is raised after the call. `then` runs in the same thread after the call, because the library keeps each
    thread's result separately."""
    stop = ctypes.c_int(0)
    failures: list[BaseException] = []

    def run() -> None:
        try:
            call(function, *arguments, ctypes.byref(stop))
            then()
        except BaseException as failure:  # raised again below, in the caller's thread
            failures.append(failure)

    thread = threading.Thread(target=run)
    try:
        thread.start()
        while thread.is_alive():
            thread.join(0.1)
    except BaseException:
        while thread in threading.enumerate():  # true even before the thread has started
            stop.value = 1
            time.sleep(0.01)
        raise
    if failures:
        raise failures[0]


def take(indices: np.ndarray) -> None:
    _library.graze_py_take(pointer(indices))


def names(what: str) -> list[str]:
    return getattr(_library, "graze_py_" + what)().decode().split()


def text() -> str:
    return _library.graze_py_text().decode()


def pointer(array: np.ndarray) -> ctypes.c_void_p:
    """A pointer to the array's numbers; it keeps the array alive."""
    return array.ctypes.data_as(ctypes.c_void_p)


def in_doubles(array: np.ndarray) -> ctypes.c_int:
    return ctypes.c_int(array.dtype == np.float64)


def in_pieces(count: int, f: Callable[[int, int], None]) -> None:
    """Calls f(first, count) for consecutive pieces. Python handles signals between two calls."""
    for first in range(0, count, _PIECE):
        f(first, min(_PIECE, count - first))


def _masked(array: Any) -> int:
    """How many values are masked, including those in lists of masked arrays."""
    if isinstance(array, np.ma.MaskedArray):
        return int(np.ma.getmaskarray(array).sum())
    return sum(map(_masked, array)) if isinstance(array, (list, tuple)) else 0


def unmasked(array: Any, what: str) -> np.ndarray:
    """The array without its mask. Raises ValueError for masked values, because NumPy would use the hidden values."""
    if masked := _masked(array):
        raise ValueError(f"{what}: masked values ({masked}) are refused; fill them (x.filled) or remove their elements")
    return np.asarray(array)


def floats(array: Any, shape: tuple[int, ...], what: str, doubles: bool = True) -> np.ndarray:
    """Makes a contiguous array of shape (n, *shape); a single element may lack the first axis. The type must be
    float32, or with `doubles` also float64. Does not copy an array that is contiguous already. Raises TypeError for
    other types, which would need rounding, and ValueError for another shape or for masked values."""
    found = unmasked(array, what)
    if found.dtype != np.float32 and not (doubles and found.dtype == np.float64):
        raise TypeError(
            f"{what}: the numbers are {found.dtype}, but Graze decides float32{' and float64' if doubles else ' here'}; "
            "convert them yourself: numpy.asarray(x, numpy.float32)"
        )
    if found.shape == shape:
        found = found[np.newaxis]
    if found.ndim != len(shape) + 1 or found.shape[1:] != shape:
        raise ValueError(f"{what}: the shape is {found.shape}, but (n, {', '.join(map(str, shape))}) is needed")
    return np.require(found, requirements=["C", "ALIGNED"])


def count_of(number: Any, what: str) -> int:
    """Checks that the number is a whole number of 64 bits. Raises ValueError if it is not."""
    try:
        whole = int(number)
        if whole == number and not isinstance(number, (bool, str)) and 0 <= whole < 1 << 64:
            return whole
    except (TypeError, ValueError, OverflowError):
        pass
    raise ValueError(f"{what}: a whole number from 0 to 2^64 - 1 is needed, not {number!r}")


def name_of(name: Any, what: str) -> bytes:
    """The name as bytes for the library. Raises TypeError if it is not a string."""
    if not isinstance(name, str) or "\0" in name:
        raise TypeError(f"{what}: a string is needed, not {name!r}")
    return name.encode()
