"""What is in an actuator's filter where a motion begins: by earlier commands, or by the joint."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import servo_rig

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.filtered import fill_filters
from ves_twin.machines.mjcf.motion.forward import MjcfForward

PERIOD = 0.01


def filtered(kind: str = "filterexact", servo: bool = True) -> mujoco.MjModel:
    text = servo_rig.MODEL.replace('"filter"', f'"{kind}"')
    return mujoco.MjModel.from_xml_string(
        text if servo else text.replace('biasprm="0 -8 -0.3"', 'biasprm="0 0 0"')
    )


def test_earlier_commands_leave_in_a_filter_what_mujoco_leaves_there():
    model = filtered()
    commands = np.random.default_rng(0).normal(size=(40, 1))
    told, stepped = mujoco.MjData(model), mujoco.MjData(model)
    stepped.act[0] = commands[0, 0]
    for command in commands[:-1]:
        stepped.ctrl[:] = command
        mujoco.mj_step(model, stepped, round(PERIOD / model.opt.timestep))
    fill_filters(model, told, commands, PERIOD)
    assert told.act[0] == pytest.approx(stepped.act[0], abs=1e-12)  # both are exact: round-off


def test_a_limit_of_commands_is_one_of_the_filter_too():
    text = servo_rig.MODEL.replace('gainprm="8"', 'gainprm="8" ctrlrange="-0.2 0.2"')
    text = text.replace("<worldbody>", '<compiler autolimits="true"/><worldbody>')
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    fill_filters(model, data, np.ones((100, 1)), PERIOD)
    assert data.act[0] == pytest.approx(0.2)


def test_a_lead_that_is_shorter_than_the_filter_remembers_leaves_a_servo_where_its_joint_is():
    model = filtered()
    data = mujoco.MjData(model)
    data.qpos[0] = 0.5
    fill_filters(model, data, np.full((3, 1), 1.5), PERIOD)  # 20 ms of 60 ms
    held = 0.5 + 0.2 * 9.81 * 0.1 * np.sin(0.5) / 8.0
    assert data.act[0] == pytest.approx(held, abs=1e-9)


def test_two_servos_of_one_joint_begin_by_their_commands():
    """What each holds of the load nobody knows."""
    twice = servo_rig.MODEL.replace("</actuator>", "{}</actuator>").format(
        servo_rig.MODEL.partition("<actuator>")[2]
        .partition("</actuator>")[0]
        .replace('name="servo"', 'name="second"')
    )
    model = mujoco.MjModel.from_xml_string(twice)
    data = mujoco.MjData(model)
    fill_filters(model, data, np.array([[0.7, 0.6]]), PERIOD)
    assert data.act.tolist() == [0.7, 0.6]


def test_without_earlier_commands_the_first_one_was_there_of_a_motor_behind_a_filter():
    model = filtered(servo=False)
    data = mujoco.MjData(model)
    fill_filters(model, data, np.array([[0.7]]), PERIOD)
    assert data.act[0] == 0.7


def test_a_servo_begins_where_it_holds_its_arm_and_not_where_it_is_told_to_go(tmp_path):
    """A log that begins with a step: the arm hung at 0.5 rad, and MuJoCo's own start is at 0."""
    forward = MjcfForward.of(servo_rig.rig(tmp_path))
    told = {
        "target": np.full((50, 1), 1.5),
        "angle": np.full((50, 1), 0.5),
    }
    angle = forward.simulate(Excitation("step", PERIOD * np.arange(50), told), {})[:, 0]
    # the filter of 60 ms lets through kp (1 rad) (1 - exp(-t / tau)) of torque: after 1 ms 0.13 N m
    # on 0.005 kg m^2, so that nothing has moved by 1 mrad before some 5 ms, and never back
    assert angle[1] - 0.5 == pytest.approx(0.0, abs=0.01)
    assert np.min(np.diff(angle[:10])) >= 0.0
    at_rest = {name: np.full((50, 1), 0.5) for name in told}
    still = forward.simulate(Excitation("rest", PERIOD * np.arange(50), at_rest), {})[:, 0]
    sagged = 0.2 * 9.81 * 0.1 * np.sin(0.5) / 8.0  # what a servo told 0.5 falls short by
    assert np.max(np.abs(still - 0.5)) <= 1.05 * sagged


def test_a_servo_that_is_told_where_it_hangs_does_not_move(tmp_path):
    forward = MjcfForward.of(servo_rig.rig(tmp_path))
    held = 0.5 + 0.2 * 9.81 * 0.1 * np.sin(0.5) / 8.0
    fed = {"target": np.full((50, 1), held), "angle": np.full((50, 1), 0.5)}
    angle = forward.simulate(Excitation("held", PERIOD * np.arange(50), fed), {})[:, 0]
    assert np.max(np.abs(angle - 0.5)) < 1e-9


def test_a_servo_without_stiffness_begins_where_its_joint_is():
    """The end of a range that a search tries."""
    model = filtered()
    model.actuator_gainprm[0, 0] = model.actuator_biasprm[0, 1] = 0.0
    data = mujoco.MjData(model)
    data.qpos[0] = 0.3
    fill_filters(model, data, np.array([[0.7]]), PERIOD)
    assert data.act[0] == 0.3
