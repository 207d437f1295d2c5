"""coupling_matrix: how much strain energy joint motion puts into a flexible base."""

from __future__ import annotations

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.chain import SerialChain


def coupling_matrix(
    chain: SerialChain,
    base: EmulatedSystem,
    q: FloatArray,
) -> FloatArray:
    """Q(q), the sensitivity of the base to strain energy from the arm in a configuration.

    The thesis says what Q is for (4.2) and cites Torres (1993) for the matrix itself, which it
    does not print. Here it follows from the equations of motion for small motions and wrenches,
    (M + H_bb) Y'' + B Y' + K Y = -H_bq q''. A base that motion is slow for follows the wrench of
    the joint accelerations at once, so the strain energy is

        E = 1/2 Y' K Y = 1/2 q'' Q q'',   Q = H_bq' K^-1 H_bq   [J s^4/rad^2].

    Args:
        chain: the arm.
        base: the flexible base; its stiffness must be definite.
        q: joint angles [rad] (..., n).

    Returns:
        Q (..., n, n), symmetric, positive semi-definite.

    Raises:
        InvalidInputError: a base that can drift.
    """
    coupling = chain.mass_matrix(q)[..., :6, 6:]
    stiffness = (base.stiffness + base.stiffness.T) / 2
    if np.linalg.cond(stiffness) > 1e12:
        what = f"stiffness of {base.name}"
        raise InvalidInputError(what, "a singular matrix", "a base with a spring on every axis")
    return np.asarray(np.swapaxes(coupling, -1, -2) @ (np.linalg.inv(stiffness) @ coupling))


def coupling_length(
    chain: SerialChain,
    base: EmulatedSystem,
    path: FloatArray,
) -> float:
    """Integral of sqrt(dq' Q dq) along a path of joint angles (k, n): the darkness it crosses."""
    steps = np.diff(path, axis=0)
    q = coupling_matrix(chain, base, (path[1:] + path[:-1]) / 2)
    return float(np.sum(np.sqrt(np.maximum(np.einsum("ki,kij,kj->k", steps, q, steps), 0.0))))
