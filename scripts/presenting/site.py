# SPDX-License-Identifier: Apache-2.0
"""The results as a web site: one page that contains the figures, and one page of the viewer. Both fetch nothing."""
import posixpath
import re
import struct
import subprocess
import tempfile
from html import escape
from pathlib import Path

from presenting import page
from presenting.records import plain


class NoViewer(Exception):
    """graze cannot write a viewer page."""


# Pairs for the viewer. For each result: the pair, the lane that is shown first, and what the reader sees there.
PAIRS = {
    "riddle": (
        "0x1p+1 -0x1p+1 0x1p+2 0x1p+0 0x1.4p+2 -0x1p+1 0x1p+0 -0x1.8p+1 -0x1.8p+1 -0x1.99998p-4 0x1.133334p+2 "
        "-0x1.9999ap-3 -0x1.99998p-4 0x1.933334p+2 0x1.999998p-1 0x1.e66668p+0 0x1.133334p+2 -0x1.19999ap+1",
        "interval_overlap/f32/cpu",
        "One of the thesis's own pairs. The triangles are apart by less than an ulp. With contraction "
        "`interval_overlap` in float32 says so; without it, the same source says that they meet.",
    ),
    "league": (
        "0 0 1  0 -1 0  1 1 0   0 0 0  0 1 0  1 0 1",
        "exact/f32/cpu",
        "The smallest pair of a finding. The triangles cross, and every lane of the viewer says so. "
        "`vtkTriangle::TrianglesIntersect` of VTK 9.1.0 says that they do not, unless the triangles are swapped.",
    ),
    "epsilon": (
        "0 0 0  .0125 0 0  0 .0125 0   0 0 .00625  .0125 0 .00625  0 .0125 .00625",
        "moller_1997/f32/cpu",
        "Small triangles, half their size apart. `moller_1997` is right until you choose the tolerance abs:1e-6, the "
        "epsilon that Möller published: then it says that they meet.",
    ),
}
STYLE = """
:root{color-scheme:light dark;--ground:#fff;--ink:#1f2328;--faint:#59636e;--rule:#d1d9e0;--code:#eef1f4;--link:#0b62b0}
@media (prefers-color-scheme:dark){
:root{--ground:#0d1117;--ink:#f0f6fc;--faint:#a9b4c0;--rule:#3d444d;--code:#21262d;--link:#58a6ff}}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--ink);font:17px/1.55 system-ui,sans-serif}
main{max-width:720px;margin:0 auto;padding:24px 16px 64px}
h1{font-size:30px;line-height:1.2;margin:8px 0 16px}
h2{font-size:22px;line-height:1.3;margin:56px 0 16px;text-wrap:balance}
code{background:var(--code);border-radius:4px;padding:1px 4px;font-size:.86em;overflow-wrap:anywhere}
a{color:var(--link)}
nav ol{padding-left:24px}nav li{margin:6px 0}
.figure{display:block;width:100%;max-width:532px;height:auto;border:1px solid var(--rule);border-radius:6px}
.small{color:var(--faint);font-size:15px;overflow-wrap:anywhere}
details{border:1px solid var(--rule);border-radius:6px;padding:10px 14px;margin:16px 0}
summary{cursor:pointer;font-weight:600;min-height:28px}
iframe{display:block;width:100%;height:min(80vh,760px);border:1px solid var(--rule);border-radius:6px;margin-top:12px}
@media (max-width:600px){h1{font-size:26px}h2{font-size:20px;margin-top:44px}iframe{display:none}}
"""
OPENS = """
for (const details of document.querySelectorAll('details')) {
  details.addEventListener('toggle', () => {
    const frame = details.querySelector('iframe');
    if (details.open && !frame.src && frame.offsetParent) frame.src = frame.dataset.src;
  });
}
"""


def named(link):
    """The text and the path of a link to a file of the repository that the site lacks."""
    words, path = link[1], posixpath.normpath(f"docs/results/{link[2]}")
    return f"`{path}`" if words == path else f"{words} (`{path}`)"


def html(markdown):
    """The Markdown of a paragraph as HTML."""
    text = escape(plain(markdown), quote=False)
    text = re.sub(r"\[([^]]+)\]\(([^)#]*)[^)]*\)", named, text)
    text = re.sub(r"(?<=[0-9]) (?=%|ns\b)|(?<=\b1) (?=in [0-9])|(?<=\b1 in) (?=[0-9])", "\u00a0", text)
    text = re.sub(r"`([^`]*)`", r"<code>\1</code>", text)
    return re.sub(r"(^|[\s(])\*([^*<>]+)\*", r"\1<em>\2</em>", text)


def bits(pair):
    """A pair as in the viewer's links: 18 float32 as hexadecimal words."""
    numbers = [float.fromhex(word) if "x" in word else float(word) for word in pair.split()]
    return "".join(f"{word:08x}" for word in struct.unpack("<18I", struct.pack("<18f", *numbers)))


def look(name):
    pair, lane, words = PAIRS[name]
    link = f"viewer.html#p={bits(pair)}&amp;lane={lane}"
    title = words.replace("`", "")
    return (
        f"<details><summary>Look at such a pair in 3-D</summary>\n<p>{html(words)} "
        f'<a href="{link}">Open it in the viewer</a> (1.5 MB).</p>\n'
        f'<iframe data-src="{link}" title="{escape(title)}"></iframe></details>\n'
    )


def section(result):
    records = "; ".join(
        f"<code>docs/measurements/{topic}.toml</code> ({html(place)})" for topic, place in page.sources(result)
    )
    return (
        f'<section id="{result.name}">\n<h2>{html(result.headline)}</h2>\n{result.figure}'
        f"<p>{html(result.paragraph)}</p>\n"
        f"{look(result.name) if result.name in PAIRS else ''}"
        f'<p class="small">Reproduce: {html(page.command(result))}.</p>\n'
        f'<p class="small">Records: {records}.</p>\n</section>\n'
    )


def index(results):
    title, introduction = page.HEAD.strip().removeprefix("# ").split("\n", 1)
    contents = "".join(f'<li><a href="#{result.name}">{html(result.headline)}</a></li>\n' for result in results)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n<link rel="icon" href="data:,">\n'
        f"<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n"
        f"<p>{html(introduction)}</p>\n<nav><ol>\n{contents}</ol></nav>\n"
        + "".join(section(result) for result in results)
        + f"</main>\n<script>{OPENS}</script>\n</body>\n</html>\n"
    )


def write(results, folder, graze):
    """Writes index.html and viewer.html. Throws: NoViewer, OSError."""
    with tempfile.TemporaryDirectory() as scratch:
        pairs, viewer = Path(scratch, "pairs.txt"), Path(scratch, "viewer.html")
        pairs.write_text("".join(f"{pair}\n" for pair, _, _ in PAIRS.values()), encoding="utf-8")
        command = [graze, "view", pairs, "--out", viewer]
        ran = subprocess.run(command, capture_output=True, text=True, env={"PATH": "/usr/bin:/bin"}, check=False)
        if ran.returncode != 0 or not viewer.exists():
            raise NoViewer(f"{graze} view wrote no page: {ran.stderr.strip()}; scripts/setup builds the viewer")
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "viewer.html").write_bytes(viewer.read_bytes())
    (folder / "index.html").write_text(index(results), encoding="utf-8")
