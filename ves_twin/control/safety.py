"""checked_lengths: inverse kinematics of a command, held against the legs' travel."""

from __future__ import annotations

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.stewart import leg_lengths

SAFE, NOT_A_POSE = 0, -1


@compiled
def checked_lengths(
    pose: FloatArray,
    base: FloatArray,
    top: FloatArray,
    home: FloatArray,
    home_lengths: FloatArray,
    travel: float,
    lengths: FloatArray,
) -> int:
    """Leg lengths of a commanded pose, checked every cycle before they are sent.

    Args:
        pose: command from home [m, rad] (6,).
        base: base joints, inertial [m] (6, 3).
        top: platform joints in the top frame [m] (6, 3).
        home: origin of the top frame at home [m] (3,).
        home_lengths: leg lengths at home [m] (6,).
        travel: travel from home that commands may use [m].
        lengths: result [m] (6,).

    Returns:
        SAFE; the number (1 to 6) of the first leg that would leave its travel; or NOT_A_POSE
        where the command is not six finite numbers.

    Source: thesis 2.4.2 (safety checks on leg lengths, margins not given).
    """
    if pose.shape[0] != 6 or not np.all(np.isfinite(pose)):
        return NOT_A_POSE
    lengths[:] = leg_lengths(pose, base, top, home)
    for i in range(6):
        if abs(lengths[i] - home_lengths[i]) > travel:
            return i + 1
    return SAFE
