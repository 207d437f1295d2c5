"""link_transform: frame of a link in the one before it, from a Denavit-Hartenberg row."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray


def link_transform(theta: float, d: float, a: float, alpha: float) -> FloatArray:
    """Homogeneous transform (4, 4) of standard Denavit-Hartenberg parameters.

    Rotation by theta [rad] about z, then d [m] along z, a [m] along x, alpha [rad] about x.

    Source: thesis eq. 3.6, B.1.
    """
    ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return np.array(
        [
            [ct, -st * ca, st * sa, a * ct],
            [st, ct * ca, -ct * sa, a * st],
            [0.0, sa, ca, d],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
