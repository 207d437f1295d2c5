"""said: columns' names with what is grown to a quantity as a word: posa1 is pos_actual_1."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass

from ves_twin.data.formats.unit_names import bare_name
from ves_twin.machines.mjcf.draft.names import KIND_WORDS, MEASURED, SETPOINT

_QUANTITIES = sorted(frozenset[str]().union(*KIND_WORDS.values()), key=len)
_PARTS = re.compile(
    rf"({'|'.join(_QUANTITIES)})[_.]?({'|'.join(sorted(MEASURED | SETPOINT))}|[abd])?[_.]?(\d*)",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class _Parts:
    """A name's quantity, the letter or word behind it, and its number."""

    quantity: str
    tail: str
    number: str


def said(columns: Iterable[str]) -> dict[str, str]:
    """Each column's name, or what it says where a letter or a word is grown to a quantity.

    A letter a is "actual" beside a d, or where columns are numbered, but neither of a, b and c nor
    beside the quantity alone; a d is "desired" beside that a: elsewhere it is a rate.

    Args:
        columns: names of all of a log.
    """
    parts = {column: _parts(column) for column in columns}
    there: dict[tuple[str, str], set[str]] = {}
    for part in parts.values():
        if part is not None:
            there.setdefault((part.quantity, part.number), set()).add(part.tail)
    return {
        column: column if part is None else _said(column, part, there[part.quantity, part.number])
        for column, part in parts.items()
    }


def _parts(column: str) -> _Parts | None:
    match = _PARTS.fullmatch(bare_name(column))
    return _Parts(match[1].lower(), (match[2] or "").lower(), match[3]) if match else None


def _said(column: str, part: _Parts, tails: Collection[str]) -> str:
    """By the letters and words that columns of this quantity and number have."""
    lettered = part.quantity == "q" or len(part.quantity) > 1  # xa is no place, ia of a phase
    plain = lettered and "a" in tails and not {"", "b"} & set(tails)
    actual = {*MEASURED, *(("a",) if plain and (part.number or "d" in tails) else ())}
    if part.tail in actual:
        return f"{part.quantity}_actual_{part.number}"
    desired = {*SETPOINT, *(("d",) if plain else ())}
    return f"{part.quantity}_desired_{part.number}" if part.tail in desired else column
