"""What the tasks with something hidden reward, against closed forms and runs of the scenarios."""

import gymnasium as gym
import numpy as np
import pytest
from short_episodes import make_short, short

import ves_twin as vt
from ves_twin.control.leg_loop import chebyshev_section
from ves_twin.core.errors import InvalidInputError
from ves_twin.envs.admittance_tuning import SHAKING
from ves_twin.envs.capture import AWAY, tip_jacobian, tip_position
from ves_twin.envs.evaluation import Trial, evaluate
from ves_twin.envs.gravity_compensation import CORRECTION, FORCE, MOMENT
from ves_twin.envs.leg_channels import distance
from ves_twin.envs.tuned_legs import SLEW

TUNING = "VesTwin/AdmittanceTuning-v0"
GRAVITY = "VesTwin/GravityCompensation-v0"
CAPTURE = "VesTwin/MicrogravityCapture-v0"
LOADED = vt.Plant.load("ves2_fast").extended(vt.effects.PayloadMass("arm.tool", mass=2.0))


def play(env, actions, **reset):
    env.reset(**reset)
    return [env.step(action) for action in actions]


def test_without_tuning_the_loss_is_the_run_s_emulation_error():
    quiet = short("admittance_tuning", **{"run.noise": False})
    plant = vt.Plant.load("ves2_fast").extended(vt.effects.ValveGain("leg.2", gain=-0.2))
    run = vt.simulate(quiet, plant)
    env = gym.make(TUNING, plant=plant, scenario=quiet)  # whose own fault hides the drawn ones
    env.reset(seed=0)
    period = run.time[1] - run.time[0]
    errors = [distance(p, r) for p, r in zip(run["truth.pose"], run["reference.pose"], strict=True)]
    for k in range(1, 73, 4):
        _, gain, _, _, info = env.step(np.zeros(3))
        shaking = 4.0 * SHAKING * env.unwrapped._costs.used[2] ** 2
        assert gain == pytest.approx(-period * (sum(errors[k : k + 4]) + shaking), rel=1e-9)
        assert info["truth"]["emulation_error"] == pytest.approx(errors[k + 3], rel=1e-12)


def test_gains_and_filter_are_those_of_the_octaves_and_go_back_at_reset():
    env = make_short(TUNING).unwrapped
    env.reset(seed=0)
    legs = env.sim.rig.parameters["legs"][0]
    gain, edge = float(legs["gain"]), float(legs["edge"])
    steps = int(np.ceil(1.0 / (SLEW * env.span)))
    for _ in range(steps):
        seen, *_ = env.step(np.array([0.2, -0.3, 0.5]))
    assert legs["gain"] == pytest.approx(gain * 2**0.2)
    assert legs["rate_gain"] == pytest.approx(0.05)
    numerator, denominator = chebyshev_section(1.0 / legs["period"], edge * 2**-0.3)
    np.testing.assert_allclose(legs["numerator"], numerator)
    np.testing.assert_allclose(legs["denominator"], denominator)
    assert env.observations.split(seen)["legs.edge"] == pytest.approx(-0.3)
    env.reset(seed=0)
    assert (legs["gain"], legs["edge"], legs["rate_gain"]) == (gain, edge, 0.0)


def test_a_filter_that_moves_does_not_shake_a_rig_at_rest():
    env = make_short(TUNING)
    *_, info = play(env, np.tile([0.0, -1.0, 0.0], (9, 1)), seed=0)[-1]
    assert info["costs"]["stability"] == 0.0
    assert info["truth"]["emulation_error"] < 1.0


def test_every_episode_hides_other_valves_and_a_given_fault_stays_alone():
    env = make_short(TUNING).unwrapped
    hidden = []
    for seed in (1, 2, 1):
        env.reset(seed=seed)
        hidden.append(env.sim.plant.effects)
    assert hidden[0] == hidden[2] != hidden[1]
    env.reset(seed=1, options={"plant": LOADED})
    assert env.sim.plant.effects == LOADED.effects


def test_the_loss_of_gravity_is_the_weight_that_is_missing():
    """2 kg at the tip, the arm at rest: m g, and m g times the lever in top axes."""
    scenario = short("gravity_compensation", **{"run.noise": False})
    env = gym.make(GRAVITY, plant=LOADED, scenario=scenario)
    *_, gain, _, _, info = play(env, np.zeros((3, 6)), seed=0)[-1][:5]
    belief = vt.Plant.load("ves2")
    weight = 2.0 * belief.parameters.number("gravity")
    assert info["truth"]["force_error"] == pytest.approx(weight, rel=1e-3)
    sensor = belief.parameters.array("sensor.position")
    lever = tip_position(belief, np.zeros(6), np.array(scenario.arm.start)) - sensor
    moment = weight * np.hypot(lever[0], lever[1])
    assert info["truth"]["moment_error"] == pytest.approx(moment, rel=0.02)  # the base tilts
    loss = weight / FORCE + info["truth"]["moment_error"] / MOMENT
    assert gain == pytest.approx(-loss * env.unwrapped.span, rel=1e-3)


def test_the_right_correction_costs_nothing():
    env = gym.make(GRAVITY, plant=LOADED, scenario=short("gravity_compensation"))
    env.reset(seed=0)
    u = env.unwrapped
    for _ in range(4):
        missing = u._truth.gravity_in_sensor() - u.sim.rig.board["gravity.estimate"]
        wrench = missing + u.hand.correction
        *_, gain, _, _, info = env.step(wrench / CORRECTION)
    assert info["truth"]["force_error"] < 0.1
    assert info["truth"]["moment_error"] < 0.1
    assert -gain < 0.02 * u.span


def test_the_tip_of_the_description_is_the_tip_of_the_mechanics():
    env = make_short(CAPTURE).unwrapped
    env.reset(seed=3)
    for action in np.random.default_rng(0).uniform(-1, 1, (6, 3)):
        env.step(action)
    pose, q = env._state
    belief = env.briefing().belief
    found = tip_position(belief, pose, q)
    np.testing.assert_allclose(env._tip_now(), found, rtol=0, atol=2e-4)  # one tick of motion
    step = np.array([1e-4, -2e-4, 1e-4])
    moved = tip_position(belief, pose, q + step) - found
    np.testing.assert_allclose(tip_jacobian(belief, pose, q) @ step, moved, rtol=0, atol=1e-7)


def test_a_target_costs_its_distance_until_it_is_caught():
    env = make_short(CAPTURE)
    env.reset(seed=0)
    tip = env.unwrapped._tip_now()
    away = tip + np.array([0.0, 0.3, 0.0])
    steps = play(env, np.zeros((3, 3)), seed=0, options={"goal": (away, np.zeros(3))})
    for _, gain, *_ in steps:
        assert gain == pytest.approx(-0.3 / AWAY * env.unwrapped.span, rel=1e-2)
    env.reset(seed=0, options={"goal": (tip, np.zeros(3))})
    over = False
    while not over:
        _, gain, _, over, info = env.step(np.zeros(3))
        assert gain == 0.0
    assert info["metrics"]["caught"] == 1.0
    fast = play(env, np.zeros((1, 3)), seed=0, options={"goal": (tip, [0.0, 0.2, 0.0])})
    assert fast[0][1] < 0.0  # near enough, too fast


def test_targets_pass_within_reach_of_the_arm():
    env = make_short(CAPTURE).unwrapped
    env.reset(seed=0)
    belief = env.briefing().belief
    shoulder = tip_position(belief, np.zeros(6), np.zeros(3)) * [0.0, 0.0, 1.0]
    arm = belief.arm
    reach = np.hypot(arm.a2 + arm.a3, arm.d2 + arm.d3)
    for _ in range(50):
        _, (position, velocity) = env.draw(env.briefing().scenario, None)
        assert np.linalg.norm(position + 8.0 * velocity - shoulder) <= reach


def test_goals_that_are_none_are_refused():
    with pytest.raises(InvalidInputError, match="three each"):
        make_short(CAPTURE).reset(options={"goal": [1.0, 2.0]})
    for identity in (TUNING, GRAVITY):
        with pytest.raises(InvalidInputError, match="none"):
            make_short(identity).reset(options={"goal": 1})
        with pytest.raises(InvalidInputError, match="no linear prior"):
            make_short(identity).unwrapped.prior()


def test_scenarios_that_hide_nothing_are_refused():
    with pytest.raises(InvalidInputError, match="filter"):
        gym.make(TUNING, scenario="vibration_damping")
    with pytest.raises(InvalidInputError, match="zero = false"):
        gym.make(GRAVITY, scenario="vibration_damping")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("environment", "policy"),
    [(TUNING, "fixed_tuning"), (GRAVITY, "residual_filter"), (CAPTURE, "chase")],
)
def test_each_baseline_is_better_than_nothing(environment, policy, cases):
    seeds = range(100, 100 + cases(3))
    found = [
        evaluate(Trial(environment, name, "none", "ves2_fast"), seeds) for name in (policy, "still")
    ]
    assert set(found[0].outcomes) == {"completed"}
    assert found[0].figures["return"].iqm > found[1].figures["return"].iqm
