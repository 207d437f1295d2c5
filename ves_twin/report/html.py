"""Html: text that is HTML already, and the parts that a page is made of."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from html import escape

OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*")
"""An option of a command, within a text."""


class Html(str):
    """Text that is HTML already; any other text is escaped where a page takes it in."""

    __slots__ = ()


def markup(text: object) -> Html:
    """Text as HTML: escaped, unless it is HTML already; options are not broken at a dash."""
    if isinstance(text, Html):
        return text
    return Html(OPTION.sub(r'<span class="whole">\g<0></span>', escape(str(text))))


def paragraph(text: object, kind: str = "") -> Html:
    """A paragraph; `kind` is a class of the style: "lead", "note", "good", "bad", "open"."""
    return Html(f"<p{_class(kind)}>{markup(text)}</p>")


def bullets(lines: Iterable[object]) -> Html:
    """A list of lines; empty if there are none."""
    items = "".join(f"<li>{markup(line)}</li>" for line in lines)
    return Html(f"<ul>{items}</ul>" if items else "")


def section(title: object, *parts: Html) -> Html:
    """A headed part of the page."""
    return Html(f"<section><h2>{markup(title)}</h2>\n{joined(parts)}</section>")


def folded(title: object, *parts: Html) -> Html:
    """A part that opens when its title is clicked; print shows the title."""
    return Html(f"<details><summary>{markup(title)}</summary>\n{joined(parts)}</details>")


def joined(parts: Iterable[Html]) -> Html:
    """Parts one after the other."""
    return Html("\n".join(parts))


MANY = 8
"""Columns that a table has at its usual size; more are set closer, so that the page holds them."""


def table(head: Sequence[object], rows: Iterable[Sequence[object]], caption: object = "") -> Html:
    """A table; cells that begin like a number stand to the right.

    Args:
        head: titles of the columns, with units where a column has one.
        rows: cells of each row, as many as titles.
        caption: a line above it.
    """
    top = "".join(f"<th>{markup(cell)}</th>" for cell in head)
    body = "\n".join(f"<tr>{''.join(_cell(cell) for cell in row)}</tr>" for row in rows)
    words = f"<caption>{markup(caption)}</caption>" if caption else ""
    many = _class("many" if len(head) > MANY else "")
    whole = f"<table{many}>{words}<thead><tr>{top}</tr></thead>\n<tbody>{body}</tbody></table>"
    return Html(f'<div class="wide">{whole}</div>')


def _cell(cell: object) -> str:
    text = str(cell).lstrip("<>+-~ ")
    numeric = not isinstance(cell, Html) and text[:1].isdigit()
    return f"<td{_class('number' if numeric else '')}>{markup(cell)}</td>"


def _class(kind: str) -> str:
    return f' class="{escape(kind)}"' if kind else ""
