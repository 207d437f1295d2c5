"""suspicions: values that another unit would explain better than the one the map gives."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ves_twin.core.signals import Signal
from ves_twin.core.types import FloatArray

Range = tuple[FloatArray, FloatArray]
"""Least and largest plausible value of each column of a signal (width,)."""

FACTORS = {
    "m": {"mm": 1e3, "cm": 1e2, "inches": 1.0 / 0.0254},
    "rad": {"degrees": 180.0 / np.pi, "milliradians": 1e3},
    "N": {"kN": 1e-3, "mN": 1e3},
    "N*m": {"mN m": 1e3, "N mm": 1e3},
    "Pa": {"bar": 1e-5, "kPa": 1e-3, "MPa": 1e-6, "psi": 1.0 / 6894.757},
    "1": {"percent": 1e2},
}
"""SI unit -> other units, and how many of them make one."""

USUAL = 3.0
"""A range about zero so many times the plausible one still passes: plants differ."""

NEAR = 2.0
"""So does one that misses a range away from zero by less than this factor."""


def suspicions(
    values: FloatArray, signal: Signal, plausible: Mapping[str, Range]
) -> tuple[str, ...]:
    """Sentences about columns that lie where the plant cannot be, and what would explain it.

    Args:
        values: in SI (n, width).
        signal: what they are.
        plausible: ranges by signal; a signal without one is not judged.
    """
    if signal.name not in plausible:
        return ()
    low, high = plausible[signal.name]
    said = []
    for i, (column, unit) in enumerate(zip(signal.columns, signal.units, strict=True)):
        rows = values[np.isfinite(values[:, i]), i]
        if not len(rows):
            continue
        here = float(np.percentile(rows, 1)), float(np.percentile(rows, 99))
        if _fits(here, (low[i], high[i]), 1.0):
            continue
        others = FACTORS.get(unit, {}).items()
        near = [name for name, factor in others if _fits(here, (low[i], high[i]), factor)]
        cause = f"{near[0]} taken for {unit} is suspected" if near else "check unit and sign"
        said.append(
            f"{column} runs from {here[0]:.4g} to {here[1]:.4g} {unit}, the plant's range is"
            f" {low[i]:.4g} to {high[i]:.4g}: {cause}"
        )
    return tuple(said)


def _fits(here: tuple[float, float], there: tuple[float, float], factor: float) -> bool:
    """Whether values divided by a factor lie within the plausible range, widened."""
    low, high = here[0] / factor, here[1] / factor
    if there[0] > 0.0:
        return there[0] / NEAR <= low and high <= NEAR * there[1]
    return USUAL * there[0] <= low and high <= USUAL * there[1]
