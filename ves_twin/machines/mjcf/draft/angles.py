"""counted, other_angle: positions that count an encoder, or hide their unit in a constant."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ves_twin.machines.mjcf.draft.changes import DEGREE, misnamed
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity

COUNTS = 16.0 * np.pi
"""Whole numbers as large as that are no radians, eight turns, and no metres."""


def other_angle(
    log: LogColumns, found: list[Match], joint: str, scale: float = 0.0, unit: str = ""
) -> Iterator[str]:
    """An angle that may be in the other unit, where a constant that is fitted hides the factor.

    Args:
        log: the columns.
        found: what they are taken for.
        joint: whose angle it is.
        scale: the constant; 0 where none was read off.
        unit: of the constant.
    """
    for match in found:
        mine = match.spot.quantity is Quantity.POSITION and match.spot.name == joint
        if not (mine and match.told and match.unit in ("deg", "rad")):
            continue
        most, degrees = float(np.max(np.abs(log.column(match.column)))), match.unit == "deg"
        if misnamed(match, most):
            other, factor = ("radians", 1.0 / DEGREE) if degrees else ("degrees", DEGREE)
            reaches = f"{match.column} reaches {most:.3g} {match.unit} at most: "
            told = f"if these are {other}, the constant is {abs(scale) * factor:.3g} {unit}"
            yield reaches + (told if scale else f"are these {other}?")


def counted(log: LogColumns, found: Sequence[Match]) -> Iterator[Match]:
    """Positions of whole numbers alone, which reach far: what an encoder counts."""
    for match in found:
        if match.spot.quantity is Quantity.POSITION and not match.told:
            values = log.as_logged(match.column)
            if np.ptp(values) > COUNTS and np.all(values == np.round(values)):
                yield match


def words_of_counted(log: LogColumns, found: Sequence[Match]) -> Iterator[str]:
    """What is asked of each."""
    for match in counted(log, found):
        values, slides = log.as_logged(match.column), match.spot.unit == "m"
        scale = "way / counts of it" if slides else "2 pi / counts of a turn"
        other = ", or millimetres" * slides
        yield (
            f"{match.column} has whole numbers alone, {np.min(values):g} to {np.max(values):g}:"
            f" counts of an encoder{other}? scale = {scale}"
        )
