"""html_page: one self-contained HTML page: no script, no font, nothing from a network."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ves_twin.core.whole_file import write_whole
from ves_twin.report.html import Html, joined, markup

STYLE = """
:root { color-scheme: light; --ink: #1d2329; --soft: #5b6670; --line: #d8dde2; --wash: #f5f7f9;
  --good: #1b6e3c; --bad: #a32020; --open: #8a5a00; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2rem 1.5rem 4rem; max-width: 66rem; background: #fff;
  color: var(--ink); font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.55rem; margin: 0 0 .3rem; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 .6rem; padding-bottom: .2rem;
  border-bottom: 1px solid var(--line); }
p { margin: .4rem 0; max-width: 52rem; }
.whole { white-space: nowrap; }
.lead { font-size: 1.15rem; margin: .8rem 0; }
.note { color: var(--soft); font-size: .92rem; }
.good, .bad, .open { font-size: 1.05rem;
  padding: .45rem .8rem; border-left: 4px solid; background: var(--wash); }
.good { border-color: var(--good); } .bad { border-color: var(--bad); }
.open { border-color: var(--open); }
ul { margin: .3rem 0 .6rem; padding-left: 1.3rem; }
table { border-collapse: collapse; margin: .7rem 0; font-size: .82rem; }
caption { text-align: left; color: var(--soft); padding-bottom: .25rem; }
th, td { padding: .2rem .45rem; border-bottom: 1px solid var(--line); text-align: left;
  vertical-align: top; }
th { color: var(--soft); font-weight: 600; border-bottom: 2px solid var(--line); }
td:first-child { white-space: nowrap; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.wide { overflow-x: auto; }
table.many { font-size: .72rem; }
table.many th, table.many td { padding: .2rem .28rem; }
figure { margin: .8rem 0 1.2rem; }
figure svg { width: 100%; height: auto; }
figcaption { color: var(--soft); font-size: .9rem; }
details { margin: .6rem 0; } summary { cursor: pointer; color: var(--soft); }
@media print { body { padding: 0; max-width: none; font-size: 11px; }
  section, figure, table { break-inside: avoid; } }
"""


def html_page(title: object, parts: Iterable[Html]) -> str:
    """The whole page; what stands first is the first screen.

    Args:
        title: heading, and title of the window.
        parts: sections and paragraphs in order.
    """
    name = markup(title)
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{name}</title><style>{STYLE}</style></head>\n"
        f"<body><h1>{name}</h1>\n{joined(parts)}\n</body></html>\n"
    )


def write_page(path: Path, page: str) -> Path:
    """Write a page.

    Raises:
        FileAccessError: the file cannot be written.
    """
    write_whole(path, page)
    return path
