"""carried_of: what of a law MJCF has a place for: friction loss and damping of its joint."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.optimize import lsq_linear

from ves_twin.core.types import FloatArray
from ves_twin.core.units import unit_tail
from ves_twin.effects.change import DAMPING, FRICTION_LOSS, Attribute
from ves_twin.effects.law import Law, LawKind, LawShape, joints_of
from ves_twin.machines.mjcf.parts.joint_units import joint_units

PLACES = 2001
"""Speeds over the range of a law at which it is looked at."""

AT_REST = 0.01
"""Share of that range about standing still that is left out: a sign is smoothed there."""

BOTH_WAYS = 0.1
"""Share of that range that either direction must have: one way alone, any force is a friction."""

LEAST = 0.5
"""Share of a law's mean square that friction must take; below, it is another law."""


@dataclass(frozen=True)
class LawShare:
    """The part of an effort over a joint's own speed v that opposes it as friction does.

        E(v) = -f sign(v) - d v + rest

    Attributes:
        joint: of the law.
        friction_loss: f [N, N m].
        damping: d [N s/m, N m s/rad].
        left: rms of the rest as a share of the law's.
        seen: least and largest speed at which the law was seen; it is held beyond, and they go on.
    """

    joint: str
    friction_loss: float
    damping: float
    left: float
    seen: tuple[float, float]

    def edit(self, model: mujoco.MjModel) -> None:
        """Add it to a model."""
        for attribute, size in self._sizes():
            attribute.add(model, self.joint, size)

    def words(self, model: mujoco.MjModel) -> str:
        """For people, with the model's numbers before and after."""
        turns = joint_units(model, self.joint)[0] == "rad"
        units = ("N*m", "N*m*s/rad") if turns else ("N", "N*s/m")
        told = []
        for (attribute, size), unit in zip(self._sizes(), units, strict=True):
            before = attribute.read(model, self.joint)
            ends = [f"{value:.6g}" for value in (before, before + size)]
            if ends[0] != ends[1]:
                told.append(f"{attribute.name} {' -> '.join(ends)}{unit_tail(unit)}")
        within = " to ".join(f"{speed:.3g}" for speed in self.seen)
        where = f"seen from {within} {joint_units(model, self.joint)[1]}"
        return f"{', '.join(told)} of joint {self.joint}, {where}"

    def _sizes(self) -> list[tuple[Attribute, float]]:
        return [(FRICTION_LOSS, self.friction_loss), (DAMPING, self.damping)]


def carried_of(law: Law, model: mujoco.MjModel) -> LawShare | None:
    """Least squares of the two over the range of speeds in which the law was seen.

    Neither leaves the joint with less than none of it.

    Args:
        law: of a machine's file.
        model: that it acts on, with its friction loss and damping.

    Returns:
        None of another kind or shape of law, of one that was seen one way alone, or where friction
        takes less than LEAST of it.
    """
    if law.kind is not LawKind.EFFORT or law.shape is not LawShape.TABLE:
        return None
    if law.of != (f"speed@{law.place}",) or len(joints_of(law.place)) > 1:
        return None
    low, high = law.knots[0][0], law.knots[0][-1]
    if min(-low, high) < BOTH_WAYS * (high - low):
        return None
    speed = np.linspace(low, high, PLACES)
    speed = speed[np.abs(speed) > AT_REST * (high - low)]
    effort = law.at(speed)
    columns = -np.stack([np.sign(speed), speed], axis=1)
    sizes = lsq_linear(columns, effort, (_least(model, law.place), np.inf), method="bvls").x
    rest = effort - columns @ sizes
    left = float(np.linalg.norm(rest) / max(float(np.linalg.norm(effort)), 1e-30))
    if not left**2 <= 1.0 - LEAST or not np.any(effort):
        return None
    return LawShare(law.place, float(sizes[0]), float(sizes[1]), left, (low, high))


def _least(model: mujoco.MjModel, joint: str) -> FloatArray:
    """What may be taken from friction loss and damping at most (2,), below zero."""
    there = [kind.read(model, joint) for kind in (FRICTION_LOSS, DAMPING)]
    return np.array([min(-one, 0.0) for one in there], float)
