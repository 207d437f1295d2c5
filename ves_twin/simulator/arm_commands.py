"""arm_motion: what is asked of the arm, planned moves or what an operator did."""

from __future__ import annotations

import numpy as np

from ves_twin.control.timed import TimedJoints
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.joint_motion import ArmMotion, JointMotion, Move
from ves_twin.mechanics.path_motion import PathMotion
from ves_twin.scenario.motions import SetpointMotion
from ves_twin.scenario.operator import operator_motion
from ves_twin.scenario.schema import Arm, Scenario
from ves_twin.scenario.setpoint_file import read_setpoints

NEAR = 1e-3
"""How far the first command may lie from the arm's start [rad]: ten counts of the encoders."""


def arm_motion(scenario: Scenario) -> JointMotion:
    """The arm's moves, its path, the recorded commands of an operator, or set-points of a file.

    Raises:
        VesTwinError: a file that is missing, unreadable or cannot be followed, or one that commands
            an arm that is commanded otherwise, too.
    """
    arm, motion = scenario.arm, scenario.platform.motion
    if isinstance(motion, SetpointMotion):
        given = read_setpoints(motion.file)
        if given.arm is not None:
            return _setpoints(given.name, given.time, given.arm, arm)
    if arm.operator is not None:
        return operator_motion(arm.operator, np.array(arm.start))
    if arm.path is not None:
        places = np.vstack([arm.start, arm.path.through])
        return PathMotion(places, arm.path.start, arm.path.duration)
    moves = tuple(Move(m.start, m.duration, np.array(m.to)) for m in arm.moves)
    return ArmMotion(np.array(arm.start), moves)


def _setpoints(name: str, time: FloatArray, commands: FloatArray, arm: Arm) -> TimedJoints:
    if arm.moves or arm.path is not None or arm.operator is not None:
        expected = "no arm.moves, arm.path or arm.operator beside it"
        raise InvalidInputError(name, "set-points of the arm", expected)
    if np.max(np.abs(commands[0] - arm.start)) > NEAR:
        first = [round(float(angle), 4) for angle in commands[0]]
        raise InvalidInputError(f"{name}: first row", first, f"arm.start, {list(arm.start)}")
    return TimedJoints.through(time, commands)
