"""Puma560: transforms, Jacobians and inverse kinematics of the first three joints."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.errors import UnreachableError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.dh_chain import DhChain, Joint

ROUND_OFF = 1e-12
"""By how much squares of lengths [m^2] and cosines of an arm at its limits may be beyond them."""


@dataclass(frozen=True)
class Puma560:
    """PUMA 560 to the end of the forearm, base in the platform top frame t.

    Standard DH (rotation about z, alpha = 90, 0, 0 deg): joint 1 d = d0 + d1; joint 2 d = d2,
    a = a2; joint 3 d = d3, a = a3. At q = 0 arm and forearm lie along +X of t; q2 = 90 deg is up.

    Attributes:
        d0: arm mounting plane above t [m].
        d1: shoulder above the mounting plane [m].
        d2: offset of the upper arm along z1 [m].
        d3: offset of the forearm along z2 [m].
        a2: length of the upper arm [m].
        a3: length of the forearm [m].

    Source: thesis B.1, B.3, B.4, errata E-29, E-42.
    """

    d0: float
    d1: float
    d2: float
    d3: float
    a2: float
    a3: float

    @cached_property
    def chain(self) -> DhChain:
        """The arm as a table; frame 0 is its mounting plane, d0 above t."""
        base = np.eye(4)
        base[2, 3] = self.d0
        joints = (
            Joint(self.d1, 0.0, np.pi / 2),
            Joint(self.d2, self.a2, 0.0),
            Joint(self.d3, self.a3, 0.0),
        )
        return DhChain(joints, base)

    def transforms(self, q: FloatArray) -> FloatArray:
        """Link frames 1 to 3 in t at joint angles q [rad] (3,).

        Returns:
            Homogeneous transforms T_t1, T_t2, T_t3 (3, 4, 4).
        """
        return self.chain.frames(np.asarray(q)[None])[0, 1:]

    def axes(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Joint axes: a point on each [m] (3, 3) and its unit direction (3, 3), rows, in t."""
        frames = self.transforms(q)
        points = np.vstack([np.zeros(3), frames[0, :3, 3], frames[1, :3, 3]])
        directions = np.vstack([[0.0, 0.0, 1.0], frames[0, :3, 2], frames[1, :3, 2]])
        return points, directions

    def jacobian(self, q: FloatArray, point: FloatArray, link: int = 3) -> FloatArray:
        """Twist of a point fixed to a link per joint rate.

        Args:
            q: joint angles [rad] (3,).
            point: the point in t [m] (3,).
            link: link that carries the point, 1 to 3.

        Returns:
            J (6, 3): rows 0-2 velocity [m/rad], rows 3-5 angular velocity, in t.
        """
        points, directions = self.axes(q)
        jacobian = np.zeros((6, 3))
        for i in range(link):
            jacobian[:3, i] = np.cross(directions[i], np.asarray(point) - points[i])
            jacobian[3:, i] = directions[i]
        return jacobian

    def tip(self, q: FloatArray) -> FloatArray:
        """End of the forearm O3 in t [m] (3,)."""
        return np.array(self.transforms(q)[2, :3, 3])

    def inverse(self, tip: FloatArray, elbow: int = -1, shoulder: int = 1) -> FloatArray:
        """Joint angles that bring the end of the forearm to a point.

        With D = d2 + d3 the plane of the arm is e^{i q1} (r - i D), so
        q1 = atan2(y, x) + atan2(D, r), r = shoulder * sqrt(x^2 + y^2 - D^2); the rest is a
        two-link arm in (r, z).

        Args:
            tip: O3 in t [m] (3,).
            elbow: sign of q3, +1 or -1.
            shoulder: +1 reaches forward, -1 over the back.

        Returns:
            q [rad] (3,).

        Raises:
            UnreachableError: the point is outside the workspace; says by how much.
        """
        x, y, z = (float(v) for v in tip)
        offset = self.d2 + self.d3
        height = z - self.d0 - self.d1
        plane = x * x + y * y - offset * offset
        if not plane >= -ROUND_OFF:  # an arm that stands upright has its tip at the offset
            raise UnreachableError(
                f"arm tip {[x, y, z]} m is {np.hypot(x, y):.3f} m from the joint-1 axis,"
                f" nearer than the arm offset {abs(offset):.3f} m"
            )
        r = shoulder * np.sqrt(max(plane, 0.0))
        reach = r * r + height * height
        cosine = (reach - self.a2**2 - self.a3**2) / (2 * self.a2 * self.a3)
        if not abs(cosine) <= 1 + ROUND_OFF:  # of a stretched arm
            raise UnreachableError(
                f"arm tip {[x, y, z]} m is {np.sqrt(reach):.3f} m from the shoulder, reach is"
                f" {abs(self.a2 - self.a3):.3f} to {self.a2 + self.a3:.3f} m"
            )
        q3 = elbow * np.arccos(np.clip(cosine, -1.0, 1.0))
        q1 = np.arctan2(y, x) + np.arctan2(offset, r)
        q2 = np.arctan2(height, r) - np.arctan2(
            self.a3 * np.sin(q3), self.a2 + self.a3 * np.cos(q3)
        )
        q = np.array([q1, q2, q3])
        return np.asarray(np.arctan2(np.sin(q), np.cos(q)))
