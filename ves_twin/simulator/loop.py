"""run_ticks: the compiled inner loop between two admittance cycles."""

from __future__ import annotations

import numpy as np

from ves_twin.compiled import compiled
from ves_twin.control.arm_servo import servo_torque, spline
from ves_twin.control.leg_loop import control_legs
from ves_twin.kinematics.rotations import angles_from_matrix, matrix_from_quaternion
from ves_twin.plant.physics.cylinder import push_rods
from ves_twin.plant.physics.force_sensor import sample_wrench
from ves_twin.plant.physics.transducer import read_lengths
from ves_twin.plant.physics.valve import move_spool
from ves_twin.simulator.engine import call_engine
from ves_twin.types import Block, FloatArray, Record

# Copies of the constants of `noise` and `outcome` would drift, so they are imported as numbers.
from ves_twin.simulator.noise import ENCODER, LENGTH, PRESSURE, TORQUE, WANDER, WHITE
from ves_twin.simulator.outcome import (
    LEG_AT_LIMIT,
    NOT_FINITE,
    RUNNING,
    WRENCH_OUT_OF_RANGE,
)


@compiled
def _read_arm(
    p: Record, board: Record, q: FloatArray, torque: FloatArray, normal: FloatArray
) -> None:
    for j in range(3):
        angle = q[j] + p.noise.encoder * normal[ENCODER + j]
        count = p.noise.resolution[j]
        board.arm_q[j] = np.rint(angle / count) * count if count > 0.0 else angle
        board.arm_torque[j] = torque[j] + p.noise.torque[j] * normal[TORQUE + j]
        board.truth_arm_q[j] = q[j]


@compiled
def _drive_arm(
    p: Record, s: Record, board: Record, tick: int, qpos: FloatArray, qvel: FloatArray,
    ctrl: FloatArray, normal: FloatArray,
) -> None:  # fmt: skip
    q_set, rate_set, q, rate, torque = (
        np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    )  # fmt: skip
    u = (tick - s.cycle_start) / p.clock.admittance
    spline(s.servo.points, u, p.servo.cycle, q_set, rate_set)
    for j in range(3):
        q[j] = qpos[p.layout.arm_qpos[j]]
        rate[j] = qvel[p.layout.arm_dof[j]]
    servo_torque(p.servo, s.servo.integral, q_set, rate_set, q, rate, torque)
    for j in range(3):
        s.servo.integral[j] += p.servo.integral[j] * (q_set[j] - q[j]) * p.clock.tick
        ctrl[p.layout.arm_ctrl[j]] = torque[j]
        board.arm_command[j] = q_set[j]
    _read_arm(p, board, q, torque, normal)


@compiled
def _read_truth(p: Record, s: Record, board: Record, qpos: FloatArray) -> None:
    at = p.layout.platform_qpos
    angles = angles_from_matrix(matrix_from_quaternion(qpos[at + 3 : at + 7]))
    for i in range(3):
        board.truth_pose[i] = qpos[at + i] - p.home.position[i]
        board.truth_pose[3 + i] = angles[i]
    for i in range(6):
        board.truth_wrench[i] = s.sensor.true[i]
        board.truth_leg_force[i] = s.cylinder.force[i]
    for i in range(12):
        board.truth_leg_bending[i] = qpos[p.layout.bending_qpos[i]]


@compiled
def _push_legs(
    p: Record, s: Record, qpos: FloatArray, qvel: FloatArray, ctrl: FloatArray, step: float
) -> None:
    slide, speed = np.empty(6), np.empty(6)
    for i in range(6):
        slide[i] = qpos[p.layout.slide_qpos[i]]
        speed[i] = qvel[p.layout.slide_dof[i]]
    move_spool(p.valve, s.valve, s.current, step)
    push_rods(p.cylinder, s.cylinder, s.valve.mean, slide, speed, step)
    for i in range(6):
        ctrl[p.layout.leg_ctrl[i]] = s.cylinder.force[i]


@compiled
def _verdict(p: Record, qpos: FloatArray, inside: bool) -> int:
    for i in range(6):
        travel = qpos[p.layout.slide_qpos[i]]
        if not np.isfinite(travel):
            return NOT_FINITE
        if abs(travel) > p.limits.stroke:
            return LEG_AT_LIMIT
    for j in range(3):
        if not np.isfinite(qpos[p.layout.arm_qpos[j]]):
            return NOT_FINITE
    return RUNNING if inside else WRENCH_OUT_OF_RANGE


@compiled
def run_ticks(
    start: int,
    count: int,
    mj_step: int,
    model: int,
    data: int,
    qpos: FloatArray,
    qvel: FloatArray,
    ctrl: FloatArray,
    sensordata: FloatArray,
    parameters: Block,
    state: Block,
    board: Block,
    row: FloatArray,
    normal: FloatArray,
    log: FloatArray,
    logged: int,
) -> tuple[int, int, int]:
    """Run ticks: transducer, arm servo, leg loop, amplifier, log, hydraulics and mechanics, sensor.

    At tick k every reading is of the state at t_k; the force sensor's sample of t_k is ready at
    tick k + 1, since the forces of a step are known only after it.

    Args:
        start: first tick, negative while settling; nothing is logged before 0.
        count: how many ticks, not beyond the next admittance cycle.
        mj_step: address of mj_step.
        model: address of mjModel.
        data: address of mjData.
        qpos: live view of mjData.
        qvel: live view of mjData.
        ctrl: live view of mjData.
        sensordata: live view of mjData.
        parameters: PARAMETERS (1,).
        state: STATE (1,).
        board: signals of this instant (1,).
        row: the same as plain numbers.
        normal: standard normal numbers of these ticks (count, channels).
        log: buffer of rows (capacity, width).
        logged: rows in the buffer already.

    Returns:
        Code of the outcome, ticks done, rows in the buffer.
    """
    p, s, b = parameters[0], state[0], board[0]
    step = p.clock.tick / p.clock.substeps
    wrench = np.empty(6)
    for n in range(count):
        tick = start + n
        noise = normal[n]
        slide = np.empty(6)
        for i in range(6):
            slide[i] = qpos[p.layout.slide_qpos[i]]
        read_lengths(p.transducer, slide, noise[LENGTH:], b.leg_length)
        b.supply_pressure[0] = p.pressure + p.noise.pressure * noise[PRESSURE]
        _drive_arm(p, s, b, tick, qpos, qvel, ctrl, noise)
        if tick % p.clock.leg == 0:
            control_legs(p.legs, s.legs, b.leg_length, b.valve_command)
        if tick % p.clock.amplifier == 0:
            for i in range(6):
                s.current[i] = b.valve_command[i]
        if tick >= 0 and tick % p.clock.log == 0:
            _read_truth(p, s, b, qpos)
            log[logged, 0] = tick * p.clock.tick
            log[logged, 1:] = row
            logged += 1
        inside = True
        for k in range(p.clock.substeps):
            _push_legs(p, s, qpos, qvel, ctrl, step)
            call_engine(mj_step, model, data)
            if k == 0:  # later sub-steps carry the forces of later instants
                for i in range(6):
                    wrench[i] = -sensordata[p.layout.wrench_sensor + i]
                time = tick * p.clock.tick
                inside = sample_wrench(
                    p.sensor, s.sensor, wrench, time, noise[WHITE:], noise[WANDER:]
                )
        for i in range(6):
            b.sensor_wrench[i] = s.sensor.reading[i]
        code = _verdict(p, qpos, inside)
        if code != RUNNING:
            return code, n + 1, logged
    return RUNNING, count, logged
