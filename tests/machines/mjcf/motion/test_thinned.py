"""Efforts along a motion that is logged fast are computed at some of its rows."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from ves_twin.machines.mjcf.motion.smoothed import smoothed
from ves_twin.machines.mjcf.motion.thinned import ENDS, OVER, Thinned, is_smooth
from ves_twin.machines.mjcf.parts.rigid_efforts import inverted

PERIOD, CORNER = 0.001, 5.0

ARM = """
<mujoco><worldbody><body><joint name="turn" axis="0 0 1"/>
  <geom type="capsule" fromto="0 0 0 0.3 0 0.1" size="0.03" mass="2"/>
  <body pos="0.3 0 0.1"><joint name="bend" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 0.2 0.05 0" size="0.02" mass="1"/></body></body></worldbody>
</mujoco>
"""


def states() -> tuple[mujoco.MjModel, tuple[np.ndarray, ...]]:
    """Of the arm at 1 kHz, low-passed."""
    model = mujoco.MjModel.from_xml_string(ARM)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    time = PERIOD * np.arange(20_000)
    tones = [np.sin(f * time[:, None] + [0.0, 1.0]) / f for f in (1.3, 7.1, 23.0, 31.0, 90.0)]
    way = np.stack([smoothed(row, PERIOD, CORNER) for row in np.sum(tones, axis=0).T], axis=1)
    speed = np.gradient(way, PERIOD, axis=0)
    return model, (way, speed, np.gradient(speed, PERIOD, axis=0))


def test_what_lies_between_is_what_inverse_dynamics_needs_there():
    """To 2e-3 of each spread, by half at the ends; the motion goes up to the corner."""
    model, path = states()
    thinned = Thinned.of(len(path[0]), PERIOD, CORNER, 100.0)
    assert thinned.every == int(1.0 / (OVER * CORNER * PERIOD))
    found = thinned.inverted(model, *path)
    every = inverted(model, *path)
    assert len(thinned.rows) < len(path[0]) / (thinned.every - 1.0)
    assert found.position is path[0]
    assert found.speed is path[1]
    off = np.std((found.effort - every.effort)[ENDS:-ENDS], axis=0) / np.std(every.effort, axis=0)
    assert np.max(off) < 2e-3


@pytest.mark.parametrize(
    ("count", "period", "corner"), [(20_000, 0.02, 10.0), (20_000, 0.001, 400.0), (500, 0.001, 5.0)]
)
def test_a_slow_log_an_open_low_pass_and_a_short_log_are_computed_row_by_row(count, period, corner):
    """What an open low-pass lets through would fold back."""
    assert Thinned.of(count, period, corner, 100.0).every == 1


@pytest.mark.parametrize("beyond", [0, 1])
def test_a_stop_that_is_reached_for_one_row_makes_every_row_count(beyond):
    """Of rows that are left out as well: none of those that are computed is beyond it."""
    model, path = states()
    model.opt.disableflags = 0
    thinned = Thinned(len(path[0]), 20)
    turn = path[0][:, 0]
    highest = int(np.argmax(turn))
    reached = turn[highest] if highest not in thinned.rows else np.max(turn[thinned.rows])
    model.jnt_limited[0], model.jnt_range[0] = 1, (-10.0, reached + (0.1, -1e-9)[beyond])
    model.geom_contype[:] = model.geom_conaffinity[:] = 0
    assert is_smooth(model, path[0]) is not bool(beyond)
    if beyond:
        every = inverted(model, *path)
        np.testing.assert_array_equal(thinned.inverted(model, *path).effort, every.effort)


@pytest.mark.parametrize(
    "part",
    [
        '<sensor><rangefinder site="eye"/></sensor>',
        '<sensor><gyro site="eye" cutoff="1"/></sensor>',
        '<option density="1.2"/>',
        '<tendon><fixed stiffness="3" springlength="0.1 0.2"><joint joint="bend" coef="1"/></fixed>'
        "</tendon>",
    ],
)
def test_what_has_a_kink_is_computed_row_by_row(part):
    text = ARM.replace("<worldbody>", '<worldbody><site name="eye"/>').replace(
        "</mujoco>", f"{part}</mujoco>"
    )
    model, plain = (mujoco.MjModel.from_xml_string(one) for one in (text, ARM))
    for one in (model, plain):
        one.geom_contype[:] = one.geom_conaffinity[:] = 0
    at_rest = np.zeros((10, 2))
    assert is_smooth(plain, at_rest)
    assert not is_smooth(model, at_rest)


def test_bodies_that_may_touch_are_computed_row_by_row():
    assert not is_smooth(mujoco.MjModel.from_xml_string(ARM), np.zeros((10, 2)))
