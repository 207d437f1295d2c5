"""The linear models against the rig they stand for."""

import control
import gymnasium as gym
import numpy as np
import pytest
from short_episodes import short

from ves_twin.envs.rig_env import CYCLES
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.joint_motion import Hold
from ves_twin.mechanics.planning.flexible_base import JointGains
from ves_twin.mechanics.planning.lagging_base import LaggingBaseArm
from ves_twin.plant.plant import Plant
from ves_twin.plant.puma_chain import puma_chain
from ves_twin.scenario.schema import Scenario

QUIET = {"run.noise": False, "run.duration": 4.0}

PARTS = 8
"""Points of the input in a step of the environment."""

MODEL_SHARE = 0.2
"""Of the peak: what the delays of the force chain, which the model leaves out, do to the base."""

SERVO_SHARE = 0.05
"""Of the peak: gravity on turning joints, and counts."""

LEGS_SHARE = 0.1
"""Of the step: the hold and the ticks of the leg loop."""


def test_the_arm_s_prior_has_the_poles_of_the_lagging_base():
    """Without its commands the prior is `LaggingBaseArm` with the servo's gains and friction."""
    scenario = Scenario.load("vibration_damping")
    prior = gym.make("VesTwin/VibrationDamping-v0").unwrapped.prior()
    plant = Plant.load("ves2")
    array = plant.parameters.array
    gains = JointGains(array("servo.stiffness"), array("servo.damping") + array("arm.damping"))
    mass = puma_chain(plant).mass_matrix(np.array(scenario.arm.start))
    base = EmulatedSystem.load("beam_bent_printed")
    lag = float(np.median(array("hydraulics.valve_lag")))
    whole = LaggingBaseArm(mass, base, gains, scenario.legs.gain, lag)
    kept = np.r_[0:30]  # without set-points and integrators
    poles = np.linalg.eigvals(prior.A[np.ix_(kept, kept)])
    for pole in whole.poles():
        assert np.min(np.abs(poles - pole)) < 1e-6 * max(1.0, abs(pole))


def test_the_arm_s_prior_predicts_arm_and_base():
    scenario = short("vibration_free_reach", **QUIET)
    env = gym.make("VesTwin/VibrationFreeReach-v0", plant="ves2_fast", scenario=scenario)
    first, _ = env.reset(seed=0, options={"goal": [0.0, 1.0, 0.0]})
    u = env.unwrapped
    rates = np.zeros((75, 3))
    rates[1:11] = [0.2, -0.16, 0.24]
    rates[11:21] = -rates[1:11]
    rows = np.array([first, *(env.step(rate / u.actions.high)[0] for rate in rates[1:])])
    seen = {name: rows[:, span] - rows[0, span] for name, span in u.observations.slices.items()}
    time = np.arange(74 * PARTS + 1) * u.span / PARTS
    late = time - u.span / CYCLES  # set-points begin a cycle after the action
    held = np.array([np.interp(late, np.arange(75) * u.span, r) for r in rates.T])
    shares = held / u.actions.high[:, None]
    found = control.forced_response(u.prior(), time, shares).outputs[:, ::PARTS]
    pose, q = np.abs(found[:6].T - seen["platform.pose"]), np.abs(found[6:9].T - seen["arm.q"])
    assert np.max(pose[:, :3]) < MODEL_SHARE * np.max(np.abs(seen["platform.pose"][:, :3]))
    assert np.max(pose[:, 3:]) < MODEL_SHARE * np.max(np.abs(seen["platform.pose"][:, 3:]))
    assert np.max(q) < SERVO_SHARE * np.max(np.abs(seen["arm.q"]))


def test_the_legs_prior_predicts_a_step():
    scenario = short("platform_tracking", **{"run.noise": False})
    env = gym.make("VesTwin/PlatformTracking-v0", plant="ves2_fast", scenario=scenario)
    first, _ = env.reset(seed=0, options={"goal": Hold(np.zeros(6))})
    u = env.unwrapped
    share = np.full(6, 0.1)  # 3 mm: less than the slew over a step
    rows = np.array([first, *(env.step(share)[0] for _ in range(15))])
    span = u.observations.slices["leg.travel"]
    time = np.arange(15 * PARTS + 1) * u.span / PARTS
    ramp = np.minimum(time / u.span, 1.0) * share[:, None]
    found = control.forced_response(u.prior(), time, ramp).outputs[:, ::PARTS]
    measured = (rows[:, span] - rows[0, span]).T
    assert np.max(np.abs(measured - found)) < LEGS_SHARE * 0.003


def test_names_of_the_model_are_those_of_the_tables():
    for identity in ("VibrationDamping", "PlatformTracking"):
        u = gym.make(f"VesTwin/{identity}-v0").unwrapped
        prior = u.prior()
        actions = [name.replace(".", "_") for name in u.actions.columns]
        seen = {name.replace(".", "_") for name in u.observations.columns}
        assert [
            f"{n.rsplit('_', 1)[0]}_{n.rsplit('_', 1)[1]}" for n in prior.input_labels
        ] == actions
        assert set(prior.output_labels) <= seen


@pytest.mark.parametrize("identity", ["VibrationDamping", "VibrationFreeReach", "PlatformTracking"])
def test_the_model_does_not_run_away(identity):
    prior = gym.make(f"VesTwin/{identity}-v0").unwrapped.prior()
    # set-points integrate rates, so the arm's has poles at zero
    assert np.max(prior.poles().real) < 1e-6
