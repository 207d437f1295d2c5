"""all_turned: efforts that act against the motion at nearly all joints are turned together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ves_twin.machines.mjcf.draft.effort_fit import WORKS, EffortFit
from ves_twin.machines.mjcf.draft.match import Match

FEWEST, NEARLY = 3, 0.7
"""Efforts of which it is told, and share of them that must act against the motion: assumed."""


def all_turned(
    found: list[Match], fits: Mapping[Match, EffortFit], power: float
) -> tuple[list[Match], str] | None:
    """All efforts turned, and words for it, where together they take energy out of the machine.

    A machine gives none: no model is asked. Joint by joint a swap of two turned torques explains
    more, as its slopes are positive by chance (an arm of seven joints).

    Args:
        found: columns as they are meant.
        fits: of each effort.
        power: mean of what all efforts give to their joints [W].
    """
    against = [match for match, fit in fits.items() if fit.work < -WORKS]
    if len(fits) < FEWEST or power >= 0.0 or len(against) < NEARLY * len(fits):
        return None
    right = [m for m, fit in fits.items() if m not in against and fit.usable and fit.slope > 0.0]
    if right or any(match.given for match in fits):
        return None
    new = [replace(m, scale=-m.scale) if m in fits else m for m in found]
    names = ", ".join(match.column for match in fits)
    words = f"{names}: together they brake what they drive, and all are turned; or all positions"
    return new, f"{words} count the other way"
