"""SerialChain: an arm of revolute joints, what its links weigh, its mass matrix on a free base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.dh_chain import DhChain


@dataclass(frozen=True)
class SerialChain:
    """Rigid links 0 to n on revolute joints 1 to n; everything in the base frame at q = 0.

    Link 0 is fixed to the base. Axes and points instead of frames, so that any convention fits;
    `of` makes one from a Denavit-Hartenberg table.

    Attributes:
        points: a point on each joint axis [m] (n, 3).
        axes: unit direction of each joint axis (n, 3).
        mass: of each link [kg] (n + 1,).
        com: centre of mass of each link [m] (n + 1, 3).
        inertia: of each link about its centre of mass [kg m^2] (n + 1, 3, 3).
        armature: rotor inertia at the joint, through the gear squared [kg m^2] (n,).
        tip: end of the last link [m] (3,).
    """

    points: FloatArray
    axes: FloatArray
    mass: FloatArray
    com: FloatArray
    inertia: FloatArray
    armature: FloatArray
    tip: FloatArray

    def __post_init__(self) -> None:
        n = len(self.points)
        shapes = {
            "points": (n, 3),
            "axes": (n, 3),
            "mass": (n + 1,),
            "com": (n + 1, 3),
            "inertia": (n + 1, 3, 3),
            "armature": (n,),
            "tip": (3,),
        }
        for name, shape in shapes.items():
            value = np.asarray(getattr(self, name))
            if value.shape != shape:
                raise InvalidInputError(f"chain {name}", f"shape {value.shape}", f"{shape}")
        if n == 0 or not np.allclose(np.linalg.norm(self.axes, axis=1), 1.0, atol=1e-9):
            raise InvalidInputError("chain axes", self.axes.tolist(), "one or more unit vectors")
        if np.any(self.mass < 0) or np.any(self.armature < 0):
            raise InvalidInputError("chain mass and armature", self.mass.tolist(), "none below 0")

    @property
    def joints(self) -> int:
        """Number of joints n."""
        return len(self.points)

    @staticmethod
    def of(
        chain: DhChain, mass: FloatArray, com: FloatArray, inertia: FloatArray, armature: FloatArray
    ) -> SerialChain:
        """A chain from a Denavit-Hartenberg table and link data in the link frames.

        The point on joint axis i is O_(i-1) + d_i z_(i-1), so an offset d belongs to the link
        before the joint, as in thesis B.5.

        Args:
            chain: the table, of revolute joints, and where it stands in the base frame.
            mass: links 0 to n [kg] (n + 1,).
            com: in the link's own frame, link 0 in the mounting frame [m] (n + 1, 3).
            inertia: about the centre of mass, axes of the link frame (n + 1, 3, 3).
            armature: rotor inertia at the joint (n,).

        Raises:
            InvalidInputError: a prismatic joint.
        """
        if any(joint.prismatic for joint in chain.joints):
            raise InvalidInputError("chain", "a prismatic joint", "revolute joints")
        frames = chain.frames(np.zeros((1, len(chain.joints))))[0]
        rotation, origin = frames[:, :3, :3], frames[:, :3, 3]
        axes = rotation[:-1, :, 2]
        return SerialChain(
            points=origin[:-1] + np.array([[joint.d] for joint in chain.joints]) * axes,
            axes=axes,
            mass=np.asarray(mass, float),
            com=origin + np.einsum("kij,kj->ki", rotation, np.asarray(com, float)),
            inertia=rotation @ np.asarray(inertia, float) @ np.swapaxes(rotation, 1, 2),
            armature=np.asarray(armature, float),
            tip=origin[-1],
        )

    def displacements(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """How far each link has moved from where it is at q = 0: x -> R_k x + t_k.

        Args:
            q: joint angles [rad] (..., n).

        Returns:
            R (..., n + 1, 3, 3) and t [m] (..., n + 1, 3).
        """
        q = np.asarray(q, float)
        n = self.joints
        if q.shape[-1:] != (n,):
            raise InvalidInputError("joint angles", f"shape {q.shape}", f"{n} in the last place")
        rotation = np.zeros((*q.shape[:-1], n + 1, 3, 3))
        shift = np.zeros((*q.shape[:-1], n + 1, 3))
        rotation[..., 0, :, :] = np.eye(3)
        for k in range(n):
            turn = _rotations(self.axes[k], q[..., k])
            before = rotation[..., k, :, :]
            rotation[..., k + 1, :, :] = before @ turn
            back = self.points[k] - turn @ self.points[k]
            shift[..., k + 1, :] = shift[..., k, :] + np.einsum("...ij,...j->...i", before, back)
        return rotation, shift

    def axes_at(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Points on the joint axes [m] and their directions, (..., n, 3) each, at q (..., n)."""
        rotation, shift = self.displacements(q)
        before = rotation[..., :-1, :, :]
        points = np.einsum("...kij,kj->...ki", before, self.points) + shift[..., :-1, :]
        return points, np.einsum("...kij,kj->...ki", before, self.axes)

    def coms_at(self, q: FloatArray) -> FloatArray:
        """Centres of mass of the links [m] (..., n + 1, 3) at q (..., n)."""
        rotation, shift = self.displacements(q)
        return np.asarray(np.einsum("...kij,kj->...ki", rotation, self.com) + shift)

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Mass matrix of the arm for the rates (V, omega of the base; q'), about the base origin.

        H = sum_k m_k Jv_k' Jv_k + Jw_k' R_k I_k R_k' Jw_k + diag(0, armature), with
        Jv_k = [1, -c_k x, z_j x (c_k - p_j)] and Jw_k = [0, 1, z_j], j up to the link's own joint.

        Args:
            q: joint angles [rad] (..., n).

        Returns:
            H (..., 6 + n, 6 + n), symmetric [kg, kg m, kg m^2].

        Source: thesis Appendix G for any chain; errata E-34 to E-36.
        """
        rotation, _ = self.displacements(q)
        centres = self.coms_at(q)
        points, axes = self.axes_at(q)
        n = self.joints
        linear = np.zeros((*centres.shape[:-1], 3, 6 + n))
        angular = np.zeros_like(linear)
        linear[..., :3] = np.eye(3)
        linear[..., 3:6] = -skew(centres)
        angular[..., 3:6] = np.eye(3)
        for j in range(n):
            arm = centres[..., j + 1 :, :] - points[..., j : j + 1, :]
            axis = axes[..., j : j + 1, :]
            linear[..., j + 1 :, :, 6 + j] = np.cross(np.broadcast_to(axis, arm.shape), arm)
            angular[..., j + 1 :, :, 6 + j] = axis
        inertia = rotation @ self.inertia @ np.swapaxes(rotation, -1, -2)
        moving = self.mass[:, None, None] * linear
        links = np.swapaxes(linear, -1, -2) @ moving
        links += np.swapaxes(angular, -1, -2) @ (inertia @ angular)
        total = np.sum(links, axis=-3)
        diagonal = np.arange(6, 6 + n)
        total[..., diagonal, diagonal] += self.armature
        return np.asarray(total)


def skew(vectors: FloatArray) -> FloatArray:
    """Matrices (..., 3, 3) of the cross product with vectors (..., 3)."""
    matrices = np.zeros((*vectors.shape, 3))
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    matrices[..., 0, 1], matrices[..., 0, 2] = -z, y
    matrices[..., 1, 0], matrices[..., 1, 2] = z, -x
    matrices[..., 2, 0], matrices[..., 2, 1] = -y, x
    return matrices


def _rotations(axis: FloatArray, angle: FloatArray) -> FloatArray:
    """Rodrigues: rotations (..., 3, 3) about a unit axis (3,) by angles (...)."""
    cross = skew(axis)
    sine, cosine = np.sin(angle)[..., None, None], np.cos(angle)[..., None, None]
    return np.asarray(np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross))
