"""Stretches that are fitted and held out in turn: both halves turn every joint both ways."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import drafted

from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.recordings.interleaved_split import alternate

SHAFT = """<mujoco model="shaft">
<option gravity="0 0 0"><flag contact="disable"/></option>
<worldbody><body name="rotor"><joint name="shaft" axis="0 0 1" damping="3e-5"/>
<inertial pos="0 0 0" mass="0.02" diaginertia="2.2e-6 2.2e-6 2.2e-6"/></body></worldbody>
<actuator><motor name="drive" joint="shaft"/></actuator></mujoco>"""


@pytest.fixture
def worm(tmp_path, write):
    """A shaft that goes up for 5 s and down for 5 s, twice, at 25 Hz; its log."""
    path, rng = tmp_path / "shaft.xml", np.random.default_rng(2)
    path.write_text(SHAFT)
    time = np.arange(500) / 25.0
    speed = 20.0 * np.tanh(5.0 * np.sin(2.0 * np.pi * time / 10.0))
    way = np.cumsum(speed) / 25.0 + 1e-4 * rng.standard_normal(500)
    effort = 2.2e-6 * np.gradient(speed, time) + 3e-5 * speed + 1e-3 * np.sign(speed)
    effort += 2e-5 * rng.standard_normal(500)
    return path, write({"t": time, "shaft_rad": way, "torque_Nm": effort})


def test_neither_half_turns_a_joint_one_way_alone(worm):
    """Viscous friction was proved, ten times too large, where one way was fitted."""
    found, rig = drafted(*worm)
    whole = read_rig_recording(worm[1], rig)
    ups = []
    for half in alternate(whole, found.stretch, rig.description.rate):
        steps = np.concatenate([np.diff(one["shaft.position"][:, 0]) for one in half])
        ups.append(float(np.sum(np.maximum(steps, 0.0)) / np.sum(np.abs(steps))))
    assert min(ups) > 0.25
    assert max(ups) < 0.75
    usual = alternate(whole, 5.0, rig.description.rate)
    assert all(np.all(np.diff(one["shaft.position"][20:-20, 0]) > 0.0) for one in usual[0])


def test_a_length_that_serves_is_kept(swing, write):
    path, columns = swing
    assert drafted(path, write({n: c[:1401] for n, c in columns.items()}))[0].stretch == 2.0
