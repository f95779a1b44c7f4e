#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Calls the C ABI with numbers that no real array has. Each call must return GRAZE_BAD_ARGUMENT, and none may crash.
  hostile_numbers.test.py libgraze_query.so FOLDER_OF_EXAMPLE.PY
"""
import array
import ctypes
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, sys.argv[2])
import example  # noqa: E402

OK, BAD_ARGUMENT = 0, 1
ROWS, COLUMNS, MESH = 0, 1, 2
SIZE_MAX = ctypes.c_size_t(-1).value
COUNT = 10

library = ctypes.CDLL(sys.argv[1])
library.graze_open.restype = ctypes.c_void_p
context = ctypes.c_void_p(library.graze_open())
reference = array.array("f", [0, 0, 0, 4, 0, 0, 0, 4, 0])
rows = array.array("f", [1, 1, -1, 1, 1, 1, 2, 1, 1] * COUNT)
faces = array.array("I", range(3 * COUNT))


def ask(part=(), **changes):
    """Returns: status and hits of a query with these changes. Without changes, all ten triangles meet the reference."""
    fields = dict(
        count=COUNT,
        device=-1,
        rows=example.address(rows),
        vertices=example.address(rows),
        faces=example.address(faces),
        vertex_count=3 * COUNT,
    )
    fields.update(part)
    columns = [example.address(rows) + 4 * k for k in range(9)]
    triangles = example.Triangles(columns=(ctypes.c_void_p * 9)(*columns), **fields)
    values = dict(
        size=ctypes.sizeof(example.Query),
        references=example.address(reference),
        reference_count=1,
        parts=ctypes.pointer(triangles),
        part_count=1,
        mode=example.ALL,
    )
    values.update(changes)
    answer = example.Answer()
    status = library.graze_run(context, ctypes.byref(example.Query(**values)), ctypes.byref(answer))
    assert status == answer.status and bool(answer.message) == (status != OK), answer.message
    return status, answer.hits


refused = 0


def refuse(part=(), **changes):
    global refused
    status, _ = ask(part, **changes)
    assert status == BAD_ARGUMENT, (status, part, changes)
    refused += 1


for layout, size in ((ROWS, 36), (COLUMNS, 4), (MESH, 12)):
    right = 36 if layout == COLUMNS else 0
    assert ask({"layout": layout, "stride": right}) == (OK, COUNT), layout
    for stride in (1, size - 1, 35, SIZE_MAX, SIZE_MAX - 35, SIZE_MAX - 3, 1 << 62, (SIZE_MAX // (COUNT - 1) + 1) & ~3):
        refuse({"layout": layout, "stride": stride})
    for count in (SIZE_MAX, (1 << 48) + 1):
        refuse({"layout": layout, "count": count})
    refuse({"layout": layout, "count": 1 << 48, "stride": 1 << 16})
    refuse({"layout": layout, "count": 0, "stride": 37})
for stride in (1, 11, SIZE_MAX, SIZE_MAX - 11, 1 << 62):
    refuse({"layout": MESH, "vertex_stride": stride})
refuse({"layout": MESH, "vertex_count": SIZE_MAX})
for device in (-2, -(1 << 31)):
    refuse({"device": device})
for layout in (-1, 3, (1 << 31) - 1):
    refuse({"layout": layout})
for name, value in (
    ("size", 0),
    ("size", SIZE_MAX),
    ("references", None),
    ("reference_count", 0),
    ("reference_count", SIZE_MAX),
    ("parts", None),
    ("part_count", 0),
    ("part_count", SIZE_MAX),
    ("mode", -1),
    ("mode", 2),
    ("executor", -1),
    ("executor", 5),
    ("list_room", 1),
    ("launch_seconds", float("nan")),
    ("launch_seconds", -1.0),
):
    refuse(**{name: value})
library.graze_close(context)
print(f"{refused} refused")
