"""EmulationCost: what a gap of wrench and pose costs an admittance run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.kinematics.rotations import matrix_from_angles
from ves_twin.mechanics.kinematics.wrenches import rotate_wrench, sensor_to_top
from ves_twin.plant.plant import Plant

FORCE, MOMENT = 1.0, 1.5
"""Largest error of the dynamic wrench that the emulation can bear [N, N m] (thesis 3.2.3)."""


@dataclass(frozen=True)
class EmulationCost:
    """What the gap means for the emulation.

    Attributes:
        force: rms of the wrench residual's force [N].
        moment: rms of its moment [N m].
        force_share: peak force over the 1 N that thesis 3.2.3 allows.
        moment_share: peak moment over the 1.5 N m.
        translation: rms of the pose residual [m]; None where the pose was not recorded.
        rotation: rms of it [rad].
        base_translation: peak of the emulated base's motion under the wrench residual alone [m].
        base_rotation: peak of it [rad].
        emulated: name of the emulated system.
    """

    force: float
    moment: float
    force_share: float
    moment_share: float
    translation: float | None
    rotation: float | None
    base_translation: float
    base_rotation: float
    emulated: str


def emulation_cost(
    name: str,
    plant: Plant,
    time: FloatArray,
    wrench: FloatArray,
    attitude: FloatArray,
    pose: FloatArray | None,
) -> EmulationCost:
    """What residuals cost.

    The emulated base starts at rest and takes the wrench residual through X(k+1) = Phi X + Gamma W
    (thesis eqs 2.4 to 2.6) with the payload's answer to that motion left out: a scale of the
    error, not a forecast.

    Args:
        name: of the emulated system.
        plant: where the sensor sits.
        time: even clock [s] (n,).
        wrench: measured less simulated, sensor axes [N, N m] (n, 6); NaN where missing.
        attitude: commanded angles [rad] (n, 3).
        pose: measured less simulated [m, rad] (n, 6), if there is one.
    """
    known = np.where(np.isfinite(wrench), wrench, 0.0)
    motion = _base_motion(name, plant, time, known, attitude)
    force, moment = np.linalg.norm(known[:, :3], axis=1), np.linalg.norm(known[:, 3:], axis=1)
    return EmulationCost(
        force=_rms(force),
        moment=_rms(moment),
        force_share=float(force.max()) / FORCE,
        moment_share=float(moment.max()) / MOMENT,
        translation=None if pose is None else _rms(np.linalg.norm(pose[:, :3], axis=1)),
        rotation=None if pose is None else _rms(np.linalg.norm(pose[:, 3:], axis=1)),
        base_translation=float(np.linalg.norm(motion[:, :3], axis=1).max()),
        base_rotation=float(np.linalg.norm(motion[:, 3:], axis=1).max()),
        emulated=name,
    )


def _base_motion(
    name: str, plant: Plant, time: FloatArray, wrench: FloatArray, attitude: FloatArray
) -> FloatArray:
    phi, gamma = EmulatedSystem.load(name).discretise(float(time[1] - time[0]))
    position = plant.parameters.array("sensor.position")
    state, rows = np.zeros(12), np.empty((len(time), 6))
    for k in range(len(time)):
        turn = matrix_from_angles(np.ascontiguousarray(attitude[k]))
        state = phi @ state + gamma @ rotate_wrench(turn, sensor_to_top(wrench[k], position))
        rows[k] = state[:6]
    return rows


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.nanmean(values**2)))
