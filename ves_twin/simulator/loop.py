"""run_ticks: the compiled inner loop between two admittance cycles."""

from __future__ import annotations

import numpy as np

from ves_twin.control.arm_servo import servo_torque, spline
from ves_twin.control.leg_loop import control_legs
from ves_twin.core.compiled import compiled
from ves_twin.core.types import Block, FloatArray, Record, SingleArray
from ves_twin.plant.hydraulics import PRESSURE_FORM
from ves_twin.plant.physics.chambers import push_rods_by_pressure
from ves_twin.plant.physics.cylinder import push_rods
from ves_twin.plant.physics.delay import take_late
from ves_twin.plant.physics.force_sensor import sample_wrench, wander_on
from ves_twin.plant.physics.supply import feed_manifold
from ves_twin.plant.physics.transducer import read_lengths
from ves_twin.plant.physics.valve import move_spool
from ves_twin.simulator.codes import (
    HUGE,
    LEG_AT_LIMIT,
    LENGTH,
    NOT_FINITE,
    PRESSURE,
    RUNNING,
    SLOW,
    TORQUE,
    WANDER,
    WHITE,
    WRENCH_OUT_OF_RANGE,
)
from ves_twin.simulator.engine import NO_CALL, call_engine
from ves_twin.simulator.law_step import RigLaws, look, push_laws, read_laws
from ves_twin.simulator.pose_of import read_pose


@compiled
def _drive_arm(
    p: Record, s: Record, board: Record, tick: int, qpos: FloatArray, qvel: FloatArray,
    ctrl: FloatArray, slow: SingleArray,
) -> None:  # fmt: skip
    work = s.work
    u = (tick - s.cycle_start) / p.clock.admittance
    spline(s.servo.points, u, p.servo.cycle, work.q_set, work.rate_set)
    for j in range(3):
        board.arm_command[j] = work.q_set[j]
    if p.late.setpoint.kept:
        take_late(p.late.setpoint, s.late.angle_past, work.q_set, work.q_set)
        take_late(p.late.setpoint, s.late.rate_past, work.rate_set, work.rate_set)
    for j in range(3):
        work.q[j] = qpos[p.layout.arm_qpos[j]] + p.drive.encoder_offset[j]
        work.rate[j] = qvel[p.layout.arm_dof[j]]
        work.added[j] = s.servo.integral[j] + s.servo.feedforward[j]
    servo_torque(p.servo, work.added, work.q_set, work.rate_set, work.q, work.rate, work.torque)
    for j in range(3):
        error = work.q_set[j] - work.q[j]
        s.servo.integral[j] += p.servo.integral[j] * error * p.clock.tick
        ctrl[p.layout.arm_ctrl[j]] = work.torque[j] * p.drive.torque_gain[j]
        count = p.noise.encoder_count[j]
        board.arm_q[j] = np.rint(work.q[j] / count) * count if count > 0.0 else work.q[j]
        board.arm_torque[j] = work.torque[j] + p.noise.torque[j] * slow[TORQUE + j]
        board.truth_arm_q[j] = qpos[p.layout.arm_qpos[j]]


@compiled
def _read_truth(p: Record, s: Record, board: Record, qpos: FloatArray) -> None:
    read_pose(p, qpos, board.truth_pose)
    for i in range(6):
        board.truth_wrench[i] = s.sensor.true[i]
        board.truth_leg_force[i] = s.rod_force[i]
    for i in range(p.layout.bends):
        board.truth_leg_bending[i] = qpos[p.layout.bending_qpos[i]]


@compiled
def _push_legs(
    p: Record, s: Record, slides: FloatArray, speeds: FloatArray, ctrl: FloatArray, step: float
) -> None:
    work = s.work
    for i in range(6):
        work.slide[i] = slides[p.layout.slide_at[i]] - p.layout.slide_home[i]
        work.speed[i] = speeds[p.layout.speed_at[i]]
    move_spool(p.valve, s.valve, s.current, step)
    spool, force = s.valve.mean, s.rod_force
    if p.hydraulics == PRESSURE_FORM:
        demand, slope = push_rods_by_pressure(
            p.chambers, s.chambers, force, spool, work.slide, work.speed, s.supply.manifold, step
        )
        feed_manifold(p.supply, s.supply, demand, slope, step)
    else:
        push_rods(p.cylinder, s.cylinder, force, spool, work.slide, work.speed, step)
    for i in range(6):
        ctrl[p.layout.leg_ctrl[i]] = force[i]


@compiled
def _read_and_command(
    p: Record, s: Record, board: Record, tick: int, qpos: FloatArray, qvel: FloatArray,
    slides: FloatArray, ctrl: FloatArray, fast: SingleArray, slow: SingleArray,
) -> None:  # fmt: skip
    """Transducers, gauge, arm servo, and the leg loop and amplifiers when their clocks strike."""
    for i in range(6):
        s.work.slide[i] = slides[p.layout.slide_at[i]] - p.layout.slide_home[i]
    if p.late.slide.kept:
        take_late(p.late.slide, s.late.slide_past, s.work.slide, s.work.slide)
    read_lengths(p.transducer, s.work.slide, fast[LENGTH:], board.leg_length)
    board.supply_pressure[0] = s.supply.manifold + p.noise.pressure * slow[PRESSURE]
    _drive_arm(p, s, board, tick, qpos, qvel, ctrl, slow)
    if tick % p.clock.leg == 0:
        control_legs(p.legs, s.legs, board.leg_length, board.valve_command)
    output = s.late.sent if p.late.current.kept else s.current
    if tick % p.clock.amplifier == 0:
        for i in range(6):
            output[i] = board.valve_command[i]
    if p.late.current.kept:
        take_late(p.late.current, s.late.current_past, s.late.sent, s.current)


@compiled
def _sample(p: Record, s: Record, time: float, sensordata: FloatArray, fast: SingleArray) -> bool:
    """The force sensor's sample of a tick's start: later sub-steps carry forces of later times."""
    for i in range(6):
        s.work.wrench[i] = -sensordata[p.layout.wrench_sensor + i]
    if p.late.wrench.kept:
        take_late(p.late.wrench, s.late.wrench_past, s.work.wrench, s.work.wrench)
    inside = sample_wrench(p.sensor, s.sensor, s.work.wrench, time, fast[WHITE:])
    if p.late.wrench.kept:
        for i in range(6):
            s.sensor.true[i] = -sensordata[p.layout.wrench_sensor + i]
    return inside


@compiled
def _move_rig(
    p: Record, s: Record, time: float, mj_step: int, mj_next: int, model: int, data: int,
    slides: FloatArray, speeds: FloatArray, ctrl: FloatArray, sensordata: FloatArray,
    fast: SingleArray,
) -> bool:  # fmt: skip
    """The physics of one tick, and the force sensor's sample of its start."""
    inside = True
    step = p.clock.tick / p.clock.substeps
    for k in range(p.clock.substeps):
        _push_legs(p, s, slides, speeds, ctrl, step)
        call_engine(mj_step, model, data)
        if mj_next != NO_CALL:
            call_engine(mj_next, model, data)
        if k == 0:
            inside = _sample(p, s, time, sensordata, fast)
    return inside


@compiled
def _move_lawful(
    p: Record, s: Record, time: float, mj_step: int, mj_next: int, model: int, data: int,
    qpos: FloatArray, qvel: FloatArray, slides: FloatArray, speeds: FloatArray, ctrl: FloatArray,
    sensordata: FloatArray, laws: RigLaws, fast: SingleArray,
) -> bool:  # fmt: skip
    """The same with laws at each step: to hand them on costs a rig without any 4 % of its time."""
    inside = True
    step = p.clock.tick / p.clock.substeps
    for k in range(p.clock.substeps):
        _push_legs(p, s, slides, speeds, ctrl, step)
        look(p, s, qpos, qvel, slides, speeds, laws)
        push_laws(p, s, time + k * step, ctrl, laws)
        call_engine(mj_step, model, data)
        if mj_next != NO_CALL:
            call_engine(mj_next, model, data)
        if k == 0:
            inside = _sample(p, s, time, sensordata, fast)
    return inside


@compiled
def _verdict(p: Record, qpos: FloatArray, slides: FloatArray, inside: bool) -> int:
    for i in range(6):
        travel = slides[p.layout.slide_at[i]] - p.layout.slide_home[i]
        if not abs(travel) < HUGE:
            return NOT_FINITE
        if abs(travel) > p.limits.stroke:
            return LEG_AT_LIMIT
    for j in range(3):
        if not abs(qpos[p.layout.arm_qpos[j]]) < HUGE:
            return NOT_FINITE
    return RUNNING if inside else WRENCH_OUT_OF_RANGE


@compiled
def run_ticks(
    start: int, count: int, mj_step: int, mj_next: int, model: int, data: int, qpos: FloatArray,
    qvel: FloatArray, slides: FloatArray, speeds: FloatArray, ctrl: FloatArray,
    sensordata: FloatArray, laws: RigLaws, parameters: Block, state: Block, board: Block,
    row: FloatArray, fast_normal: SingleArray, slow_normal: SingleArray, log: FloatArray,
    logged: int,
) -> tuple[int, int, int]:  # fmt: skip
    """Run ticks: transducer, arm servo, leg loop, amplifier, log, hydraulics and mechanics, sensor.

    At tick k every reading is of the state at t_k; the force sensor's sample of t_k is ready at
    tick k + 1, since the forces of a step are known only after it.

    Args:
        start: first tick, negative while settling; nothing is logged before 0.
        count: how many ticks, not beyond the next admittance cycle.
        mj_step: address of the function that advances the physics by a step.
        mj_next: address of one that is called after it, or NO_CALL.
        model: address of mjModel.
        data: address of mjData.
        qpos: live view of mjData.
        qvel: live view of mjData.
        slides: live view of mjData that holds the rods' travel, see `Layout`.
        speeds: the same for the rods' speed.
        ctrl: live view of mjData.
        sensordata: live view of mjData.
        laws: functions that the plant has beyond its numbers.
        parameters: PARAMETERS (1,).
        state: STATE (1,).
        board: signals of this instant (1,).
        row: the same as plain numbers.
        fast_normal: standard normal numbers of these ticks (count, FAST_CHANNELS).
        slow_normal: a number per SLOW ticks, from that of `start` on (n, SLOW_CHANNELS).
        log: buffer of rows (capacity, width).
        logged: rows in the buffer already.

    Returns:
        Code of the outcome, ticks done, rows in the buffer.
    """
    p, s, b = parameters[0], state[0], board[0]
    for n in range(count):
        tick = start + n
        time = tick * p.clock.tick
        fast, slow = fast_normal[n], slow_normal[(start % SLOW + n) // SLOW]
        if tick % SLOW == 0:
            wander_on(p.sensor, s.sensor, slow[WANDER:])
        _read_and_command(p, s, b, tick, qpos, qvel, slides, ctrl, fast, slow)
        if tick >= 0 and tick % p.clock.log == 0:
            _read_truth(p, s, b, qpos)
            log[logged, 0] = time
            log[logged, 1:] = row
            if len(laws.readings.codes):
                look(p, s, qpos, qvel, slides, speeds, laws)
                read_laws(time, laws, log[logged, 1:], True)
            logged += 1
        if len(laws.efforts.codes):
            inside = _move_lawful(
                p, s, time, mj_step, mj_next, model, data, qpos, qvel, slides, speeds, ctrl,
                sensordata, laws, fast,
            )  # fmt: skip
        else:
            inside = _move_rig(
                p, s, time, mj_step, mj_next, model, data, slides, speeds, ctrl, sensordata, fast
            )  # fmt: skip
        for i in range(6):
            b.sensor_wrench[i] = s.sensor.reading[i]
        if len(laws.readings.codes):
            look(p, s, qpos, qvel, slides, speeds, laws)
            read_laws(time + p.clock.tick, laws, row, False)
        code = _verdict(p, qpos, slides, inside)
        if code != RUNNING:
            return code, n + 1, logged
    return RUNNING, count, logged
