"""Joints called shoulder, elbow, wrist_1 to wrist_3, and columns that count them from 0 or 1."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from drafted import changed, drafted
from three_joints import ARM, moved

from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import matched
from ves_twin.machines.mjcf.draft.spots import spots_of

JOINTS = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)


BALANCED = (
    ARM.replace('fromto="0 0 0 0.4 0 0"', 'fromto="-0.2 0 0 0.2 0 0"')
    .replace('<body name="lower" pos="0.4 0 0">', '<body name="lower" pos="0 0 0.1">')
    .replace('fromto="0 0 0 0.3 0 0"', 'fromto="-0.1 0 0 0.1 0 0"')
    .replace('mass="3"', 'mass="0.3"')
    .replace('mass="1"', 'mass="0.1"')
)
"""The arm with two light links that are balanced about their axes."""


def robot() -> mujoco.MjModel:
    """A chain of six joints with a motor at each."""
    inner = ""
    for name in reversed(JOINTS):
        inner = f'<body><joint name="{name}"/><geom size="0.1"/>{inner}</body>'
    motors = "".join(f'<motor name="motor_{name}" joint="{name}"/>' for name in JOINTS)
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><worldbody>{inner}</worldbody><actuator>{motors}</actuator></mujoco>"
    )


@pytest.mark.parametrize(
    ("position", "current", "first"),
    [
        ("actual_q_{}", "actual_current_{}", 0),
        ("q{}", "i{}", 1),
        ("q_{}", "current_{}", 1),
        ("joint_{}", "current_joint_{}", 1),
    ],
)
def test_numbers_of_six_columns_are_those_of_six_joints(tmp_path, position, current, first):
    heads = [name.format(n + first) for name in (position, current) for n in range(6)]
    rows = np.cumsum(np.random.default_rng(1).standard_normal((400, 12)), axis=0)
    table = np.column_stack([0.01 * np.arange(400), rows])
    path = tmp_path / "log.csv"
    np.savetxt(path, table, "%.6g", ",", header=",".join(["t", *heads]), comments="")
    found = matched(LogColumns.read(path, None), spots_of(robot())).found
    taken = {match.column: match for match in found}
    for n, joint in enumerate(JOINTS):
        assert taken[heads[n]].spot.name == joint
        assert taken[heads[6 + n]].spot.joint == joint
        assert taken[heads[6 + n]].unit == "A"


def test_wrists_whose_efforts_are_friction_tell_that_their_columns_are_swapped(arm, write):
    """The model needs next to nothing there; friction of a UR10e's wrists fits at the right ones."""
    arm.write_text(BALANCED)
    model = mujoco.MjModel.from_xml_string(BALANCED)
    time, q, v, torque = moved(model, 2)
    torque[1:] += np.array([[3.0], [0.5]]) * np.sign(v[1:])
    heads = ("q1", "q2", "q3", "tau1", "tau2", "tau3")
    columns = dict(zip(heads, (*q, *torque), strict=True))
    found, _ = drafted(arm, write({"t": time} | changed(columns, q2=q[2], q3=q[1])))
    assert any("q2 and q3 look swapped" in words for words in found.look)
    found, _ = drafted(arm.with_name("arm.xml"), write({"t": time} | columns, "right.csv"))
    assert not any("swapped" in words for words in found.look)
