"""by_number: columns and actuators that nothing but their numbers joins: valve1 to 8, thr1 to 8."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TypeVar

from ves_twin.data.formats.unit_names import bare_name
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match, Matches
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot, own_number

Member = TypeVar("Member")

FEWEST = 3
"""Members of a family that are joined: two of anything are numbered alike by chance."""


def by_number(log: LogColumns, matches: Matches, spots: tuple[Spot, ...]) -> Matches:
    """With columns of one family taken for actuators of one family, number by number.

    Only where both are the one family that is left, and every column has its actuator: what is
    called otherwise on the rig than in the model is still counted in one way.
    """
    told = {m.spot for m in matches.found}
    free = [s for s in spots if s.quantity is Quantity.EFFORT and s not in told]
    columns = {c: bare_name(log.called.get(c, c)) for c in matches.left if c in log.values}
    plain = [c for c in columns if log.units.get(c, "") in ("", "1", "%")]
    ours = _families((c, columns[c]) for c in plain)
    theirs = _families((s, s.name) for s in free)
    if len(ours) != 1 or len(theirs) != 1 or not set(ours[0]) <= set(theirs[0]):
        return matches
    why = f"by its number alone, of {_ends(ours[0])} and {_ends(theirs[0])}"
    new = []
    for number, column in sorted(ours[0].items()):
        unit, spot = log.units.get(column, ""), theirs[0][number]
        new.append(Match(column, spot, unit or spot.unit, bool(unit), 1.0, (why,)))
    taken = {match.column for match in new}
    left = {c: reason for c, reason in matches.left.items() if c not in taken}
    order = {spot: i for i, spot in enumerate(spots)}
    found = sorted([*matches.found, *new], key=lambda match: order[match.spot])
    return replace(matches, found=tuple(found), left=left)


def _families(named: Iterable[tuple[Member, str]]) -> list[dict[int, Member]]:
    """Members by number, of each family of names that are the same but for their last number."""
    found: dict[str, dict[int, Member]] = {}
    twice = set[str]()
    for member, name in named:
        number = own_number(name)
        if number is None:
            continue
        head, _, tail = name.rpartition(re.findall(r"\d+", name)[-1])
        family = found.setdefault(f"{head}#{tail}", {})
        if number in family:
            twice.add(f"{head}#{tail}")
        family[number] = member
    return [one for stem, one in found.items() if len(one) >= FEWEST and stem not in twice]


def _ends(family: Mapping[int, str | Spot]) -> str:
    """First and last of a family, by name."""
    first, last = (family[number] for number in (min(family), max(family)))
    names = (one if isinstance(one, str) else one.name for one in (first, last))
    return " to ".join(names)
