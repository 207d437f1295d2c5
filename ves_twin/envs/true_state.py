"""true_state: pose and joint angles of a rig at this instant, for rewards and analysis."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.simulator.cycles import SAMPLE
from ves_twin.simulator.rig import Rig


def true_state(rig: Rig) -> tuple[FloatArray, FloatArray]:
    """Pose from home [m, rad] (6,) and joint angles [rad] (3,), as `truth.pose`, `truth.arm_q`."""
    sample = np.zeros(1, SAMPLE)
    rig.sample(sample)
    return sample["pose"][0].copy(), sample["arm_q"][0].copy()
