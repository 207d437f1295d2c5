"""arm_motion: what is asked of the arm, planned moves or what an operator did."""

from __future__ import annotations

import numpy as np

from ves_twin.control.motion import ArmMotion, JointMotion, Move
from ves_twin.control.path_motion import PathMotion
from ves_twin.scenario.operator import operator_motion
from ves_twin.scenario.schema import Scenario


def arm_motion(scenario: Scenario) -> JointMotion:
    """The arm's moves, its path, or the recorded commands of an operator.

    Raises:
        VesTwinError: an operator's file that is missing, unreadable or cannot be followed.
    """
    arm = scenario.arm
    if arm.operator is not None:
        return operator_motion(arm.operator, np.array(arm.start))
    if arm.path is not None:
        places = np.vstack([arm.start, arm.path.through])
        return PathMotion(places, arm.path.start, arm.path.duration)
    moves = tuple(Move(m.start, m.duration, np.array(m.to)) for m in arm.moves)
    return ArmMotion(np.array(arm.start), moves)
