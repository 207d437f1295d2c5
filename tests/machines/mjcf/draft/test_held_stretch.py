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


@pytest.fixture(params=[(25, 20.0, 5.0, 1e-4), (200, 0.2, 3.0, 2e-3)], ids=["fast", "slow, noisy"])
def worm(tmp_path, write, request):
    """A shaft that goes up and down for some seconds each, for 20 s in all; log, seconds."""
    rate, fastest, turn, noise = request.param
    path, rng = tmp_path / "shaft.xml", np.random.default_rng(2)
    path.write_text(SHAFT)
    time = np.arange(20 * rate) / rate
    speed = fastest * np.tanh(5.0 * np.sin(np.pi * time / turn))
    way = np.cumsum(speed) / rate + noise * rng.standard_normal(len(time))
    effort = 2.2e-6 * np.gradient(speed, time) + 3e-5 * speed + 1e-3 * np.sign(speed)
    effort += 2e-5 * rng.standard_normal(len(time))
    return path, write({"t": time, "shaft_rad": way, "torque_Nm": effort}), turn


def test_neither_half_turns_a_joint_one_way_alone(worm):
    """Viscous friction was proved, ten times too large, where one way was fitted."""
    path, log, turn = worm
    found, rig = drafted(path, log)
    whole = read_rig_recording(log, rig)

    def up(half):
        """Share of the way that goes up, in steps of a tenth of a second."""
        coarse = max(round(0.1 / whole.time[1]), 1)
        steps = np.concatenate([np.diff(one["shaft.position"][::coarse, 0]) for one in half])
        return float(np.sum(np.maximum(steps, 0.0)) / np.sum(np.abs(steps)))

    for half in alternate(whole, found.stretch, rig.description.rate):
        assert 0.1 < up(half) < 0.9
    assert up(alternate(whole, turn, rig.description.rate)[0]) > 0.95


def test_a_length_that_serves_is_kept(swing, write):
    path, columns = swing
    assert drafted(path, write({n: c[:1401] for n, c in columns.items()}))[0].stretch == 2.0
