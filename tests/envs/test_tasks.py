"""What the three tasks reward, checked against closed forms and against runs of the scenarios."""

import gymnasium as gym
import numpy as np
import pytest
from short_episodes import make_short, short

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError
from ves_twin.envs.commanded_arm import CommandedArm
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.joint_motion import Hold, Sine
from ves_twin.mechanics.planning.flexible_base import strain_energy

REACH = "VesTwin/VibrationFreeReach-v0"
DAMPING = "VesTwin/VibrationDamping-v0"
TRACKING = "VesTwin/PlatformTracking-v0"


def play(env, actions, **reset):
    env.reset(**reset)
    return [env.step(action) for action in actions]


def test_an_arm_that_stands_still_is_the_scenario_itself():
    """No actions: the rig must do what `ves-twin run vibration_damping` records."""
    start = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]
    # settling has the scenario's own seed in an environment, so noise is left out of the comparison
    quiet = short("vibration_damping", **{"run.noise": False})
    run = vt.simulate(quiet, vt.Plant.load("ves2_fast"))
    env = gym.make(DAMPING, plant="ves2_fast", scenario=quiet)
    steps = play(env, np.zeros((18, 3)), seed=0, options={"goal": start})
    poses = np.array([info["truth"]["truth.pose"] for *_, info in steps])
    np.testing.assert_array_equal(poses, run["truth.pose"][4:73:4])


def test_damping_pays_the_integral_of_the_strain_energy():
    scenario = short("vibration_damping", **{"run.noise": False})
    env = gym.make(DAMPING, plant="ves2_fast", scenario=scenario)
    start = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]
    steps = play(env, np.zeros((18, 3)), seed=0, options={"goal": start})
    run = vt.simulate(scenario, vt.Plant.load("ves2_fast"))
    base = EmulatedSystem.load("beam_bent_printed")
    energy = strain_energy(base, run["truth.pose"][1:73])
    period = run.time[1] - run.time[0]
    assert sum(gain for _, gain, *_ in steps) == pytest.approx(-energy.sum() * period, rel=1e-9)
    assert steps[-1][-1]["truth"]["strain_energy"] == pytest.approx(energy[-1], rel=1e-9)


def test_releases_have_every_sign():
    env = make_short(DAMPING)
    env.reset(seed=0)
    scenario = short("vibration_damping")
    drawn = [env.unwrapped.draw(scenario, None)[0].platform.start[:3] for _ in range(60)]
    starts = set(drawn)
    assert len(starts) == 8


def test_reaching_pays_for_energy_and_for_distance():
    env = make_short(REACH)
    goal = np.array([0.5, 1.2, 0.1])
    steps = play(env, np.zeros((5, 3)), seed=0, options={"goal": goal})
    away = np.linalg.norm(goal - [0.0, np.pi / 2, 0.0])
    for _, gain, *_ in steps:
        # the energy of a rig at rest is below a microjoule
        assert gain == pytest.approx(-away * env.unwrapped.span, rel=1e-4)
    np.testing.assert_array_equal(steps[-1][0][env.unwrapped.observations.slices["goal"]], goal)


def test_set_points_end_where_the_rates_say():
    """r0 = 0 to r1 over h: q = r1 h / 2; then r1 held: r1 h."""
    arm = CommandedArm(np.zeros(3), np.full(3, -1.0), np.full(3, 1.0), acceleration=100.0)
    rate = np.array([0.5, -0.2, 0.0])
    arm.command(rate, 0.0, 0.05)
    np.testing.assert_allclose(arm.q(0.05), rate * 0.025, rtol=1e-12)
    arm.command(rate, 0.05, 0.05)
    np.testing.assert_allclose(arm.q(0.10), rate * 0.075, rtol=1e-12)
    np.testing.assert_allclose(arm.q(0.20), arm.q(0.10), rtol=0)  # none beyond the step


def test_set_points_stop_at_their_bounds_and_come_back():
    arm = CommandedArm(np.zeros(3), np.full(3, -0.02), np.full(3, 0.02), acceleration=100.0)
    for k in range(5):
        arm.command(np.ones(3), 0.05 * k, 0.05)
    np.testing.assert_array_equal(arm.q(0.25), np.full(3, 0.02))
    for k in range(5, 9):
        arm.command(-np.ones(3), 0.05 * k, 0.05)
    assert np.all(arm.q(0.45) < 0.02)


def test_a_rate_changes_no_faster_than_the_acceleration():
    arm = CommandedArm(np.zeros(3), np.full(3, -1.0), np.full(3, 1.0), acceleration=2.0)
    arm.command(np.ones(3), 0.0, 0.05)
    np.testing.assert_allclose(arm.q(0.05), 0.1 * 0.05 / 2, rtol=1e-12)


def test_tracking_without_offsets_is_position_control():
    scenario = short("platform_tracking", **{"run.noise": False})
    motion = scenario.platform.motion.build(np.zeros(6))
    env = gym.make(TRACKING, plant="ves2_fast", scenario=scenario)
    steps = play(env, np.zeros((19, 6)), seed=0, options={"goal": motion})
    run = vt.simulate(scenario, vt.Plant.load("ves2_fast"))
    poses = np.array([info["truth"]["truth.pose"] for *_, info in steps])
    # the pose goes through leg lengths and back, and the loop is stable
    np.testing.assert_allclose(poses, run["truth.pose"][4:77:4], rtol=0, atol=1e-9)


def test_tracking_pays_the_distance_in_millimetres():
    env = make_short(TRACKING)
    away = Hold(np.array([0.003, 0.0, 0.0, 0.0, 0.01, 0.0]))
    env.reset(seed=0, options={"goal": away})
    # before anything has moved: 3 mm and 10 mrad at 0.3 m, another 3 mm
    assert env.unwrapped.truth()["distance"] == pytest.approx(np.hypot(3.0, 3.0), abs=0.02)
    *_, info = env.step(np.zeros(6))
    assert info["truth"]["distance"] < np.hypot(3.0, 3.0)


def test_the_reference_of_an_episode_begins_at_rest():
    env = make_short(TRACKING)
    env.reset(seed=3)
    motion = env.unwrapped.hand.motion
    assert isinstance(motion, Sine)
    np.testing.assert_array_equal(motion.pose(0.0), np.zeros(6))


def test_offsets_move_the_legs_by_that_much():
    env = make_short(TRACKING)
    env.reset(seed=0, options={"goal": Hold(np.zeros(6))})
    share = np.array([0.1, -0.1, 0.05, 0.0, 0.1, -0.05])
    for _ in range(19):
        seen, *_ = env.step(share)
    u = env.unwrapped
    travel = u.observations.split(seen)["leg.travel"]
    # at rest after 1 s, 12 time constants of the legs
    np.testing.assert_allclose(travel, share * u.actions.high, rtol=0, atol=2e-5)


def test_a_goal_beyond_half_a_turn_is_refused():
    env = make_short(REACH)
    with pytest.raises(InvalidInputError, match="half a turn"):
        env.reset(options={"goal": [4.0, 0.0, 0.0]})
