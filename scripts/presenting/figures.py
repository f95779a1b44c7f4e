# SPDX-License-Identifier: Apache-2.0
"""Figures as SVG, with labels beside what they name. A figure is 380 units wide, so its text is about 12 px high on a
phone of 390 px. It has its own background, and colours for light and dark mode."""
import math
from html import escape

from presenting.records import plain

WIDTH, LEFT, RIGHT = 380, 12, 12
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# All figures have the same style, because in a page with several figures, the style of each applies to all.
LIGHT = (
    ".figure .ground{fill:#fff}.figure text{fill:#1f2328;paint-order:stroke;stroke:#fff;stroke-width:3px}"
    ".figure .faint{fill:#59636e}.figure .axis{stroke:#59636e}.figure .grid{stroke:#d1d9e0}"
    ".figure .a{fill:#0b62b0}.figure .b{fill:#b3470b}.figure .c{fill:#8b949e}"
    ".figure .line-a{stroke:#0b62b0}.figure .line-b{stroke:#b3470b}"
)
DARK = (
    ".figure .ground{fill:#151b23}.figure text{fill:#f0f6fc;stroke:#151b23}"
    ".figure .faint{fill:#a9b4c0}.figure .axis{stroke:#a9b4c0}.figure .grid{stroke:#3d444d}"
    ".figure .a{fill:#58a6ff}.figure .b{fill:#f0883e}"
    ".figure .line-a{stroke:#58a6ff}.figure .line-b{stroke:#f0883e}"
)


def text(x, y, words, anchor="start", kind="", size=13):
    its = f' class="{kind}"' if kind else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}"{its}>{escape(plain(words))}</text>'


def line(x1, y1, x2, y2, kind):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" class="{kind}"/>'


def rectangle(x, y, width, height, kind):
    return f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height}" class="{kind}"/>'


def svg(height, alt, parts):
    """The file of a figure."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="figure" viewBox="0 0 {WIDTH} {height:.0f}" width="532" '
        f'height="{532 * height / WIDTH:.0f}" role="img" aria-label="{escape(plain(alt))}" '
        f'font-family="system-ui,sans-serif">\n<style>{LIGHT}@media (prefers-color-scheme:dark){{{DARK}}}</style>\n'
        f'<rect width="100%" height="100%" rx="6" class="ground"/>\n' + "\n".join(parts) + "\n</svg>\n"
    )


def bars(alt, unit, rows):
    """rows: (label, value, its text, class). The label is above its bar, the text to its right. unit: the axis's
    unit."""
    room = max(len(plain(words)) for _, _, words, _ in rows) * 7.6 + 8
    most = max(value for _, value, _, _ in rows)
    scale = (WIDTH - LEFT - RIGHT - room) / most
    parts, y = [], 22
    for label, value, words, kind in rows:
        parts += [text(LEFT, y, label), rectangle(LEFT, y + 5, value * scale, 12, kind)]
        parts += [line(LEFT, y + 3, LEFT, y + 19, "axis"), text(LEFT + value * scale + 6, y + 16, words)]
        y += 38
    parts.append(text(LEFT, y + 4, unit, kind="faint", size=12))
    return svg(y + 16, alt, parts)


def dots(alt, unit, rows, decades):
    """Dots on a logarithmic axis. rows: (label, value above 0, its text, class); decades: the axis's exponents."""
    first, last = decades
    at = lambda value: LEFT + 4 + (math.log10(value) - first) / (last - first) * (WIDTH - LEFT - RIGHT - 60)
    bottom, parts = 14 + 38 * len(rows), []
    for exponent in range(first, last + 1):
        parts.append(line(at(10**exponent), 10, at(10**exponent), bottom + 2, "grid"))
        parts.append(text(at(10**exponent), bottom + 17, f"{10**exponent:,}", "middle", "faint", 12))
    for i, (label, value, words, kind) in enumerate(rows):
        y = 24 + 38 * i
        parts += [text(LEFT, y, label), line(LEFT + 4, y + 10, at(value), y + 10, "axis")]
        parts.append(f'<circle cx="{at(value):.1f}" cy="{y + 10}" r="5" class="{kind}"/>')
        parts.append(text(at(value) + 10, y + 14, words))
    parts.append(text(LEFT, bottom + 36, unit, kind="faint", size=12))
    return svg(bottom + 48, alt, parts)


def ratios(alt, unit, rows):
    """Dots around 1 on a logarithmic axis from 1/2 to 8, one line per row. rows: (label, value, its text, class)."""
    at = lambda value: 162 + (math.log2(value) + 1) / 4 * (WIDTH - RIGHT - 70 - 162)
    bottom, parts = 12 + 22 * len(rows), []
    for tick in (0.5, 1, 2, 4, 8):
        parts.append(line(at(tick), 8, at(tick), bottom, "axis" if tick == 1 else "grid"))
        parts.append(text(at(tick), bottom + 16, f"{tick}", "middle", "faint", 12))
    for i, (label, value, words, kind) in enumerate(rows):
        y = 26 + 22 * i
        parts += [text(LEFT, y, label), f'<circle cx="{at(value):.1f}" cy="{y - 4}" r="5" class="{kind}"/>']
        parts.append(text(at(value) + 9, y, words.replace(" times", "")))
    parts.append(text(LEFT, bottom + 36, unit, kind="faint", size=12))
    return svg(bottom + 48, alt, parts)


def curves(alt, x_name, y_name, ticks, lines):
    """Curves over a logarithmic axis. lines: (label, class, points (log2, percent), the log2 at which the label is, 1
    if it is below the curve or -1 if above). ticks: their log2."""
    left, top, right, bottom = 44, 34, WIDTH - 26, 268
    low, high = ticks[0], ticks[-1]
    most = 5 * math.ceil(max(y for _, _, points, _, _ in lines for _, y in points) / 5)
    at_x = lambda x: left + (x - low) / (high - low) * (right - left)
    at_y = lambda y: bottom - y / most * (bottom - top)
    parts = [text(LEFT, 20, y_name, kind="faint", size=12)]
    for y in range(0, most + 1, 5):
        parts += [
            line(left, at_y(y), right, at_y(y), "grid"),
            text(left - 6, at_y(y) + 4, f"{y} %", "end", "faint", 12),
        ]
    for x in ticks:
        parts += [line(at_x(x), bottom, at_x(x), bottom + 4, "axis")]
        parts.append(text(at_x(x), bottom + 18, f"2{str(x).translate(RAISED)}", "middle", "faint", 12))
    for label, kind, points, where, side in lines:
        path = " ".join(f"{at_x(x):.1f},{at_y(y):.1f}" for x, y in points)
        parts.append(f'<polyline points="{path}" fill="none" stroke-width="2.5" class="line-{kind}"/>')
        y = next(y for x, y in points if x >= where)
        parts.append(text(at_x(where), at_y(y) + (20 if side > 0 else -10), label, kind=kind))
    parts.append(text(LEFT, bottom + 38, x_name, kind="faint", size=12))
    return svg(bottom + 50, alt, parts)
