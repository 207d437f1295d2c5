"""A model without actuators on a shaker: its base moves as recorded, all else is compared."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import TransferFunction, lsim

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.mjcf.draft.match import _whole_sensors
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot
from ves_twin.machines.mjcf.rig.machine import Rig

MASS, SPRING, DAMPER, PERIOD = 4.0, 2500.0, 20.0, 0.005

MODEL = f"""<mujoco><option timestep="0.001" gravity="0 0 0" integrator="implicitfast"/><worldbody>
  <body name="plate"><joint name="shaker" type="slide" axis="0 0 1"/>
    <geom type="box" size=".2 .2 .02" mass="25"/>
    <body name="block" pos="0 0 .3">
      <joint name="mount" type="slide" axis="0 0 1" stiffness="{SPRING}" damping="{DAMPER}"/>
      <geom type="box" size=".1 .1 .1" mass="{MASS}" contype="0" conaffinity="0"/>
      <site name="top"/></body></body></worldbody>
  <sensor><accelerometer name="block_acc" site="top"/>
    <framepos name="block_pos" objtype="site" objname="top"/></sensor></mujoco>"""


@pytest.fixture(scope="module")
def shaken():
    """Time, motion of the plate, place and acceleration of the block in closed form."""
    time = PERIOD * np.arange(2400)
    rng = np.random.default_rng(4)
    base = sum(
        2e-3 * np.sin(2.0 * np.pi * f * time + p)
        for f, p in zip((0.7, 1.9, 3.3, 5.1), rng.uniform(0, 6.28, 4), strict=True)
    )
    base = base * np.minimum(time / 0.5, 1.0) ** 3
    way = TransferFunction([DAMPER, SPRING], [MASS, DAMPER, SPRING])
    _, place, _ = lsim(way, base, time)
    _, acceleration, _ = lsim(way, np.gradient(np.gradient(base, PERIOD), PERIOD), time)
    return time, base, place, acceleration


def drafted(folder, columns):
    (folder / "block.xml").write_text(MODEL)
    rows = np.column_stack(list(columns.values()))
    np.savetxt(folder / "log.csv", rows, delimiter=",", header=",".join(columns), comments="")
    found = draft(folder / "block.xml", [folder / "log.csv"], folder / "my.toml")
    (folder / "my.toml").write_text(found.text)
    return found, Rig.load(str(folder / "my.toml"))


def columns_of(shaken, **new):
    time, base, place, acceleration = shaken
    noise = np.random.default_rng(5).normal(size=(3, len(time)))
    return {
        "t_s": time,
        "shaker_mm": 1e3 * base + 1e-3 * noise[0],
        "block_pos_mm": 1e3 * place + 0.01 * noise[1],
        "block_acc_ms2": acceleration + 0.01 * noise[2],
    } | new


def test_the_joint_next_to_the_world_is_imposed_and_sensors_take_the_axis_that_moves(
    shaken, tmp_path
):
    found, rig = drafted(tmp_path, columns_of(shaken))
    told = rig.description
    assert (told.drive.mode, told.drive.imposed) == ("control", ("shaker",))
    assert {n: c.axis for n, c in told.compare.items() if c.sensor} == {
        "block_acc": "z",
        "block_pos": "z",
    }
    assert told.signals["block_pos"].offset == pytest.approx(0.3, abs=1e-3)  # the log begins at 0
    assert min(found.explained.values()) > 0.99


def test_a_joint_without_a_column_has_the_sizes_that_the_model_gives_it(shaken, tmp_path):
    """So that its friction, its spring and its damper are offered as causes."""
    _, rig = drafted(tmp_path, columns_of(shaken))
    time, base, place, _ = shaken
    mount = rig.description.typical.joint["mount"]
    assert mount.travel == pytest.approx(np.ptp(np.percentile(place - base, [5, 95])), rel=0.1)
    force = SPRING * (place - base) + DAMPER * np.gradient(place - base, time)
    assert mount.effort == pytest.approx(np.percentile(np.abs(force), 95), rel=0.1)
    offered = {(a.kind, *a.on) for a in rig.description.effects}
    assert {("coulomb_friction", "mount"), ("sensor_gain", "block_acc.1")} <= offered


def test_a_column_that_says_its_axis_is_that_axis(shaken, tmp_path):
    columns = columns_of(shaken)
    columns["block_acc_x [m/s^2]"] = 1e-3 * np.random.default_rng(6).normal(
        size=len(columns["t_s"])
    )
    del columns["block_acc_ms2"]
    _, rig = drafted(tmp_path, columns)
    assert rig.description.compare["block_acc"].axis == "x"


def test_one_number_of_a_quaternion_is_left_out():
    """It has four, of which none is an axis."""
    spots = [
        Spot(Quantity.SENSOR, "tilt", "1", frozenset({"tilt"}), k + 1, axis=k, width=4)
        for k in range(4)
    ]
    assert _whole_sensors({"tilt_z": spots[3]}, spots) == {}
    assert len(_whole_sensors({f"tilt_{k}": spots[k] for k in range(4)}, spots)) == 4


def test_a_base_alone_is_refused_with_what_is_missing(shaken, tmp_path):
    few = {k: v for k, v in columns_of(shaken).items() if k in ("t_s", "shaker_mm")}
    with pytest.raises(InvalidInputError, match="what follows from it"):
        drafted(tmp_path, few)
