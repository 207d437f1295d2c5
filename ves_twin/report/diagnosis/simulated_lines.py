"""simulated_lines: what an answer by efforts leaves of held-out motions, simulated."""

from __future__ import annotations

from math import inf, isfinite

from ves_twin.core.quantity import quantity
from ves_twin.machines.simulated import Simulated

SHOWN = 4
"""Channels that are told: those that are left the largest share."""


def simulated_lines(simulated: Simulated | None) -> list[str]:
    """A sentence for each channel; none where simulations were compared anyway."""
    if simulated is None:
        return []
    left = {name: b / max(a, 1e-300) for name, (a, b) in simulated.errors.items()}
    worst = sorted(left, key=lambda name: left[name] if isfinite(left[name]) else inf, reverse=True)
    lines = []
    for name in worst[:SHOWN]:
        before, after = (_left(error, simulated.units[name]) for error in simulated.errors[name])
        lines.append(
            f"Simulated, held out: {name} {after} by the extended model, {before} as given."
        )
    return lines


def _left(error: float, unit: str) -> str:
    return f"{quantity(error, unit)} off" if isfinite(error) else "out of all bounds"
