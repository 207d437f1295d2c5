"""Load, lifted: what the last bodies of arms can have carried, by the efforts of a log."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.draft.effort_fit import friction_columns
from ves_twin.machines.mjcf.draft.estimates import typical
from ves_twin.machines.mjcf.draft.motion import Motion
from ves_twin.machines.mjcf.rig.places import carries

LEAST = 1e-3
"""Effort a kilogram [N m/kg or N/kg] below which a joint bears none of a weight: round-off."""


HEAVIER = 0.1
"""Share of its own mass from which a body is heavier than the model has it: less is tolerance."""


@dataclass(frozen=True)
class Load:
    """What a last body can carry.

    Attributes:
        most: mass [kg] at its centre whose weight would take all of an effort.
        heavier: whether the efforts ask for clearly more than it weighs in the model.
    """

    most: float
    heavier: bool


def lifted(
    model: mujoco.MjModel,
    motion: Callable[[mujoco.MjModel], Motion],
    efforts: Iterable[tuple[int, FloatArray]],
) -> dict[str, Load]:
    """What the last bodies can carry by an effort that their weight would take all of.

    Of the joints that bear it the one that could bear least; a tool that a model lacks is no
    heavier, whatever the mass of the flange in the model (a UR10e: 0.2 kg, and 2 kg on it).

    Args:
        model: of the machine.
        motion: of a model, along the log.
        efforts: degree of freedom and effort [N or N m] (m,) of each drive.

    Returns:
        Body -> its load; without bodies that no effort lifts.
    """
    loads, found = list(efforts), dict[str, Load]()
    now = motion(model)
    here = _weight(model, motion)
    for body in range(1, model.nbody):
        name = model.body(body).name
        if not name or not carries(model, body) or not model.body_mass[body] > 0.0:
            continue
        heavier = copy.copy(model)
        heavier.body_mass[body] += 1.0
        per_kg = _weight(heavier, motion) - here
        most = [
            typical(effort) / size
            for dof, effort in loads
            if (size := float(np.percentile(np.abs(per_kg[:, dof]), 95.0))) > LEAST
        ]
        if most and np.isfinite(min(most)):
            whole = motion(heavier).effort - now.effort
            extra = _extra(now, whole, loads)
            found[name] = Load(min(most), extra > HEAVIER * float(model.body_mass[body]))
    return found


def _extra(now: Motion, per_kg: FloatArray, loads: Sequence[tuple[int, FloatArray]]) -> float:
    """Mass [kg] that efforts ask for beyond the model, beside friction of each joint."""
    ask, weight = 0.0, 0.0
    for dof, effort in loads:
        friction = friction_columns(now.speed[:, dof])
        rows = np.column_stack([effort - now.effort[:, dof], per_kg[:, dof]])
        left, more = (rows - friction @ np.linalg.lstsq(friction, rows, rcond=None)[0]).T
        power = float(left @ left) or 1.0
        ask, weight = ask + float(more @ left) / power, weight + float(more @ more) / power
    return ask / weight if weight else 0.0


def _weight(model: mujoco.MjModel, motion: Callable[[mujoco.MjModel], Motion]) -> FloatArray:
    """What gravity alone asks of the joints (m, nv): Coriolis terms are the same without it."""
    level = copy.copy(model)
    level.opt.gravity[:] = 0.0
    return np.asarray(motion(model).steady - motion(level).steady)
