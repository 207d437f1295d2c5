"""too_much_friction: joints at which a model has more friction than anything that was measured."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray

TIMES = 2.0
"""Rms of the model's friction in that of the measured effort from which on it is told: what a joint
lifts and accelerates seldom takes half of its friction off in all of a log."""


def too_much_friction(
    model: mujoco.MjModel, along: Mapping[str, tuple[FloatArray, FloatArray]]
) -> list[str]:
    """A sentence where dampings and dry frictions of the model are none of this machine.

    A URDF that nobody identified often has `<dynamics damping="1.0" friction="1.0"/>` everywhere.

    Args:
        model: as it was given.
        along: joint -> measured effort and speed (n,) there.
    """
    found = {}
    for joint, (effort, speed) in along.items():
        dof = int(model.joint(joint).dofadr[0])
        dry, viscous = float(model.dof_frictionloss[dof]), float(model.dof_damping[dof])
        friction = _rms(dry * np.sign(speed) + viscous * speed)
        if friction > TIMES * _rms(effort):
            found[joint] = f"{joint} ({friction:.2g} for {_rms(effort):.2g})"
    if not found:
        return []
    few = ", ".join(found.values())
    return [
        f"damping and friction of the model are more than the whole effort at {few}, rms: are they"
        " placeholders? Write what its maker says, or 0, and how well you know it"
    ]


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
