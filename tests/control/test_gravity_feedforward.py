"""Gravity feed-forward: MuJoCo's own gravity torque, from the belief, held in a soft servo."""

import mujoco
import numpy as np
import pytest

import ves_twin as vt
from ves_twin.mechanics.gravity.gravity_model import GravityModel, gravity_in_top
from ves_twin.mechanics.kinematics.dh_chain import DhChain, Joint
from ves_twin.plant.assembly import assemble_free_arm, compile_model
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.simulate import simulate
from ves_twin.simulator.simulator import Simulator

RNG = np.random.default_rng(45)
SOFT = {"servo.stiffness": [210.0, 33.0, 20.0], "servo.damping": [72.0, 55.0, 17.0]}


def test_the_torque_is_what_mujoco_needs_to_hold_the_arm_on_a_tilted_base():
    plant = vt.Plant.load("ves2")
    model = compile_model(assemble_free_arm(plant))
    model.opt.gravity[:] = [0.0, 0.0, -plant.gravity_model.gravity]
    data = mujoco.MjData(model)
    q, angles = RNG.uniform(-2.0, 2.0, (20, 3)), RNG.uniform(-0.3, 0.3, (20, 3))
    found = plant.gravity_model.holding_torque(q, angles)
    for k in range(20):
        data.qpos[3:6], data.qpos[6:9] = angles[k, ::-1], q[k]
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(found[k], data.qfrc_bias[6:9], rtol=0, atol=1e-10)


def test_a_prismatic_joint_carries_the_weight_along_its_axis():
    joints = (Joint(0.2, 0.3, np.pi / 2), Joint(0.0, 0.1, 0.4, 0.3, prismatic=True))
    chain = DhChain(joints, np.eye(4))
    mass, com = np.array([5.0, 3.0, 2.0]), RNG.normal(size=(3, 3))
    model = GravityModel.of(chain, mass, com, 9.81)
    q, angles = np.array([[0.4, 0.2]]), np.array([[0.1, -0.2, 0.3]])

    def potential(at):
        frames = chain.frames(at)[0]
        places = np.array([f[:3, :3] @ c + f[:3, 3] for f, c in zip(frames, com, strict=True)])
        return -mass @ places @ gravity_in_top(angles, 9.81)[0]

    h = 1e-5
    slopes = [(potential(q + h * e) - potential(q - h * e)) / (2 * h) for e in np.eye(2)]
    np.testing.assert_allclose(model.holding_torque(q, angles)[0], slopes, rtol=0, atol=1e-7)


def standing(feedforward=True, **parameters):
    """An arm with PPED gains and no integrator on a still platform."""
    content = {
        "name": "stand",
        "question": "Does a soft arm stand?",
        "plant": "ves2_fast",
        "run": {"duration": 0.5, "settle": 10.0, "noise": False},
        "platform": {"mode": "position"},
        "parameters": {**SOFT, "servo.integral": [0.0] * 3, **parameters},
        "arm": {"start": [0.0, -1.0, 0.6], "gravity_feedforward": feedforward},
    }
    return Scenario.model_validate(content)


@pytest.mark.slow
def test_a_soft_arm_stands_with_it_and_falls_without():
    sag = simulate(standing())["truth.arm_q"] - [0.0, -1.0, 0.6]
    assert np.max(np.abs(sag)) < 2e-4  # a count of the encoder is 1e-4
    sag = simulate(standing(feedforward=False))["truth.arm_q"] - [0.0, -1.0, 0.6]
    assert np.max(np.abs(sag[:, 1:])) > 0.3


@pytest.mark.slow
def test_it_knows_the_believed_weight_alone():
    """2 kg more in link 3 than believed: the servo's spring holds the difference."""
    mass = vt.Plant.load("ves2_fast").parameters.array("arm.mass")
    mass[3] += 2.0
    scenario = standing(**{"arm.mass": mass.tolist()})
    run = simulate(scenario)
    q = run["truth.arm_q"][-1]
    truth = vt.Plant.load("ves2_fast").with_values({"arm.mass": mass.tolist()}).gravity_model
    belief = vt.Plant.load("ves2").gravity_model
    level = np.zeros((1, 3))
    missing = truth.holding_torque(q[None], level) - belief.holding_torque(q[None], level)
    spring = np.array(SOFT["servo.stiffness"]) * (np.array([0.0, -1.0, 0.6]) - q)
    assert np.max(np.abs(missing)) > 3.0
    np.testing.assert_allclose(spring, missing[0], rtol=0.02, atol=0.05)


def test_a_restored_run_repeats_with_its_feedforward():
    sim = Simulator(None, standing().model_copy(deep=True), 0)
    sim.advance(0.1)
    kept = sim.snapshot()
    sim.advance(0.3)
    once = sim.data.qpos.copy()
    sim.restore(kept)
    sim.advance(0.3)
    np.testing.assert_array_equal(sim.data.qpos, once)
