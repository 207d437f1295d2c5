"""Angles that an inclinometer tells from the world, or an encoder before the gear."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from drafted import changed, drafted, scales
from three_joints import ARM

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.parts.predecessor import predecessor
from ves_twin.machines.mjcf.plausible.implausible import implausible
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording

CHAIN = """<mujoco><worldbody><body>
  <joint name="one" axis="0 1 0"/><geom size="0.1"/>
  <body pos="0 0 1" quat="0 0 0 1">
    <joint name="lift" type="slide" axis="0 1 0"/><joint name="two" axis="0 1 0"/><geom size="0.1"/>
    <body pos="0 0 1"><joint name="three" axis="0 0 1"/><geom size="0.1"/>
      <body pos="0 0 1"><joint name="four" axis="0 1 0"/><geom size="0.1"/></body>
    </body></body></body>
  <body><joint name="apart" axis="0 1 0"/><geom size="0.1"/></body>
</worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("joint", "among", "expected"),
    [
        ("one", {"one", "two"}, None),
        ("two", {"one", "two", "lift"}, ("one", -1.0)),  # its body stands turned by half a turn
        ("three", {"one", "two", "three"}, None),
        ("four", {"one", "two", "four"}, ("two", 1.0)),
        ("four", {"one", "two", "three", "four"}, None),  # three turns about another axis between
        ("four", {"one", "four"}, ("one", -1.0)),
        ("lift", {"one", "lift"}, None),
        ("apart", {"one", "two", "apart"}, None),
    ],
)
def test_the_predecessor_is_the_nearest_measured_joint_of_one_axis(joint, among, expected):
    assert predecessor(mujoco.MjModel.from_xml_string(CHAIN), joint, among) == expected


@pytest.mark.parametrize(("turned", "sign"), [(1.0, "-"), (-1.0, "+")])
def test_an_angle_from_the_world_is_taken_as_a_difference(arm, columns, write, turned, sign):
    """Of which one axis counts the other way, too."""
    world = columns["q2"] + columns["q3"]
    log = write(changed(columns, q2=turned * columns["q2"], q3=world))
    found, rig = drafted(arm, log)
    assert any("q3: numbers fit the model as measured from the world" in w for w in found.look)
    assert rig.description.signals["bend.position"].columns == (f"q3 {sign} q2",)
    recording = read_rig_recording(log, rig)
    assert recording["bend.position"][:, 0] == pytest.approx(columns["q3"], abs=1e-5)


def test_names_with_blanks_stand_in_quotes(arm, columns, write):
    world = columns["q2"] + columns["q3"]
    names = {"q2": "joint 2 [rad]", "q3": "joint 3 [rad]"}
    log = write({names.get(n, n): v for n, v in changed(columns, q3=world).items()})
    _, rig = drafted(arm, log)
    formula = "`joint 3 [rad]` - `joint 2 [rad]`"
    assert rig.description.signals["bend.position"].columns == (formula,)
    assert read_rig_recording(log, rig)["bend.position"][:, 0] == pytest.approx(
        columns["q3"], abs=1e-5
    )


def test_an_angle_before_the_gear_is_divided_by_it(tmp_path, columns, write):
    arm = tmp_path / "arm.xml"
    arm.write_text(ARM.replace('joint="lift"/>', 'joint="lift" gear="50"/>', 1))
    log = write(changed(columns, q2=50.0 * columns["q2"], tau2=columns["tau2"] / 50.0))
    found, rig = drafted(arm, log)
    assert any("those of the motor, before its gear of 50" in words for words in found.look)
    assert scales(rig)["lift.position"] == pytest.approx(0.02)


def test_joints_in_order_are_left_alone(arm, columns, write):
    _, rig = drafted(arm, write(columns))
    assert all(
        len(c.columns) == 1 and " " not in c.columns[0] for c in rig.description.signals.values()
    )
    assert np.all(np.array(list(scales(rig).values())) == 1.0)


@pytest.mark.parametrize(("turned", "sign"), [(1.0, "-"), (-1.0, "+")])
def test_a_file_that_takes_world_angles_for_joint_angles_is_refused_with_the_formula(
    arm, columns, write, turned, sign
):
    """Of which one axis counts the other way, too."""
    q2 = turned * columns["q2"]
    _, rig = drafted(arm, write(changed(columns, q2=q2, dq2=turned * columns["dq2"])))
    world = columns["q2"] + columns["q3"]
    log = write(changed(columns, q2=q2, q3=world), "world.csv")
    found = implausible(rig, read_rig_recording(log, rig))
    assert found is not None
    assert found.came.endswith("with bend.position measured from the world")
    assert found.expected == f"check signals.NAME.columns: a formula as q3 {sign} q2"


def test_a_file_that_takes_the_motor_s_angle_for_the_joint_s_is_refused(tmp_path, columns, write):
    arm = tmp_path / "arm.xml"
    arm.write_text(ARM.replace('joint="lift"/>', 'joint="lift" gear="50"/>', 1))
    geared = changed(columns, tau2=columns["tau2"] / 50.0)
    _, rig = drafted(arm, write(geared))
    log = write(changed(geared, q2=50.0 * columns["q2"]), "motor.csv")
    found = implausible(rig, read_rig_recording(log, rig))
    assert found is not None
    assert "lift.position of the motor, before its gear of 50" in found.came


def test_no_cause_at_its_largest_passes_for_an_angle_from_the_world(arm, columns, write):
    """Whatever the cause, reading the elbow from the world leaves more than half of an effort."""
    log = write({name: rows[:600] for name, rows in columns.items()})
    _, rig = drafted(arm, log)
    recording, forward = read_rig_recording(log, rig), MjcfForward.of(rig)
    fed, nominal = Excitation.of(recording, forward.drive), {p.name: p for p in rig.parameters}
    for cause in rig.hypotheses:
        sizes = np.max(np.abs(cause.departures()), axis=0)
        for sign in cause.signs:
            values = {
                name: np.clip(nominal[name].nominal + sign * size, *ends(nominal[name]))
                for name, size in zip(cause.parameters, sizes, strict=True)
            }
            rows = forward.simulate(fed, values)
            efforts = {c.signal: rows[:, [n]] for n, c in enumerate(forward.channels)}
            signals = {**recording.signals, **efforts}
            found = implausible(rig, replace(recording, signals=signals))
            assert found is None or "from the world" not in found.came, cause.label


def ends(parameter):
    return parameter.low, parameter.high


def test_a_file_whose_angle_is_zero_elsewhere_is_refused(arm, columns, write):
    _, rig = drafted(arm, write(columns))
    log = write(changed(columns, q2=columns["q2"] - 0.5 * np.pi), "zero.csv")
    found = implausible(rig, read_rig_recording(log, rig))
    assert found is not None
    assert "a quarter turn added to lift.position" in found.came
    assert found.expected == "check signals.NAME.offset of lift.position: where it is zero"
