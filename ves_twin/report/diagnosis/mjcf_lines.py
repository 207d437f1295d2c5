"""mjcf_lines: what an MJCF file that has a part of an answer is worth on held-out recordings."""

from __future__ import annotations

from ves_twin.core.units import unit_tail
from ves_twin.machines.carried import Carried

WORST = 4
"""Channels that are told by their numbers."""


def mjcf_lines(carried: Carried | None) -> list[str]:
    """Sentences; none where the file has all of it."""
    if carried is None:
        return []
    lines = [f"Without {', '.join(carried.lacking)}, which is not written as MJCF."]
    shown = sorted(carried.errors.items(), key=lambda one: -one[1][2] / max(one[1][0], 1e-300))
    for name, (given, extended, part) in shown[:WORST]:
        told = f"plant.toml {extended:.3g}, the model as given {given:.3g}"
        unit = unit_tail(carried.units[name])
        lines.append(f"Held out it leaves {part:.3g}{unit} of {name} ({told}; nothing fitted).")
    if carried.worse:
        names = "all channels" if len(carried.worse) == len(carried.errors) else "some"
        lines.append(
            f"That is worse than no change in {names}: do not use it alone. diagnose --exclude with"
            " what it lacks finds numbers that need none."
        )
    return lines
