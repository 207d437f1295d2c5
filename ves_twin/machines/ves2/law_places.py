"""law_places: where a law may act on VES II, and on what it may depend; path_of, how it moves."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.law_forward import LawPlace, Variable
from ves_twin.effects.joints import CoulombFriction
from ves_twin.effects.law import LawKind
from ves_twin.effects.row import JOINTS, LEGS
from ves_twin.plant.plant import Plant
from ves_twin.plant.rig_laws import COMMANDED, PLATFORM, READ
from ves_twin.plant.signal_ranges import signal_ranges

EFFORT_SHARE = 0.3
"""Size that a law of efforts is expected to have, as a share of the largest dry friction that is
plausible there."""

READING_SHARE = 0.003
"""The same of a column, as a share of its range: what a sensor that works may be off."""

STEP = 0.5
"""Finite differences of sizes, in expected ones: predictions are good for 0.2 um of a leg's length,
which 1.5 N make at a rod; loops that hold a position answer a force in proportion."""

PATH = ("valve.command", "truth.pose", "truth.arm_q")
"""Signals beside the compared ones that tell what laws depend on."""

OWN = {"leg.length": LEGS, "sensor.wrench": PLATFORM, "arm.q": JOINTS, "arm.torque": JOINTS}
"""Signal -> places whose motion is that of its columns."""

_AT = dict(
    zip((*READ, *PATH), np.cumsum([0, *(SIGNALS[n].width for n in (*READ, *PATH))]), strict=False)
)
"""First column of each signal in what a run keeps."""


def law_places(plant: Plant) -> tuple[LawPlace, ...]:
    """Efforts at rods, joints and platform, and what is added to compared columns."""
    clock, found = Variable("time", "s"), []
    for name in (*LEGS, *JOINTS):
        size = EFFORT_SHARE * CoulombFriction.row_of(name).span[2]
        unit = "N" if name in LEGS else "N*m"
        of: tuple[Variable, ...] = (*_motion(name), clock, _command(name))
        found.append(LawPlace(name, LawKind.EFFORT, unit, size, of, STEP))
    legs = EFFORT_SHARE * CoulombFriction.row_of(LEGS[0]).span[2]
    radius = plant.parameters.number("platform.top_radius")
    for n, name in enumerate(PLATFORM):
        unit, size = ("N", legs) if n < 3 else ("N*m", legs * radius)
        found.append(LawPlace(name, LawKind.EFFORT, unit, size, (*_motion(name), clock), STEP))
    ranges = signal_ranges(plant)
    for signal in READ:
        low, high = ranges[signal]
        for n, column in enumerate(SIGNALS[signal].columns):
            size = READING_SHARE * float(high[n] - low[n])
            own = OWN[signal][n] if signal in OWN else ""
            of = (*(_motion(own) if own else ()), clock)
            of = (*of, _command(own)) if own in COMMANDED else of
            unit = SIGNALS[signal].units[n]
            found.append(LawPlace(column, LawKind.READING, unit, size, of))
    return tuple(found)


def _motion(name: str) -> tuple[Variable, Variable]:
    unit = "rad" if name in JOINTS or name in PLATFORM[3:] else "m"
    return Variable(f"position@{name}", unit), Variable(f"speed@{name}", f"{unit}/s")


def _command(name: str) -> Variable:
    return Variable(f"command@{name}", "1" if name in LEGS else "N*m")


def path_of(plant: Plant, time: FloatArray, kept: FloatArray) -> Mapping[str, FloatArray]:
    """Variables (n,) by name, from the columns that a run keeps (n, all).

    A rod's place is what its transducer reads; speeds are differences of rows.
    """
    home = plant.geometry.lengths(np.zeros(6))
    path = {"time": time - time[0]}
    for names, signal, zero in (
        (LEGS, "leg.length", home),
        (JOINTS, "truth.arm_q", np.zeros(3)),
        (PLATFORM, "truth.pose", np.zeros(6)),
    ):
        for n, name in enumerate(names):
            x = kept[:, _AT[signal] + n] - zero[n]
            path |= {f"position@{name}": x, f"speed@{name}": np.gradient(x, time)}
    for names, signal in ((LEGS, "valve.command"), (JOINTS, "arm.torque")):
        path |= {f"command@{name}": kept[:, _AT[signal] + n] for n, name in enumerate(names)}
    return path
