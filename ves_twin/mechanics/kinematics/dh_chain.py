"""DhChain: link frames of any serial arm from its standard Denavit-Hartenberg table."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray


@dataclass(frozen=True)
class Joint:
    """One row of the table: rotation about z, then d along z, a along x, alpha about x.

    Attributes:
        d: offset along z [m]; of a prismatic joint what is added to its coordinate.
        a: length along x [m].
        alpha: twist about x [rad].
        theta: angle about z [rad]; of a revolute joint what is added to its coordinate.
        prismatic: whether the coordinate is d, not theta.
    """

    d: float
    a: float
    alpha: float
    theta: float = 0.0
    prismatic: bool = False


@dataclass(frozen=True)
class DhChain(ReadOnly):
    """An arm on the platform: link 0 stands on it, link i follows joint i.

    Attributes:
        joints: in the order from base to tip.
        base: frame 0 in the platform top frame t, homogeneous (4, 4).

    Source: thesis eq. 3.6, Appendix B.
    """

    joints: tuple[Joint, ...]
    base: FloatArray

    @property
    def identity(self) -> str:
        """Short hash of the geometry: files made for another arm can be told by it."""
        rows = [(j.d, j.a, j.alpha, j.theta, float(j.prismatic)) for j in self.joints]
        digest = hashlib.sha256(np.round(np.array(rows), 9).tobytes())
        digest.update(np.round(self.base, 9).tobytes())
        return digest.hexdigest()[:12]

    def frames(self, q: FloatArray) -> FloatArray:
        """Link frames 0 ... k in t.

        Args:
            q: joint coordinates [rad, m] (n, k).

        Returns:
            Homogeneous transforms (n, k + 1, 4, 4).

        Raises:
            InvalidInputError: another number of joints.
        """
        if q.ndim != 2 or q.shape[1] != len(self.joints):
            raise InvalidInputError(
                "joint coordinates", f"shape {q.shape}", f"(n, {len(self.joints)})"
            )
        frames = np.empty((len(q), len(self.joints) + 1, 4, 4))
        frames[:, 0] = self.base
        for i, joint in enumerate(self.joints):
            frames[:, i + 1] = frames[:, i] @ _transform(joint, q[:, i])
        return frames


def _transform(joint: Joint, q: FloatArray) -> FloatArray:
    """Frame of a link in the one before it (n, 4, 4) at q (n,). Source: thesis eq. 3.6, B.1."""
    theta = np.full_like(q, joint.theta) if joint.prismatic else q + joint.theta
    ct, st = np.cos(theta), np.sin(theta)
    ca, sa = np.cos(joint.alpha), np.sin(joint.alpha)
    t = np.zeros((len(q), 4, 4))
    t[:, 0, 0], t[:, 0, 1], t[:, 0, 2], t[:, 0, 3] = ct, -st * ca, st * sa, joint.a * ct
    t[:, 1, 0], t[:, 1, 1], t[:, 1, 2], t[:, 1, 3] = st, ct * ca, -ct * sa, joint.a * st
    t[:, 2, 1], t[:, 2, 2] = sa, ca
    t[:, 2, 3] = joint.d + q if joint.prismatic else joint.d
    t[:, 3, 3] = 1.0
    return t
