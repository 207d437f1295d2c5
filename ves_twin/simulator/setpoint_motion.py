"""setpoint_motion: commanded leg lengths of a file as a motion of the platform."""

from __future__ import annotations

import numpy as np

from ves_twin.control.timed import TimedPoses
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.stewart import StewartGeometry, pose_jacobian, track_poses
from ves_twin.scenario.setpoint_file import read_setpoints

NEAR = 1e-3
"""How far the first pose may lie from the scenario's start [m, rad]: motion of one cycle."""


def setpoint_motion(file: str, start: FloatArray, geometry: StewartGeometry) -> TimedPoses:
    """The poses whose lengths a file commands; the computers make the same lengths of them again.

    Args:
        file: as `read_setpoints` takes it.
        start: platform pose of the scenario [m, rad] (6,).
        geometry: of the legs, as the computers believe it.

    Raises:
        VesTwinError: a file that is missing, unreadable or cannot be followed.
    """
    given = read_setpoints(file)
    lengths = np.ascontiguousarray(given.legs)
    poses = poses_of(lengths, start, geometry)
    if not np.all(np.isfinite(poses)) or np.max(np.abs(poses[0] - start)) > NEAR:
        first = [round(float(value), 4) for value in poses[0]]
        expected = f"lengths of platform.start, {start.tolist()}"
        raise InvalidInputError(f"{given.name}: pose of the first row", first, expected)
    return TimedPoses(given.time, poses)


def poses_of(lengths: FloatArray, guess: FloatArray, geometry: StewartGeometry) -> FloatArray:
    """Poses [m, rad] (n, 6) of leg lengths [m] (n, 6), from a guess of the first."""
    g = geometry
    inverse = np.asarray(np.linalg.inv(pose_jacobian(guess, g.base, g.top, g.home)))
    return np.asarray(track_poses(lengths, guess.copy(), inverse, g.base, g.top, g.home))
