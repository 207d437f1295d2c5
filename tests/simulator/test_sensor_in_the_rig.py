"""The force sensor in the standing rig: its noise is the table's, zeroing removes its offset."""

import numpy as np
import pytest

import ves_twin as vt

EXACT_LEGS = {"transducer.noise": 0.0, "transducer.resolution": 0.0}
"""Without the legs' own noise the platform stands still, and the wrench is constant."""


@pytest.fixture(scope="module")
def standing() -> vt.Recording:
    """Ten seconds of a platform that stands, every tick logged."""
    changes = {
        "run.duration": 10.0, "run.log": "tick",
        "platform.motion.amplitude": [0.0] * 6, "gravity.method": "truth",
        "parameters": EXACT_LEGS,
    }  # fmt: skip
    return vt.simulate(vt.Scenario.load("position_sine", changes))


def test_filtered_noise_has_the_sd_of_the_table(standing):
    values = standing["sensor.wrench"] - standing["truth.wrench"]
    spectrum = np.fft.rfft(values - values.mean(axis=0), axis=0)
    f = np.fft.rfftfreq(len(values), standing.info.period)
    power = 2.0 * np.sum(np.abs(spectrum[f > 1.0]) ** 2, axis=0) / len(values) ** 2
    table = vt.Plant.load("ves2").parameters.array("sensor.noise")
    # of noise through a 20 Hz low-pass 4.5 % lies below 1 Hz, with the slow part; counts add little
    expected = table * np.sqrt(1.0 - 1.0 / 22.2)
    # 10 s at 44 independent values a second leave 5 % of an sd at two sigma
    np.testing.assert_allclose(np.sqrt(power), expected, rtol=0.08)


def test_zeroed_sensor_reads_the_true_gravity_wrench_but_for_noise(standing):
    error = np.mean(standing["sensor.wrench"] - standing["gravity.estimate"], axis=0)
    table = vt.Plant.load("ves2").parameters
    # the slow noise moves by less than twice its sd between zeroing and the next ten seconds
    assert np.all(
        np.abs(error) < 2.0 * table.array("sensor.wander") + 0.05 * table.array("sensor.noise")
    )


def test_without_zeroing_the_offset_stays():
    changes = {
        "run.duration": 0.5,
        "gravity.method": "truth",
        "gravity.zero": False,
        "run.noise": False,
        "parameters": EXACT_LEGS,
    }
    run = vt.simulate(vt.Scenario.load("position_sine", changes))
    offset = vt.Plant.load("ves2").parameters.array("sensor.offset")
    counts = vt.Plant.load("ves2").parameters.array("sensor.resolution")
    first = run["sensor.wrench"][0] - run["gravity.estimate"][0]
    np.testing.assert_allclose(first, offset, rtol=0, atol=2 * np.max(counts))


def test_tare_without_an_estimate_reads_zero():
    changes = {
        "run.duration": 0.5, "gravity.method": "none", "run.noise": False,
        "parameters": EXACT_LEGS,
    }  # fmt: skip
    run = vt.simulate(vt.Scenario.load("position_sine", changes))
    assert np.all(np.abs(run["sensor.wrench"][0]) < 0.05)  # N: two counts of the coarsest axis


def test_drift_grows_with_time():
    drift = [0.0, 0.0, 0.5, 0.0, 0.0, 0.0]  # N/s, far above any real one
    changes = {
        "run.duration": 2.0, "run.noise": False, "parameters": {**EXACT_LEGS, "sensor.drift": drift},
        "platform.motion.amplitude": [0.0] * 6,
    }  # fmt: skip
    run = vt.simulate(vt.Scenario.load("position_sine", changes))
    grown = run["sensor.wrench"][-1, 2] - run["sensor.wrench"][0, 2]
    # the low-pass delays the ramp by 11 ms at both ends; the start is still settling into it
    assert grown == pytest.approx(0.5 * run.time[-1], abs=0.05)


def test_standing_rig_reads_no_more_noise_than_table_3_1():
    """The printed RMS of the gravity model's error holds the sensor's noise and the legs'."""
    changes = {"run.duration": 10.0, "platform.motion.amplitude": [0.0] * 6}
    run = vt.simulate(vt.Scenario.load("position_sine", changes))
    printed = np.array([0.46, 0.24, 0.46, 0.62, 1.01, 0.06])
    assert np.all(run["sensor.wrench"].std(axis=0) < printed)
