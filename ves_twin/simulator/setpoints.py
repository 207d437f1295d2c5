"""send_setpoints: the end of a cycle in one compiled call: inverse kinematics, safety, sending."""

from __future__ import annotations

from ves_twin.control.safety import SAFE, checked_lengths
from ves_twin.core.compiled import compiled
from ves_twin.core.types import Block, FloatArray


@compiled
def send_setpoints(
    tick: int,
    pose: FloatArray,
    arm_ahead: FloatArray,
    base: FloatArray,
    top: FloatArray,
    home: FloatArray,
    home_lengths: FloatArray,
    travel: float,
    state: Block,
    board: Block,
) -> int:
    """Check a commanded pose and send it to the legs, and the arm's next command to its spline.

    Args:
        tick: tick of the interrupt.
        pose: commanded platform pose [m, rad] (6,).
        arm_ahead: joint angles two commands ahead [rad] (3,).
        base: base joints, inertial [m] (6, 3).
        top: platform joints in the top frame [m] (6, 3).
        home: origin of the top frame at home [m] (3,).
        home_lengths: leg lengths at home [m] (6,).
        travel: travel from home that commands may use [m].
        state: STATE (1,), takes the set-points.
        board: signals of this instant (1,), takes the commands.

    Returns:
        SAFE, or what `checked_lengths` found; then nothing is sent.
    """
    s, b = state[0], board[0]
    code = checked_lengths(pose, base, top, home, home_lengths, travel, s.work.lengths)
    if code != SAFE:
        return code
    for i in range(6):
        b.platform_command[i] = pose[i]
        b.leg_command[i] = s.work.lengths[i]
        s.legs.command[i] = s.work.lengths[i]
    s.cycle_start = tick
    for j in range(3):
        for k in range(3):
            s.servo.points[k, j] = s.servo.points[k + 1, j]
        s.servo.points[3, j] = arm_ahead[j]
    return SAFE
