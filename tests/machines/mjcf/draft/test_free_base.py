"""A base that floats: thrusters called by another name, and logs that drift off their model."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.draft.draft import draft

FLOATER = """
<mujoco>
  <option timestep="0.002" gravity="0 0 0" integrator="implicitfast">
    <flag contact="disable"/></option>
  <worldbody><body name="base">
    <joint name="x" type="slide" axis="1 0 0"/>
    <joint name="y" type="slide" axis="0 1 0"/>
    <joint name="theta" axis="0 0 1"/>
    <geom type="cylinder" size="0.2 0.1" mass="10"/>
    <site name="s1" pos="-0.2 0.15 0"/><site name="s2" pos="-0.2 -0.15 0"/>
    <site name="s3" pos="0.2 0.15 0"/><site name="s4" pos="0.15 -0.2 0"/>
  </body></worldbody>
  <actuator>
    <general name="thr1" site="s1" gear="{push} 0 0 0 0 0" ctrlrange="0 1"/>
    <general name="thr2" site="s2" gear="0.5 0 0 0 0 0" ctrlrange="0 1"/>
    <general name="thr3" site="s3" gear="-0.5 0 0 0 0 0" ctrlrange="0 1"/>
    <general name="thr4" site="s4" gear="0 0.5 0 0 0 0" ctrlrange="0 1"/>
  </actuator>
</mujoco>
"""


@pytest.fixture(scope="module")
def log():
    """Forty seconds of a base whose first thruster pushes a fifth more than the model's."""
    model = mujoco.MjModel.from_xml_string(FLOATER.format(push=0.6))
    data, rng, rows = mujoco.MjData(model), np.random.default_rng(4), np.zeros((2000, 8))
    for k in range(len(rows)):
        if k % 25 == 0:
            data.ctrl[:] = rng.random(4) < 0.25
        rows[k] = 0.02 * k, *(data.qpos + 2e-4 * rng.standard_normal(3)), *data.ctrl
        for _ in range(10):
            mujoco.mj_step(model, data)
    names = ("t_s", "x_m", "y_m", "theta_rad", "valve1", "valve2", "valve3", "valve4")
    return dict(zip(names, rows.T, strict=True))


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "floater.xml"
    path.write_text(FLOATER.format(push=0.5))
    return path


def test_valves_are_taken_for_thrusters_by_their_numbers_alone_and_that_is_told(
    log, model, write, tmp_path
):
    found = draft(model, [write(log)], tmp_path / "rig.toml")
    guesses = {guess.column: guess for guess in found.guesses}
    for n in range(1, 5):
        assert guesses[f"valve{n}"].taken_for.startswith(f"actuator thr{n} ")
        assert "by its number alone, of valve1 to valve4" in guesses[f"valve{n}"].why
    assert not found.left


def test_two_families_of_columns_are_not_told_apart(log, model, write, tmp_path):
    more = log | {f"lamp{n}": np.roll(log[f"valve{n}"], 100) for n in range(1, 5)}
    with pytest.raises(InvalidInputError, match=r"not matched: valve1.*lamp4"):
        draft(model, [write(more)], tmp_path / "rig.toml")


def test_thrusters_without_a_column_are_told_to_be_at_rest(log, model, write, tmp_path):
    some = {name.replace("valve", "thr"): values for name, values in log.items()}
    del some["thr4"]
    found = draft(model, [write(some)], tmp_path / "rig.toml")
    (told,) = (words for words in found.look if "at rest in every simulation" in words)
    assert "no column tells what commands thr4:" in told


def test_a_log_that_drifts_off_its_model_is_predicted_in_pieces(log, model, write, tmp_path):
    """A fifth of one thruster pushes a free base metres away in forty seconds."""
    found = draft(model, [write(log)], tmp_path / "rig.toml")
    assert "horizon = 10" in found.text
    assert "over the whole log the model explains" in found.mode
    assert min(found.explained.values()) > 0.5


def test_pieces_do_not_hide_that_a_model_explains_nothing(log, model, write, tmp_path):
    """Half a second from a measured start any model is near: it counts against coasting."""
    turned = log | {f"valve{n}": log[f"valve{n}"][::-1] for n in range(1, 5)}
    found = draft(model, [write(turned)], tmp_path / "rig.toml")
    assert min(found.explained.values()) < 0.2


ARMED = FLOATER.replace(
    '<site name="s1"',
    '<body pos="0.2 0 0"><joint name="arm1" axis="0 0 1" damping="0.1"/>'
    '<geom size="0.02" pos="0.1 0 0" mass="0.2"/></body><site name="s1"',
).replace("</actuator>", '<motor name="arm1_motor" joint="arm1"/></actuator>')


def test_a_torque_is_a_motors_and_no_thrusters_whatever_its_number(tmp_path, write):
    path = tmp_path / "armed.xml"
    path.write_text(ARMED.format(push=0.5))
    rng = np.random.default_rng(1)
    names = ("x_m", "y_m", "theta_rad", "q1_rad", "tau1_Nm", "valve1", "valve2", "valve3", "valve4")
    log = {"t_s": 0.02 * np.arange(500)}
    log |= {name: np.cumsum(0.01 * rng.standard_normal(500)) for name in names}
    found = draft(path, [write(log)], tmp_path / "rig.toml")
    taken = {guess.column: guess.taken_for for guess in found.guesses}
    assert taken["tau1_Nm"].startswith("actuator arm1_motor ")
    assert taken["valve1"].startswith("actuator thr1 ")
