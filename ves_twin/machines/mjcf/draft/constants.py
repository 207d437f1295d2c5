"""with_constants: columns whose constant their owner gives, as of a motor in volts or amperes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.machines.mjcf.draft.match import Match, Matches


def with_constants(matches: Matches, scales: Mapping[str, float]) -> Matches:
    """The columns, those with a constant as direct readings of what they stand for.

    Noise, low-pass and typical sizes of a draft follow from it: written into the file afterwards
    it would leave them as they were without it.

    Args:
        matches: as they were found.
        scales: column -> what one of its unit is of the model, as N m per A with the gear.

    Raises:
        UnknownNameError: no column of that name is matched; says the nearest.
        InvalidInputError: a constant of zero.
    """
    known = [m.column for m in matches.found]
    for column, scale in scales.items():
        if column not in known:
            raise UnknownNameError("matched column", column, known)
        if scale == 0.0:
            raise InvalidInputError(f"constant of {column}", scale, "what one of its unit gives")
    found = (_given(m, scales[m.column]) if m.column in scales else m for m in matches.found)
    return replace(matches, found=tuple(found))


def _given(match: Match, scale: float) -> Match:
    per = "its scale" if match.unit == match.spot.unit else match.per
    reasons = (*match.reasons, f"{per} is given")
    unit = match.spot.unit
    return replace(match, unit=unit, told=True, scale=scale, reasons=reasons, given=True)
