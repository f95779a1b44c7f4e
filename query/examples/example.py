#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds which of a million random triangles of the 2012 thesis meet its reference. Uses the C library through ctypes,
and numpy if it is installed.
  example.py libgraze_query.so
"""
import array
import ctypes
import random
import sys

try:
    import numpy
except ImportError:
    numpy = None


class Triangles(ctypes.Structure):
    _fields_ = [
        ("count", ctypes.c_uint64),
        ("layout", ctypes.c_int),
        ("device", ctypes.c_int),
        ("rows", ctypes.c_void_p),
        ("columns", ctypes.c_void_p * 9),
        ("vertices", ctypes.c_void_p),
        ("faces", ctypes.c_void_p),
        ("vertex_count", ctypes.c_uint64),
        ("stride", ctypes.c_size_t),
        ("vertex_stride", ctypes.c_size_t),
    ]


class Query(ctypes.Structure):
    _fields_ = [
        ("size", ctypes.c_size_t),
        ("references", ctypes.c_void_p),
        ("reference_count", ctypes.c_uint64),
        ("parts", ctypes.POINTER(Triangles)),
        ("part_count", ctypes.c_uint64),
        ("mode", ctypes.c_int),
        ("executor", ctypes.c_int),
        ("lane", ctypes.c_char_p),
        ("bytes", ctypes.c_void_p),
        ("bits", ctypes.c_void_p),
        ("list", ctypes.c_void_p),
        ("list_room", ctypes.c_uint64),
        ("outputs_on_device", ctypes.c_int),
        ("coordinates", ctypes.c_int),
        ("stream", ctypes.c_void_p),
        ("launch_seconds", ctypes.c_double),
        ("progress", ctypes.c_void_p),
        ("user", ctypes.c_void_p),
    ]


class Answer(ctypes.Structure):
    _fields_ = [
        ("status", ctypes.c_int),
        ("message", ctypes.c_char * 200),
        ("position", ctypes.c_uint64),
        ("triangles", ctypes.c_uint64),
        ("hits", ctypes.c_uint64),
        ("declined", ctypes.c_uint64),
        ("first", ctypes.c_uint64),
        ("first_reference", ctypes.c_uint64),
        ("executor", ctypes.c_int),
        ("seconds", ctypes.c_double),
        ("longest_launch", ctypes.c_double),
    ]


ALL = 1


def address(numbers):
    return numbers.ctypes.data if numpy is not None and isinstance(numbers, numpy.ndarray) else numbers.buffer_info()[0]


def which(library, reference, rows, count, lane=None):
    """Returns: a byte for each triangle (1: meets the reference, 0: does not, 2: declined), and the answer."""
    meets = numpy.zeros(count, numpy.uint8) if numpy is not None else array.array("B", bytes(count))
    part = Triangles(count=count, device=-1, rows=address(rows))
    query = Query(
        size=ctypes.sizeof(Query),
        references=address(reference),
        reference_count=1,
        parts=ctypes.pointer(part),
        part_count=1,
        mode=ALL,
        lane=lane,
        bytes=address(meets),
    )
    answer = Answer()
    library.graze_open.restype = ctypes.c_void_p
    context = ctypes.c_void_p(library.graze_open())
    library.graze_run(context, ctypes.byref(query), ctypes.byref(answer))
    library.graze_close(context)
    if answer.status != 0:
        raise RuntimeError(f"after {answer.position} triangles: {answer.message.decode()}")
    return meets, answer


def random_triangles(count):
    if numpy is not None:
        draw = numpy.random.default_rng(2012)
        base = draw.integers(-40, 40, (count, 1, 3)).astype(numpy.float32) / numpy.float32(10)
        return (base + draw.integers(0, 5, (count, 3, 3)).astype(numpy.float32)).reshape(count, 9)
    draw = random.Random(2012)
    rows = array.array("f")
    for _ in range(count):
        base = [draw.randrange(-40, 40) / 10 for _ in range(3)]
        rows.extend(base[k % 3] + draw.randrange(5) for k in range(9))
    return rows


def main():
    library = ctypes.CDLL(sys.argv[1])
    count = 1_000_000 if numpy is not None else 50_000
    rows = random_triangles(count)
    reference = array.array("f", [2, -2, 4, 1, 5, -2, 1, -3, -3])
    exact, answer = which(library, reference, rows, count)
    floats, _ = which(library, reference, rows, count, b"interval_overlap/f32/cpu")
    wrong = sum(1 for e, f in zip(exact, floats) if e != f)
    share = answer.hits / count
    print(f"{100 * share:.0f} % meet the reference; float32 is wrong on {wrong} of {count}")
    try:
        which(library, reference, rows, count, b"nosuch")
        return 1
    except RuntimeError as error:
        print(error)
    return 0 if sum(1 for e in exact if e == 1) == answer.hits and 0.1 < share < 0.12 else 1


if __name__ == "__main__":
    sys.exit(main())
