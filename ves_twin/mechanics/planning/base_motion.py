"""base_motion: how a flexible base moves while the joints follow given angles."""

from __future__ import annotations

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.chain import SerialChain


def base_motion(
    chain: SerialChain, base: EmulatedSystem, q: FloatArray, period: float
) -> FloatArray:
    """Motion of the base, from rest, under joints that follow q exactly; base angles small.

    The momentum p = (M + H_bb(q)) Y' + H_bq(q) q' obeys p' = -K Y - B Y', integrated by the
    midpoint rule of the linear base with H held over a step, which conserves momentum exactly.

    Args:
        chain: the arm.
        base: the flexible base.
        q: joint angles, a row each period [rad] (k, n), or (paths, k, n) for several at once.
        period: time between rows [s].

    Returns:
        Y (k, 6) or (paths, k, 6) [m, rad].

    Raises:
        InvalidInputError: fewer than three rows.
    """
    q = np.asarray(q, float)
    if q.ndim not in {2, 3} or q.shape[-2] < 3:
        raise InvalidInputError("joint angles", f"shape {q.shape}", "three or more rows")
    if q.ndim == 2:
        return np.asarray(base_motion(chain, base, q[None], period)[0])
    middle = chain.mass_matrix((q[:, 1:] + q[:, :-1]) / 2)
    rates = np.diff(q, axis=1) / period
    carried = np.einsum("pkij,pkj->pki", middle[..., :6, 6:], rates)
    inertia = base.mass + middle[..., :6, :6]
    half = period / 2
    # Y1 = Y0 + h v, p1 = p0 - h K (Y0 + Y1)/2 - h B v, (p0 + p1)/2 = inertia v + carried
    matrix = inertia + half * base.damping + half * half * base.stiffness
    pose = np.zeros((len(q), 6))
    momentum = np.zeros((len(q), 6))
    poses = np.zeros((*q.shape[:2], 6))
    for k in range(q.shape[1] - 1):
        load = momentum - carried[:, k] - half * pose @ base.stiffness.T
        velocity = np.linalg.solve(matrix[:, k], load[..., None])[..., 0]
        middle_pose = pose + half * velocity
        force = middle_pose @ base.stiffness.T + velocity @ base.damping.T
        momentum = momentum - period * force
        pose = pose + period * velocity
        poses[:, k + 1] = pose
    return poses
