# SPDX-License-Identifier: Apache-2.0
"""The checksum that graze writes as the last key of a JSON result, computed as a forger would: FNV-1a of the object's
text without spaces (fuzz/sealed.h)."""
import json
import re

from torture_attacks.bench import Violation


class Number(float):
    """A fraction with the file's digits, because graze writes some fractions with more digits than Python would."""

    def __new__(cls, text):
        number = super().__new__(cls, text)
        number.text = text
        return number


def loads(text):
    return json.loads(text, parse_float=Number)


def dumps(value, **layout):
    def marked(value):
        if isinstance(value, dict):
            return {key: marked(inner) for key, inner in value.items()}
        if isinstance(value, list):
            return [marked(inner) for inner in value]
        return "\0" + value.text if isinstance(value, Number) else value

    text = json.dumps(marked(value), ensure_ascii=False, **layout)
    return re.sub(r'"\\u0000([-+.0-9eE]+)"', r"\1", text)


def fnv1a(data, start=0xCBF29CE484222325):
    for byte in data:
        start = (start ^ byte) * 0x100000001B3 & (1 << 64) - 1
    return start


def checksum(value):
    return f"{fnv1a(dumps(value, separators=(',', ':')).encode(errors='surrogatepass')):016x}"


def read(file):
    """The object in a file that graze sealed, without its checksum."""
    value = loads(file.read_text())
    if value.pop("checksum") != checksum(value):
        raise Violation(f"expected {file.name} with the checksum of its text, found another")
    return value


def text(value):
    """The file's text, sealed again."""
    return dumps({**value, "checksum": checksum(value)}, indent=1) + "\n"
