"""run_cycles: admittance cycles in a row without the interpreter, each followed by its ticks."""

from __future__ import annotations

import numpy as np

from ves_twin.control import gravity_law, platform_law
from ves_twin.control.gravity_law import changed, model_wrench
from ves_twin.control.platform_law import emulate
from ves_twin.control.safety import SAFE
from ves_twin.core.compiled import compiled
from ves_twin.core.types import Block, FloatArray, IntArray, SingleArray
from ves_twin.mechanics.kinematics.stewart import near_pose
from ves_twin.simulator.codes import RUNNING, SLOW
from ves_twin.simulator.law_step import RigLaws
from ves_twin.simulator.loop import run_ticks
from ves_twin.simulator.pose_of import read_pose
from ves_twin.simulator.setpoints import send_setpoints
from ves_twin.simulator.truth_port import gravity_wrench

AHEAD = np.dtype([("arm", np.float64, 3), ("pose", np.float64, 6), ("wrench", np.float64, 6)])
"""What is known of a cycle before it comes: the arm's command two cycles on [rad]; pose [m, rad]
and gravity wrench [N, N m], each used where its law is of kind KNOWN."""

SAMPLE = np.dtype(
    [
        ("pose", np.float64, 6),
        ("arm_q", np.float64, 3),
        ("leg_length", np.float64, 6),
        ("wrench", np.float64, 6),
        ("time", np.float64),
    ]
)
"""The end of a cycle: true pose [m, rad] and joint angles [rad]; readings of the legs [m] and of
the force sensor [N, N m]; when it was [s]."""


@compiled
def take_sample(
    sample: Block, time: float, qpos: FloatArray, parameters: Block, board: Block
) -> None:
    """Write how things stand at a time [s] into SAMPLE (1 or more,), the first of it."""
    one, p, b = sample[0], parameters[0], board[0]
    read_pose(p, qpos, one.pose)
    for j in range(3):
        one.arm_q[j] = qpos[p.layout.arm_qpos[j]]
    for i in range(6):
        one.leg_length[i] = b.leg_length[i]
        one.wrench[i] = b.sensor_wrench[i]
    one.time = time


@compiled
def pass_on(shared: FloatArray, passed: IntArray, wrench: FloatArray) -> FloatArray:
    """An estimate goes into shared memory; the one of `age` cycles ago, or the first, comes out.

    Args:
        shared: the last estimates, turned over (age + 1, 6).
        passed: how many there have been (1,); the caller counts the new one.
        wrench: the new one [N, N m] (6,).
    """
    n, size = passed[0], len(shared)
    shared[n % size] = wrench
    oldest: FloatArray = shared[(n + 1) % size if n + 1 >= size else 0]
    return oldest


@compiled
def _cycle(
    tick: int, time: float, ahead: Block, platform: Block, gravity: Block, shared: FloatArray,
    passed: IntArray, base: FloatArray, top: FloatArray, home: FloatArray,
    home_lengths: FloatArray, travel: float, weight: FloatArray, com: FloatArray,
    origin: FloatArray, axes: FloatArray, state: Block, board: Block,
) -> bool:  # fmt: skip
    """`Computers.cycle`; False, and nothing has changed, where that would refuse or raise."""
    known, law, base_law, b = ahead[0], gravity[0], platform[0], board[0]
    wrench, pose = known.wrench.copy(), law.pose.copy()
    if law.kind == gravity_law.MODEL:
        if not near_pose(b.leg_length.copy(), pose, base, top, home):
            return False
        wrench = changed(law, time, model_wrench(gravity, b.arm_q, pose[3:]))
    elif law.kind == gravity_law.TRUTH:
        wrench = changed(law, time, gravity_wrench(weight, com, origin, axes))
    if not np.all(np.isfinite(wrench)):
        return False
    estimate = pass_on(shared, passed, wrench)
    command, following = known.pose.copy(), np.empty(12)
    if base_law.kind == platform_law.EMULATES:
        command = emulate(platform, b.sensor_wrench, estimate, following)
    sent = send_setpoints(
        tick, command, known.arm, base, top, home, home_lengths, travel, state, board
    )
    if sent != SAFE:
        return False
    passed[0] += 1
    b.gravity_estimate[:] = estimate
    law.pose[:] = pose
    if base_law.kind == platform_law.EMULATES:
        base_law.state[:] = following
    return True


@compiled
def run_cycles(
    start: int, count: int, mj_step: int, mj_next: int, model: int, data: int, qpos: FloatArray,
    qvel: FloatArray, slides: FloatArray, speeds: FloatArray, ctrl: FloatArray,
    sensordata: FloatArray, laws: RigLaws, parameters: Block, state: Block, board: Block,
    row: FloatArray, fast_normal: SingleArray, slow_normal: SingleArray, weight: FloatArray,
    com: FloatArray, origin: FloatArray, axes: FloatArray, log: FloatArray, ticks: IntArray,
    first_rows: IntArray, points: FloatArray, logged: int, noted: int, samples: Block,
    ahead: Block, platform: Block, gravity: Block, shared: FloatArray, passed: IntArray,
    base: FloatArray, top: FloatArray, home: FloatArray, home_lengths: FloatArray, travel: float,
) -> tuple[int, int, int, int]:  # fmt: skip
    """Run cycles from an interrupt on, each: gravity, pose, set-points, ticks.

    A cycle that would refuse or raise is left undone: the interpreter does it and says why. Full
    buffers of cycles end it, too.

    From `start`, the tick of an interrupt, `count` ticks are run, the last cycle cut if need be. Up
    to `slow_normal` all is as `run_ticks` takes it, from `weight` to `axes` as `gravity_wrench`,
    from `log` to `noted` of a `Recorder` (rows; ticks, first rows and arm commands of cycles; how
    many rows and cycles there are). SAMPLE of the ends of cycles go where there is room. Then AHEAD
    of each cycle, both LAWs, `shared` and `passed` of `pass_on`, and from `base` to `travel` what
    `send_setpoints` takes.

    Returns:
        Code of the outcome, ticks done, rows and cycles in the buffers.
    """
    p, s = parameters[0], state[0]
    done, code, first = 0, RUNNING, noted
    while done < count and code == RUNNING and noted < len(ticks):
        k, tick = noted - first, start + done
        if not _cycle(
            tick, tick * p.clock.tick, ahead[k:], platform, gravity, shared, passed, base, top,
            home, home_lengths, travel, weight, com, origin, axes, state, board,
        ):  # fmt: skip
            break
        ticks[noted], first_rows[noted] = tick, logged
        points[noted] = s.servo.points
        noted += 1
        code, ran, logged = run_ticks(
            tick, min(p.clock.admittance, count - done), mj_step, mj_next, model, data, qpos, qvel,
            slides, speeds, ctrl, sensordata, laws, parameters, state, board, row,
            fast_normal[done:], slow_normal[(start % SLOW + done) // SLOW :], log, logged,
        )  # fmt: skip
        done += ran
        if k < len(samples):
            take_sample(samples[k:], (start + done) * p.clock.tick, qpos, parameters, board)
    return code, done, logged, noted
