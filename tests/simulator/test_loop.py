"""The parts of the compiled loop one by one, on a rig that was never run."""

from __future__ import annotations

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.plant.physics.delay import count_ticks
from ves_twin.simulator import loop
from ves_twin.simulator.build import belief_of
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.codes import (
    HUGE,
    LEG_AT_LIMIT,
    NOT_FINITE,
    PRESSURE,
    RUNNING,
    SLOW_CHANNELS,
    TORQUE,
    WRENCH_OUT_OF_RANGE,
)
from ves_twin.simulator.noise import NoiseStreams
from ves_twin.simulator.rig import Rig
from ves_twin.simulator.signal_bus import SLICES, WIDTH

FAST = np.zeros(12, np.float32)
SLOW = np.arange(1, SLOW_CHANNELS + 1, dtype=np.float32)
"""A number of its own for each slow channel."""


COMPUTERS = ("leg.command", "gravity.estimate", "platform.command", "platform.pose")
"""Signals of the board that others write."""


def standing(noise: bool) -> Rig:
    scenario = vt.Scenario.load("position_sine", {"run.log": "leg"})
    plant = vt.Plant.load(scenario.plant)
    clock = Clock.of(scenario, plant.parameters)
    made = Rig(plant, clock, scenario.legs, belief_of(scenario), NoiseStreams(0, noise))
    made.state["legs"]["command"] = made.parameters["transducer"]["home"]
    return made


@pytest.fixture
def rig():
    made = standing(noise=False)
    made.data.qpos[:] = made.model.qpos0
    made.state["servo"]["points"] = np.arange(12.0).reshape(4, 3) ** 2
    made.state["supply"]["manifold"] = 2e7
    return made


def parts(rig):
    return rig.parameters[0], rig.state[0], rig.board.block[0]


def drive(rig, tick, slow=SLOW):
    data = rig.data
    loop._drive_arm(*parts(rig), tick, data.qpos, data.qvel, data.ctrl, slow)
    return rig.state["work"]["q_set"][0].copy(), rig.state["work"]["rate_set"][0].copy()


def command(rig, tick):
    p, s, b = parts(rig)
    slides, _ = rig.layout.slide_arrays(rig.data)
    qpos, qvel, ctrl = rig.data.qpos, rig.data.qvel, rig.data.ctrl
    loop._read_and_command(p, s, b, tick, qpos, qvel, slides, ctrl, FAST, SLOW)


def test_a_late_setpoint_reaches_the_servo_so_many_ticks_later(rig):
    usual = [drive(rig, tick) for tick in range(12)]
    rig.parameters["late"]["setpoint"]["delay"] = 5.0 * rig.clock.tick
    count_ticks(rig.parameters[0]["late"], rig.clock.tick)
    for tick in range(12):
        q_set, rate_set = drive(rig, tick)
        np.testing.assert_array_equal(rig.board["arm.command"], usual[tick][0])
        if tick >= 5:
            np.testing.assert_allclose(q_set, usual[tick - 5][0], rtol=1e-14)
            np.testing.assert_allclose(rate_set, usual[tick - 5][1], rtol=1e-14)


def test_the_arm_is_read_in_counts_and_its_torque_with_the_noise_of_its_own_channels(rig):
    count = np.array([1e-3, 2e-3, 0.0])
    rig.parameters["noise"]["encoder_count"] = count
    rig.parameters["noise"]["torque"] = [0.1, 0.2, 0.3]
    rig.data.qpos[rig.layout.arm_qpos] = [0.10044, 0.20061, 0.30077]
    drive(rig, 0)
    np.testing.assert_allclose(rig.board["arm.q"], [0.1, 0.2, 0.30077], rtol=1e-14)
    added = np.array([0.1, 0.2, 0.3]) * SLOW[TORQUE : TORQUE + 3]
    torque = rig.state["work"]["torque"][0]
    np.testing.assert_allclose(rig.board["arm.torque"] - torque, added, rtol=1e-9)


def test_the_truth_is_the_platforms_pose_from_home_and_its_angles(rig):
    at = rig.layout.platform_qpos
    home = rig.parameters["home"]["position"][0]
    turn = 0.3  # about z
    rig.data.qpos[at : at + 3] = home + np.array([0.01, 0.02, 0.03])
    rig.data.qpos[at + 3 : at + 7] = [np.cos(turn / 2), 0.0, 0.0, np.sin(turn / 2)]
    rig.state["sensor"]["true"], rig.state["rod_force"] = np.arange(6.0), 10.0 + np.arange(6.0)
    loop._read_truth(*parts(rig), rig.data.qpos)
    pose = rig.board["truth.pose"]
    np.testing.assert_allclose(pose[:3], [0.01, 0.02, 0.03], atol=1e-12)
    assert np.count_nonzero(np.abs(pose[3:] - turn) < 1e-12) == 1
    assert np.count_nonzero(np.abs(pose[3:]) < 1e-12) == 2
    np.testing.assert_array_equal(rig.board["truth.wrench"], np.arange(6.0))
    np.testing.assert_array_equal(rig.board["truth.leg_force"], 10.0 + np.arange(6.0))


def test_the_gauge_of_the_manifold_has_noise_of_its_own_channel(rig):
    rig.parameters["noise"]["pressure"] = 1e4
    command(rig, 1)
    assert rig.board["supply.pressure"][0] == pytest.approx(2e7 + 1e4 * SLOW[PRESSURE], rel=1e-12)


def test_the_leg_loop_and_the_amplifiers_act_when_their_clocks_strike(rig):
    leg, amplifier = rig.clock.leg, rig.clock.amplifier
    assert (leg, amplifier) == (5, 3)
    rig.state["legs"]["command"] = rig.parameters["transducer"]["home"] + 0.01
    commands, outputs = [], []
    for tick in range(1, 31):
        before = rig.board["valve.command"].copy(), rig.state["current"][0].copy()
        rig.board["valve.command"][:] += 1e-9  # so that a held one is told from a new one
        command(rig, tick)
        commands.append(not np.array_equal(rig.board["valve.command"], before[0] + 1e-9))
        outputs.append(not np.array_equal(rig.state["current"][0], before[1]))
    ticks = np.arange(1, 31)
    np.testing.assert_array_equal(commands, ticks % leg == 0)
    np.testing.assert_array_equal(outputs, ticks % amplifier == 0)


def test_rods_push_the_legs_and_leave_the_arm_alone(rig):
    rig.data.ctrl[:] = 77.0
    slides, speeds = rig.layout.slide_arrays(rig.data)
    p, s, _ = parts(rig)
    slides[rig.layout.slide_at] += 1e-3 * np.arange(6)  # springs of oil: each its own force
    step = rig.clock.tick / rig.clock.substeps
    loop._push_legs(p, s, slides, speeds, rig.data.ctrl, step)
    force = rig.state["rod_force"][0]
    np.testing.assert_array_equal(rig.data.ctrl[rig.layout.leg_ctrl], force)
    assert len(set(force)) == 6
    assert np.all(rig.data.ctrl[rig.layout.arm_ctrl] == 77.0)


@pytest.mark.parametrize(
    ("travel", "angle", "inside", "code"),
    [
        (0.0, 0.0, True, RUNNING),
        (0.0, 0.0, False, WRENCH_OUT_OF_RANGE),
        (0.99, 0.0, True, RUNNING),
        (-0.99, 0.0, True, RUNNING),
        (1.01, 0.0, False, LEG_AT_LIMIT),
        (-1.01, 0.0, True, LEG_AT_LIMIT),
        (np.nan, 0.0, True, NOT_FINITE),
        (np.inf, 0.0, True, NOT_FINITE),
        (0.0, np.nan, True, NOT_FINITE),
        (0.0, -2.0 * HUGE, True, NOT_FINITE),
    ],
)
def test_a_run_ends_by_what_the_rig_cannot_do(rig, travel, angle, inside, code):
    """Travel in shares of what a leg has."""
    slides, _ = rig.layout.slide_arrays(rig.data)
    rig.parameters["layout"]["slide_home"] = 0.05  # as tendons have a length at home
    slides[rig.layout.slide_at] = 0.05
    slides[rig.layout.slide_at[5]] += travel * rig.parameters["limits"]["stroke"][0]
    rig.data.qpos[rig.layout.arm_qpos[2]] = angle
    assert loop._verdict(parts(rig)[0], rig.data.qpos, slides, inside) == code


def test_rows_are_logged_by_their_clock_from_the_start_of_the_run_on():
    rig = standing(noise=False)
    for name in COMPUTERS:
        rig.board[name][:] = 77.0
    rig.tick = -7
    log = np.zeros((20, 1 + WIDTH))
    assert rig.run(40, log, 3) == (RUNNING, 3 + 7)
    assert rig.tick == 33
    rows = log[3:10]
    np.testing.assert_allclose(rows[:, 0], 5 * np.arange(7) * rig.clock.tick, rtol=1e-12)
    assert np.all(log[:3] == 0.0)
    assert np.all(log[10:] == 0.0)
    home = rig.parameters["transducer"]["home"][0]
    lengths = rows[:, 1:][:, SLICES["leg.length"]]
    assert np.abs(lengths - home).max() < 1e-3
    assert np.ptp(lengths, axis=0).max() > 0.0
    for name in COMPUTERS:
        assert np.all(rig.board[name] == 77.0), name


def test_ticks_in_pieces_are_the_same_ticks():
    """Noise is a matter of the tick alone, however many are asked for at once."""
    whole, pieces = standing(noise=True), standing(noise=True)
    logs = [np.zeros((20, 1 + WIDTH)) for _ in range(2)]
    assert whole.run(90, logs[0], 0) == (RUNNING, 18)
    logged = 0
    for count in (13, 1, 20, 56):
        _, logged = pieces.run(count, logs[1], logged)
    assert logged == 18
    np.testing.assert_array_equal(logs[0], logs[1])
    assert whole.state.tobytes() == pieces.state.tobytes()
    assert np.ptp(logs[0][:18, 1:][:, SLICES["supply.pressure"]]) > 0.0
    # the slow noise of the sensor is one number for 16 ticks, of a channel of its own
    wander = whole.state["sensor"]["wander"][0]
    assert len(set(wander)) == 6


def test_a_run_ends_at_the_tick_that_went_beyond_the_range():
    rig = standing(noise=False)
    rig.parameters["sensor"]["range"] = 0.0
    rig.parameters["sensor"]["offset"] = 1.0
    assert rig.run(30, np.zeros((20, 1 + WIDTH)), 0) == (WRENCH_OUT_OF_RANGE, 1)
    assert rig.tick == 1
