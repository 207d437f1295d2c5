"""The linear hydraulics are the small-signal limit of the pressure form, in the whole rig."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.plant.modes import structural_modes

pytestmark = pytest.mark.slow


def gain_at(plant: str, frequency: float, leg_filter: str) -> complex:
    """Leg response length / command at a frequency, all legs heaving together by 2 mm."""
    changes = {
        "plant": plant, "run.duration": 6.0, "run.log": "leg", "run.noise": False,
        "platform.rate": 586.0, "legs.filter": leg_filter,
        "platform.motion.amplitude": [0.0, 0.0, 0.002, 0.0, 0.0, 0.0],
        "platform.motion.frequency": [frequency] * 6, "platform.motion.fade": 0.5,
    }  # fmt: skip
    run = vt.simulate(vt.Scenario.load("position_sine", changes))
    late = run.window(3.0, 6.0)
    wave = np.exp(-2j * np.pi * frequency * late.time)
    window = np.hanning(len(late))

    def line(values: np.ndarray) -> complex:
        return complex(np.sum((values - values.mean()) * wave * window))

    legs = [line(late["leg.length"][:, i]) / line(late["leg.command"][:, i]) for i in range(6)]
    return complex(np.mean(legs))


@pytest.mark.parametrize("leg_filter", ["none", "error", "feedback"])
def test_pressure_form_answers_as_the_linear_one_does(figure, leg_filter):
    for frequency in (1.0, 2.0, 3.0):
        linear, pressure = (gain_at(p, frequency, leg_filter) for p in ("ves2", "ves2_pressure"))
        name = (
            f"leg response at {frequency:g} Hz, filter {leg_filter}: pressure against linear form"
        )
        figure(name, abs(pressure - linear) / abs(linear) * 100, 5.0, "%")


def test_pressure_form_keeps_the_beam_stable_and_its_peak(figure):
    scenario = vt.Scenario.load("beam_horizontal_truth", {"plant": "ves2_pressure"})
    run = vt.simulate(scenario)
    y = run["truth.pose"][:, 1] * 1e3
    assert run.info.outcome == "completed"
    figure(
        "beam with pressure hydraulics: peak of Y less 115 mm",
        abs(np.max(np.abs(y)) - 115.0),
        3.0,
        "mm",
    )
    figure(
        "beam with pressure hydraulics: peak of Y in the last 6 s",
        np.max(np.abs(y[-476:])),
        10.0,
        "mm",
    )


def test_first_mode_stays_with_the_pressure_form():
    """Bending makes the mode, so that the oil's form matters little."""
    linear, pressure = (
        structural_modes(vt.Plant.load(p), np.zeros(6), np.zeros(3))[0].frequency
        for p in ("ves2", "ves2_pressure")
    )
    assert pressure == pytest.approx(linear, rel=0.02)
