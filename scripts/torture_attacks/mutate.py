# SPDX-License-Identifier: Apache-2.0
"""Changes bytes, texts and JSON at random."""
import json
import re

NUMBERS = "-1 0 1 2 3 4294967295 4294967296 4294967297 2147483648 99999999999999999999 -99999999999999999999".split()
NUMBERS += "1e400 -1e400 1e-400 nan inf -inf 0x1p-1075 0x1p+9999 0x 0.5 1e --1 1f".split() + ["", "x", "1_000", "٣"]
PIECES = [
    b"\0",
    b"\xef\xbb\xbf",
    b"\r",
    b"\r\n",
    b"\n",
    b"\t",
    b" ",
    b"\xff\xfe",
    b"\x1b[31m",
    b'"',
    b"\\",
    b"\\x",
    b"#",
    b"|",
    b"=",
    b"{",
    b"}",
    b"[" * 5000,
    b'{"a":' * 5000,
    b",",
    b"9" * 400,
    b"A" * 100000,
    b"\xc3",
    b"0 " * 1000,
]


def flip_bit(random, data):
    at = random.randrange(len(data) * 8)
    return data[: at // 8] + bytes([data[at // 8] ^ 1 << at % 8]) + data[at // 8 + 1 :]


def edit_bytes(random, data):
    data = bytearray(data)
    for _ in range(random.randint(1, 8)):
        data[random.randrange(len(data))] = random.randrange(256)
    return bytes(data)


def truncate(random, data):
    return data[: random.randrange(len(data))]


def _piece(random, data):
    first = random.randrange(len(data))
    return first, min(len(data), first + random.choice([1, 4, 16, 64, 512, 4096]))


def cut_out(random, data):
    first, last = _piece(random, data)
    return data[:first] + data[last:]


def repeat(random, data):
    first, last = _piece(random, data)
    return data[:last] + data[first:last] * random.choice([1, 2, 100]) + data[last:]


def overwrite(random, data):
    """Overwrites a piece with zeros, or with another piece."""
    first, last = _piece(random, data)
    other = random.randrange(len(data))
    piece = bytes(last - first) if random.random() < 0.5 else data[other : other + last - first]
    return data[:first] + piece + data[first + len(piece) :]


def insert(random, data):
    at = random.randrange(len(data) + 1)
    return data[:at] + random.choice(PIECES) + data[at:]


def replace_number(random, data):
    places = list(re.finditer(rb"[-+]?(?:0x)?[0-9.][0-9a-fA-F.pe+-]*", data))
    if not places:
        return flip_bit(random, data)
    place = random.choice(places)
    return data[: place.start()] + random.choice(NUMBERS).encode() + data[place.end() :]


def swap_lines(random, data):
    lines = data.splitlines(keepends=True)
    i, j = random.randrange(len(lines)), random.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return b"".join(lines)


def empty(_random, _data):
    return b""


BINARY = [flip_bit, flip_bit, edit_bytes, truncate, cut_out, repeat, overwrite]
TEXT = [*BINARY, insert, insert, replace_number, replace_number, replace_number, swap_lines, empty]


def any_of(random, data, changes):
    """Makes one to three changes."""
    for _ in range(random.choice([1, 1, 1, 2, 3])):
        if data:
            data = random.choice(changes)(random, data)
    return data


def _places(value):
    """Every container in the value, with each of its keys."""
    keys = value.keys() if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else []
    for key in keys:
        yield value, key
        yield from _places(value[key])


def edit_json(random, data):
    """Replaces a random value by one of another type or size, or removes it."""
    value = json.loads(data)
    places = list(_places(value))
    if not places:
        return b"{}"
    container, key = random.choice(places)
    choice = random.randrange(12)
    if choice == 0:
        del container[key]
    elif choice == 1 and isinstance(container, list):
        container.append(container[key])
    elif choice == 2:
        other, where = random.choice(places)
        container[key] = json.loads(json.dumps(other[where]))
    else:
        container[key] = random.choice(
            [
                None,
                -1,
                0,
                1.5,
                1e300,
                2**63,
                2**64,
                -(2**63),
                "",
                "x",
                "../../../../etc/passwd",
                "/",
                "\0",
                [],
                {},
                True,
                [[]],
                {"a": None},
                "A" * 10000,
                "near_edge_edge",
                "*",
            ]
        )
    return json.dumps(value, indent=1).encode()
