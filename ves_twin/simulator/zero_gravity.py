"""zero_gravity_motion: an arm follows commands on an emulated base; nonlinear, without the rig."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ves_twin.control import arm_servo
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.plant import Plant
from ves_twin.simulator.reference import ZeroGravityReference


@dataclass(frozen=True)
class ZeroGravityMotion:
    """Motion of base and joints, a row a cycle.

    Attributes:
        time: from zero [s] (k,).
        pose: of the base [m, rad] (k, 6).
        q: joint angles [rad] (k, 3).
    """

    time: FloatArray
    pose: FloatArray
    q: FloatArray


def zero_gravity_motion(
    plant: Plant,
    emulated: EmulatedSystem,
    commands: FloatArray,
    cycle: float,
    start: FloatArray | None = None,
) -> ZeroGravityMotion:
    """Follow joint commands with the plant's joint servo on the free emulated base.

    The first command holds before the run, the last one after it.

    Args:
        plant: whose arm and servo it is.
        emulated: the base.
        commands: joint angles, one a cycle [rad] (k, 3).
        cycle: time between commands [s].
        start: pose of the base at release, at rest [m, rad] (6,); zero if left out.

    Raises:
        InvalidInputError: commands of another shape, or a motion that does not stay finite.
    """
    commands = np.asarray(commands, float)
    if commands.ndim != 2 or len(commands) < 2 or commands.shape[1] != 3:
        raise InvalidInputError("joint commands", f"shape {commands.shape}", "rows of 3 angles")
    array = plant.parameters.array
    servo = np.zeros(1, arm_servo.PARAMETERS)
    for name in ("stiffness", "damping", "integral"):
        servo[name] = array(f"servo.{name}")
    servo["limit"], servo["cycle"] = array("arm.torque_limit"), cycle
    release = np.zeros(6) if start is None else np.asarray(start, float)
    reference = ZeroGravityReference(plant, emulated, servo, release, np.zeros(6), commands[0])
    padded = np.vstack([commands[:1], commands, commands[-1:], commands[-1:]])
    points = sliding_window_view(padded, 4, axis=0).transpose(0, 2, 1)[: len(commands) - 1]
    poses, _, angles = reference.advance(np.ascontiguousarray(points), cycle)
    if not np.all(np.isfinite(poses)):
        what = f"zero-g motion on {emulated.name}"
        raise InvalidInputError(what, "a state that is not finite", "gains that keep it stable")
    time = cycle * np.arange(len(commands), dtype=float)
    return ZeroGravityMotion(time, poses, angles)
