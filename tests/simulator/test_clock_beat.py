"""Set-points that legs and amplifiers see for an uneven number of cycles shake the payload."""

import numpy as np
import pytest

import ves_twin as vt

MOVING = {"run.duration": 3.5, "run.noise": False}


def quick_force(rate: float) -> float:
    """rms above 5 Hz of the sensor's y force while the emulated beam swings [N], without noise."""
    scenario = vt.Scenario.load("beam_horizontal_truth", {**MOVING, "platform.rate": rate})
    run = vt.simulate(scenario, vt.Plant.load("ves2_fast"))
    force = (run["sensor.wrench"] - run["gravity.estimate"])[run.time > 2.7, 1]
    spectrum = np.fft.rfft((force - force.mean()) * np.hanning(len(force)))
    slow = np.fft.rfftfreq(len(force), run.info.period) <= 5.0
    spectrum[slow] = 0.0
    return float(np.sqrt(np.mean(np.fft.irfft(spectrum, len(force)) ** 2)))


def test_the_ripple_of_a_moving_platform_is_the_beat_of_its_clocks():
    """37 ticks are no whole number of the legs' 5 and the amplifiers' 3; 45 are of both."""
    assert quick_force(80.0) > 3.0
    assert quick_force(65.2) == pytest.approx(0.0, abs=0.1)
