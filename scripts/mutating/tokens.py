# SPDX-License-Identifier: Apache-2.0
"""The mutants of a source: its replaceable tokens, replaced one at a time or all behind switches (switches.h)."""
import re

SWAPPED = ("< <=", "> >=", "== !=", "&& ||", "+ -", "& |", "<< >>", "+= -=", "&= |=", "++ --", "true false", "min max")
SWAPS = {"*": "+", "continue": "break"}
SWAPS |= {old: new for pair in map(str.split, SWAPPED) for old, new in (pair, pair[::-1])}
# A token, identified by its surroundings: clang-format puts spaces around binary operators, but not inside the <…> of a
# template.
TOKEN = re.compile(
    r"""
    (?<=\ )(?:<=|>=|==|!=|&&|\|\||\+=|-=|&=|\|=|<<|>>|<|>|\+|-|\*|&|\|)(?=\ )   # binary
  | \+\+ | --
  | (?<=[(\ ,!])!(?=[\w(])                                                       # not
  | (?<=[(,={?:]\ )-(?=\w) | (?<=\()-(?=\w) | (?<=return\ )-(?=\w)               # minus
  | \b(?:true|false|continue)\b | (?<=std::)(?:min|max)(?=\()
  | (?<![\w.'"])\d+(?![\w.'"])                                                   # a whole number
""",
    re.VERBOSE,
)
SKIPPED = re.compile(r"^\s*(#|static_assert|template|using|namespace|friend)|\bstatic_assert\b|\bthrow\b|\boperator\b")


def blanked(text):
    """The text with strings, characters and comments replaced by spaces; all positions stay the same."""
    pattern = r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\''
    return re.sub(pattern, lambda m: re.sub(r"[^\n]", " ", m.group()), text, flags=re.S)


def replacement(token, before):
    if token.isdecimal():
        return "0" if token == "1" else str(int(token) + 1)
    if (
        token == "!"
        or (token == "-" and not before.endswith(" "))
        or (token == "-" and re.search(r"([(,={?:]|return) $", before))
    ):
        return ""
    return SWAPS[token]


def mutants_of(root, group, file):
    text = (root / file).read_text(encoding="utf-8")
    result, offset = [], 0
    for number, (line, blank) in enumerate(zip(text.split("\n"), blanked(text).split("\n")), 1):
        # A mutated constant array size would not compile. All other declarations are mutated.
        if not SKIPPED.search(blank):
            for found in TOKEN.finditer(blank):
                new = replacement(found.group(), blank[: found.start()])
                changed = line[: found.start()] + new + line[found.end() :]
                result.append(
                    {
                        "group": group,
                        "file": file,
                        "line": number,
                        "column": found.start() + 1,
                        "old": found.group(),
                        "new": new,
                        "at": offset + found.start(),
                        "before": line.strip(),
                        "after": changed.strip(),
                    }
                )
        offset += len(line) + 1
    return result


def name_of(mutant):
    return f"{mutant['file']}:{mutant['line']}:{mutant['column']} {mutant['old']} -> {mutant['new'] or 'nothing'}"


def switch_of(mutant, number, text):
    """The switch that replaces the mutant's token: (from, to, text). None for a mutant that needs a separate build."""
    old, new, at = mutant["old"], mutant["new"], mutant["at"]
    end, follows = at + len(old), text[at + len(old) : at + len(old) + 1]
    chosen = f"graze_mutant::on({number})"
    if old.isdecimal() or old in ("true", "false"):
        return at, end, f"({chosen} ? {new} : {old})"
    if old == "continue":
        return at, end, f"if ({chosen}) break; else continue"
    if old in ("min", "max"):
        return at - len("std::"), end, f"graze_mutant::{old}<{number}>"
    if new == "":
        return at, end, f"graze_mutant::{'Not' if old == '!' else 'Minus'}<{number}>{{}}->*{old}"
    if old in ("++", "--"):
        return (
            (at, end, f"graze_mutant::Step<{number}, {'true' if old == '++' else 'false'}>{{}}->*")
            if re.match(r"[\w(*]", follows)
            else None
        )
    if old in ("&&", "||"):
        return None  # a switch would evaluate both sides
    return at, end, f"{old} graze_mutant::Switch<{number}>{{}} {old}"


def switched(text, mutants):
    """The text with switches for these mutants: {number: mutant}."""
    places = sorted(
        (place for place in (switch_of(mutant, number, text) for number, mutant in mutants.items()) if place),
        reverse=True,
    )
    for begin, end, new in places:
        text = text[:begin] + new + text[end:]
    return text
