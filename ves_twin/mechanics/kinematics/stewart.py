"""StewartGeometry: inverse and forward kinematics and leg Jacobian of the six-leg platform."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.errors import UnreachableError
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.rotations import matrix_from_angles, rate_matrix

FK_TOLERANCE = 1e-12
"""Newton ends when every leg agrees to this [m]: round-off of double precision over 1 m."""
FK_ITERATIONS = 50

NO_POSE = 1e-9
"""Leg error that means there is no such pose [m]; Newton stalls at round-off well below it."""


@compiled
def leg_lengths(
    pose: FloatArray, base: FloatArray, top: FloatArray, home: FloatArray
) -> FloatArray:
    """Pin-to-pin leg lengths at a pose: |home + p + R b_i - a_i|.

    Args:
        pose: X, Y, Z [m] from home and fixed-axis angles [rad] (6,).
        base: base joints in the inertial frame [m] (6, 3).
        top: platform joints in the top frame t [m] (6, 3).
        home: origin of t at home [m] (3,).

    Returns:
        Lengths [m] (6,).
    """
    r = matrix_from_angles(pose[3:6])
    lengths = np.empty(6)
    for i in range(6):
        total = 0.0
        for k in range(3):
            d = home[k] + pose[k] - base[i, k]
            for j in range(3):
                d += r[k, j] * top[i, j]
            total += d * d
        lengths[i] = np.sqrt(total)
    return lengths


@compiled
def leg_jacobian(
    pose: FloatArray, base: FloatArray, top: FloatArray, home: FloatArray
) -> FloatArray:
    """Leg rates per twist of t: dL_i = u_i . v + (R b_i x u_i) . w.

    Returns:
        J (6, 6); columns 0-2 [m/m] linear velocity, 3-5 [m/rad] angular velocity, inertial axes.
    """
    r = matrix_from_angles(pose[3:6])
    jacobian = np.empty((6, 6))
    arm = np.empty(3)
    for i in range(6):
        np.dot(r, top[i], arm)
        row = jacobian[i]
        square = 0.0
        for k in range(3):
            row[k] = home[k] + pose[k] + arm[k] - base[i, k]
            square += row[k] * row[k]
        length = np.sqrt(square)
        for k in range(3):
            row[k] /= length
        row[3] = arm[1] * row[2] - arm[2] * row[1]
        row[4] = arm[2] * row[0] - arm[0] * row[2]
        row[5] = arm[0] * row[1] - arm[1] * row[0]
    return jacobian


@compiled
def pose_jacobian(
    pose: FloatArray, base: FloatArray, top: FloatArray, home: FloatArray
) -> FloatArray:
    """Leg rates (6, 6) per rate of the pose: columns 3-5 [m/rad] per rate of the angles."""
    jacobian = leg_jacobian(pose, base, top, home)
    jacobian[:, 3:] = np.ascontiguousarray(jacobian[:, 3:]) @ rate_matrix(pose[3:])
    return jacobian


@compiled
def solve_pose(
    lengths: FloatArray,
    guess: FloatArray,
    base: FloatArray,
    top: FloatArray,
    home: FloatArray,
    tolerance: float,
    iterations: int,
) -> tuple[FloatArray, float]:
    """Pose (6,) of given lengths by Newton from a guess, and the largest leg error left [m]."""
    pose = guess.copy()
    worst = np.inf
    for _ in range(iterations):
        error = lengths - leg_lengths(pose, base, top, home)
        worst = np.max(np.abs(error))
        if worst < tolerance or not np.isfinite(worst):
            break
        pose += np.linalg.solve(pose_jacobian(pose, base, top, home), error)
    return pose, worst


@compiled
def near_pose(
    lengths: FloatArray, pose: FloatArray, base: FloatArray, top: FloatArray, home: FloatArray
) -> bool:
    """Move a pose (6,) to the one near it that has given lengths; False if there is none."""
    try:
        found, worst = solve_pose(lengths, pose, base, top, home, FK_TOLERANCE, FK_ITERATIONS)
    except Exception:  # Newton ran into a singular pose; compiled code knows no other class
        return False
    pose[:] = found
    return worst < NO_POSE


@compiled
def track_poses(
    lengths: FloatArray,
    pose: FloatArray,
    inverse: FloatArray,
    base: FloatArray,
    top: FloatArray,
    home: FloatArray,
) -> FloatArray:
    """Poses (n, 6) of a time series of lengths (n, 6), each solved from the one before.

    Chord steps with the inverse Jacobian of an earlier row, Newton where they do not converge.
    All memory is in the arguments, so a series cut into pieces gives the same bits as a whole.

    Args:
        lengths: leg lengths, a row per instant [m] (n, 6).
        pose: pose of the row before [m, rad] (6,); holds the last pose on return.
        inverse: inverse of `pose_jacobian` near there (6, 6); kept up to date.
        base: base joints, inertial [m] (6, 3).
        top: platform joints in the top frame [m] (6, 3).
        home: origin of the top frame at home [m] (3,).

    Returns:
        Poses [m, rad] (n, 6).
    """
    poses = np.empty_like(lengths)
    for n in range(lengths.shape[0]):
        guess = pose.copy()
        left = np.inf
        chords = 0
        while chords < 8 and not left < 1e-11:
            error = lengths[n] - leg_lengths(guess, base, top, home)
            left = np.max(np.abs(error))
            guess += inverse @ error
            chords += 1
        if not left < 1e-11:
            guess, _ = solve_pose(lengths[n], pose, base, top, home, 1e-11, 50)
        if chords > 4:  # the Jacobian has aged
            inverse[:] = np.linalg.inv(pose_jacobian(guess, base, top, home))
        pose[:] = guess
        poses[n] = guess
    return poses


@dataclass(frozen=True)
class StewartGeometry(ReadOnly):
    """Joint positions of a six-leg platform.

    Attributes:
        base: base joints in the inertial frame [m] (6, 3).
        top: platform joints in the top frame t [m] (6, 3).
        home: origin of t at platform home in the inertial frame [m] (3,).
    """

    base: FloatArray
    top: FloatArray
    home: FloatArray

    def lengths(self, pose: FloatArray) -> FloatArray:
        """Inverse kinematics: leg lengths [m] (6,) at a pose (6,)."""
        return leg_lengths(pose, self.base, self.top, self.home)

    def jacobian(self, pose: FloatArray) -> FloatArray:
        """Leg rates (6, 6) per twist of t in inertial axes, see `leg_jacobian`."""
        return leg_jacobian(pose, self.base, self.top, self.home)

    def pose(self, lengths: FloatArray, guess: FloatArray | None = None) -> FloatArray:
        """Forward kinematics: the pose (6,) near `guess` (home if left out) at given lengths.

        Raises:
            UnreachableError: no pose near the guess has these lengths.
        """
        pose = np.zeros(6) if guess is None else np.array(guess, dtype=float)
        target = np.asarray(lengths, dtype=float)
        if not near_pose(target, pose, self.base, self.top, self.home):
            raise UnreachableError(
                f"no platform pose near the guess has leg lengths {np.round(target, 4).tolist()} m"
            )
        return pose

    @staticmethod
    def symmetric(
        base_radius: float,
        top_radius: float,
        base_half_angle: float,
        top_half_angle: float,
        joint_height: float,
        top_offset: float,
    ) -> StewartGeometry:
        """Three pairs of joints on two circles, the platform's pairs turned by 60 deg.

        Args:
            base_radius: circle of the base joints [m].
            top_radius: circle of the platform joints [m].
            base_half_angle: half the angle between the joints of a base pair [rad].
            top_half_angle: the same on the platform [rad].
            joint_height: platform joint plane above the base joint plane at home [m].
            top_offset: top plate (frame t) above the platform joint plane [m].
        """
        thirds = np.radians([0.0, 120.0, 240.0])
        base_angles = np.ravel(
            np.column_stack([thirds - base_half_angle, thirds + base_half_angle])
        )
        sixth = np.pi / 3
        top_angles = np.ravel(
            np.column_stack([thirds - sixth + top_half_angle, thirds + sixth - top_half_angle])
        )
        flat = np.zeros(6)
        base = base_radius * np.column_stack([np.cos(base_angles), np.sin(base_angles), flat])
        top = top_radius * np.column_stack([np.cos(top_angles), np.sin(top_angles), flat])
        top[:, 2] = -top_offset
        return StewartGeometry(base, top, np.array([0.0, 0.0, joint_height + top_offset]))
