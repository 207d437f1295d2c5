"""body_frames: the poses of the rig's bodies along a recording."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray, IntArray
from ves_twin.plant.statics import place_rig
from ves_twin.report.rerun.rig import DrawnRig

FRAME_RATE = 30.0
"""Drawn poses per second of the recording [1/s]."""
FRAMES_PER_CHUNK = 2_000

MACHINE_POSE = ("truth.pose", "platform.pose", "platform.command")
MACHINE_ARM = ("truth.arm_q", "arm.q", "arm.command")
GHOST_POSE = ("reference.pose",)
GHOST_ARM = ("arm.command", "truth.arm_q", "arm.q")
"""Signals that pose the machine and the zero-g ghost, the best first."""


@dataclass(frozen=True)
class BodyFrames:
    """Poses of all bodies (the world left out) at some rows of a recording.

    Attributes:
        rows: rows of the recording (n,).
        position: origins in the inertial frame [m] (n, bodies, 3).
        turn: quaternions x, y, z, w, body to inertial (n, bodies, 4).
    """

    rows: IntArray
    position: FloatArray
    turn: FloatArray


def body_frames(
    recording: Recording, rig: DrawnRig, pose_from: tuple[str, ...], arm_from: tuple[str, ...]
) -> Iterator[BodyFrames]:
    """Poses of the bodies at about `FRAME_RATE`, some thousand frames at a time.

    The legs point straight at the platform's joints; their bending is too small to see.

    Args:
        recording: what is drawn.
        rig: the machine.
        pose_from: signals for the platform pose [m, rad], the first present is taken.
        arm_from: the same for the joint angles [rad].

    Yields:
        Frames without a gap in rows; a signal that is absent leaves the rig at home, rows that
        are not finite are left out.
    """
    pose = first_present(recording, pose_from, 6)
    joints = first_present(recording, arm_from, 3)
    rows = frame_rows(recording.time)
    finite = np.isfinite(pose[rows]).all(axis=1) & np.isfinite(joints[rows]).all(axis=1)
    rows = rows[finite]
    data = mujoco.MjData(rig.model)
    for start in range(0, len(rows), FRAMES_PER_CHUNK):
        yield _chunk(rig, data, rows[start : start + FRAMES_PER_CHUNK], pose, joints)


def frame_rows(time: FloatArray) -> IntArray:
    """Rows (n,) nearest after a regular grid of `FRAME_RATE`, first and last row included."""
    if not len(time):
        return np.zeros(0, dtype=np.int64)
    grid = np.arange(time[0], time[-1], 1.0 / FRAME_RATE)
    rows = np.append(np.searchsorted(time, grid), len(time) - 1)
    return np.unique(rows).astype(np.int64)


def first_present(recording: Recording, names: tuple[str, ...], width: int) -> FloatArray:
    """The first of some signals that a recording has (n, width); zeros if it has none."""
    for name in names:
        if name in recording.signals:
            return recording[name]
    return np.zeros((len(recording), width))


def _chunk(
    rig: DrawnRig, data: mujoco.MjData, rows: IntArray, pose: FloatArray, joints: FloatArray
) -> BodyFrames:
    bodies = rig.model.nbody - 1
    position = np.empty((len(rows), bodies, 3))
    turn = np.empty((len(rows), bodies, 4))
    for i, row in enumerate(rows):
        place_rig(data, rig.layout, rig.geometry, pose[row], joints[row])
        mujoco.mj_kinematics(rig.model, data)
        position[i] = data.xpos[1:]
        turn[i] = data.xquat[1:, [1, 2, 3, 0]]
    return BodyFrames(rows, position, turn)
