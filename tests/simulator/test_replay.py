"""Replaying a recording: the same plant gives the same measurements, another plant its own."""

from dataclasses import replace

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.effects.registry import build_effect

SAME = {
    "leg.length": 5e-7,
    "sensor.wrench": 2e-2,
    "arm.q": 1.2e-4,
    "arm.torque": 1e-6,
    "valve.command": 1e-6,
}
"""Set-points come back through forward kinematics and a spline inverse to round-off, which can tip
one count: of the transducers [m], the sensor [N, N m] and the encoders [rad]."""

QUICK = {
    "run.duration": 3.0,
    "run.noise": False,
    "arm.moves": [{"start": 0.5, "duration": 1.5, "to": [0.8, 0.4, 0.3]}],
}


@pytest.fixture(scope="module", params=["position_sine", "beam_horizontal_truth"])
def recording(request) -> vt.Recording:
    return vt.simulate(vt.Scenario.load(request.param, QUICK))


def test_the_same_plant_measures_the_same(recording):
    again = vt.replay(recording, vt.Plant.load("ves2"))
    for name, limit in SAME.items():
        assert np.abs(again[name] - recording[name]).max() <= 1.001 * limit, name


def test_a_sensor_keeps_its_calibration_in_a_replay():
    """A run of the Model Method reads the sensor through the matrix of its calibration file."""
    scenario = vt.Scenario.load("beam_model_method", {"run.duration": 1.0, "run.noise": False})
    run = vt.simulate(scenario)
    again = vt.replay(run, vt.Plant.load("ves2_crosstalk"))
    known = slice(0, -10)  # the arm still moves; its spline ends with commands that nobody knows
    miss = np.abs(again["sensor.wrench"] - run["sensor.wrench"])[known].max()
    assert miss <= 1.001 * SAME["sensor.wrench"]


def test_another_plant_measures_something_else(recording):
    offset = build_effect("length_offset", "leg.3", {"offset": 1e-3})
    again = vt.replay(recording, vt.Plant.load("ves2").extended(offset))
    assert np.abs(again["sensor.wrench"] - recording["sensor.wrench"]).max() > 0.05


def test_only_what_was_asked_for_comes_back(recording):
    again = vt.replay(recording, vt.Plant.load("ves2"), ["leg.command"], ["leg.length"])
    assert list(again.signals) == ["leg.length"]
    np.testing.assert_array_equal(again.time, recording.time)


def test_a_window_of_a_run_replays_too(recording):
    tail = recording.window(1.0, 3.0)
    shifted = vt.Recording(tail.time - tail.time[0], tail.signals, tail.info)
    again = vt.replay(shifted, vt.Plant.load("ves2"))
    late = again.time > 1.0  # the start from rest has died away
    miss = np.abs(again["leg.length"] - shifted["leg.length"])[late].max()
    assert miss < 1e-3


def test_a_window_replays_at_its_own_times(recording):
    """As its rows counted from zero: the set-points are those of the window, not of t = 0."""
    tail = recording.window(1.0, 3.0)
    shifted = vt.Recording(tail.time - tail.time[0], tail.signals, tail.info)
    again, zero = (vt.replay(r, vt.Plant.load("ves2")) for r in (tail, shifted))
    np.testing.assert_array_equal(again.time, tail.time)
    for name in zero.signals:
        np.testing.assert_array_equal(again[name], zero[name])


def test_rows_at_other_times_than_the_log_clocks_are_refused(recording):
    plant = vt.Plant.load("ves2")
    every = {name: values[::3] for name, values in recording.signals.items()}
    thinned = vt.Recording(recording.time[::3], every, recording.info)
    with pytest.raises(InvalidInputError, match=r"row 2 at 0\.037.* every 0\.0126.*run\.log"):
        vt.replay(thinned, plant)
    with pytest.raises(InvalidInputError, match="0 rows"):
        vt.replay(recording.window(50.0, 60.0), plant)


def test_what_cannot_be_fed_in_is_refused(recording):
    plant = vt.Plant.load("ves2")
    with pytest.raises(UnknownNameError, match=r"signal to feed in 'leg\.length'"):
        vt.replay(recording, plant, ["leg.length"])
    with pytest.raises(InvalidInputError, match=r"expected leg\.command or"):
        vt.replay(recording, plant, ["arm.command"])
    with pytest.raises(UnknownNameError, match=r"did you mean 'leg\.length'"):
        vt.replay(recording, plant, compare=["leg.lenght"])
    bare = replace(recording, info=replace(recording.info, settings="{}"))
    with pytest.raises(InvalidInputError, match="no scenario in its metadata"):
        vt.replay(bare, plant)


def test_a_replay_that_ends_early_says_how(recording):
    weak = vt.Plant.load("ves2").with_values({"sensor.range": [500.0] * 6})
    with pytest.raises(VesTwinError, match="ended after 0 of"):
        vt.replay(recording, weak)


def test_a_record_cut_in_a_motion_replays_to_its_end(recording):
    """The spline looks two commands ahead; beyond the cut the curvature goes on."""
    cut = recording.window(0.0, 1.2)  # the arm is in full swing
    again = vt.replay(cut, vt.Plant.load("ves2"))
    span = np.ptp(recording["arm.torque"], axis=0)
    # a cycle ahead the curvature changes by some per cent; held points would jerk the arm
    miss = np.abs(again["arm.torque"] - cut["arm.torque"]).max(axis=0)
    assert np.all(miss < 0.01 * span)
