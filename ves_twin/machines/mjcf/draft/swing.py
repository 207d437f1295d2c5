"""turns_of: the band of a joint that turns round and round, in which its efforts swing."""

from __future__ import annotations

import mujoco
import numpy as np

from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.motion import band_of
from ves_twin.machines.mjcf.draft.spots import Quantity
from ves_twin.machines.mjcf.parts.cyclic import is_cyclic

SHARE = 0.99
"""Of a column's power that lies in its band."""


def turns_of(log: LogColumns, match: Match, model: mujoco.MjModel, loops: bool = False) -> float:
    """Band [Hz] of an angle's sine and cosine; 0 where it turns less than once, or that is nothing.

    What turns at one speed is a ramp, which has no band, and a weight on it swings at its turns.

    Args:
        log: the columns.
        match: of a position, in the unit that it has.
        model: of the machine.
        loops: whether the model's loops make others follow, so that efforts hang on every angle.
    """
    if match.spot.quantity is not Quantity.POSITION or match.spot.unit != "rad":
        return 0.0
    angle = match.factor * log.column(match.column)
    if np.ptp(angle) < 2.0 * np.pi or not (loops or not is_cyclic(model, match.spot.name)):
        return 0.0
    return max(band_of(wave, log.period, SHARE) for wave in (np.sin(angle), np.cos(angle)))
