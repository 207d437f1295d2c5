"""in_milli: efforts without a told unit in thousandths of it, where the model says so of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ves_twin.machines.mjcf.draft.effort_fit import STRONG, EffortFit
from ves_twin.machines.mjcf.draft.match import Match

THOUSAND = 1e3

ALIKE = 2.0
"""Factor that masses and friction may make between a thousand and what is found."""


def in_milli(found: list[Match], fits: Mapping[Match, EffortFit]) -> tuple[list[Match], list[str]]:
    """Columns with that unit, and a sentence; as they are where not all clear factors say so.

    A log has one unit for its torques: of those that friction hides, the others tell. Not the
    other way round, since a model whose masses are in grams looks like kN.

    Args:
        found: columns as they are meant.
        fits: of the efforts among them.
    """
    open_ = [m for m in fits if not m.told and m.unit == m.spot.unit and m.unit in ("N", "N*m")]
    slopes = [abs(fits[m].slope) for m in open_ if fits[m].gain > STRONG]
    if not slopes or max(abs(float(np.log(s / THOUSAND))) for s in slopes) > np.log(ALIKE):
        return found, []
    names, one = ", ".join(m.column for m in open_), open_[0].unit
    words = f"{names}: numbers fit the model as m{one}, not as {one} (factor 0.001)"
    return [replace(m, unit=f"m{m.unit}") if m in open_ else m for m in found], [words]
