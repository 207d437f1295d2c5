"""The linear hydraulics are the small-signal limit of the pressure form, in the whole rig."""

import numpy as np
import pytest
from sizes import nightly_but

import ves_twin as vt
from ves_twin.plant.modes import structural_modes

pytestmark = pytest.mark.slow


def gain_at(plant: str, frequency: float, leg_filter: str, gain: float = 12.6) -> complex:
    """Leg response length / command at a frequency, all legs heaving together by 2 mm."""
    changes = {
        "plant": plant, "run.duration": 6.0, "run.log": "leg", "run.noise": False,
        "platform.rate": 586.0, "legs.filter": leg_filter, "legs.gain": gain,
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


@pytest.mark.parametrize("leg_filter", nightly_but(2, ["none", "feedback", "error"]))
def test_pressure_form_answers_as_the_linear_one_does(figure, leg_filter):
    for frequency in (1.0, 2.0, 3.0):
        linear, pressure = (gain_at(p, frequency, leg_filter) for p in ("ves2", "ves2_pressure"))
        name = (
            f"leg response at {frequency:g} Hz, filter {leg_filter}: pressure against linear form"
        )
        figure(name, abs(pressure - linear) / abs(linear) * 100, 5.0, "%")


def bandwidth(plant: str, leg_filter: str, gain: float, near: float) -> float:
    """Frequency of -3 dB [Hz], between two that bracket it, log gain over log frequency."""
    edges = np.log(np.array([0.93, 1.07]) * near)
    drops = [np.log(abs(gain_at(plant, float(np.exp(e)), leg_filter, gain))) for e in edges]
    half_power = -0.5 * np.log(2.0)
    assert drops[1] < half_power < drops[0]
    return float(np.exp(np.interp(-half_power, -np.array(drops), edges)))


@pytest.mark.parametrize(
    ("gain", "leg_filter", "near"),
    nightly_but(
        2,
        [
            (12.6, "none", 2.2), (20.9, "feedback", 7.1), (12.6, "error", 2.9),
            (12.6, "feedback", 2.9), (20.9, "none", 3.9), (20.9, "error", 6.5),
        ],
    ),
)  # fmt: skip
def test_leg_bandwidths_of_both_forms_agree(figure, gain, leg_filter, near):
    linear, pressure = (bandwidth(p, leg_filter, gain, near) for p in ("ves2", "ves2_pressure"))
    name = f"leg bandwidth, gain {gain:g}, filter {leg_filter}: {linear:.2f} Hz linear, pressure off by"
    figure(name, abs(pressure / linear - 1.0) * 100, 5.0, "%")


def ripple(run: vt.Recording, begin: float, end: float) -> tuple[float, float]:
    """Largest rms of a leg's error less a quartic [mm], and the frequency of its peak [Hz]."""
    part = run.window(begin, end)
    time = part.time - begin
    error = part["leg.length"] - part["leg.command"]
    smooth = np.array([np.polyval(np.polyfit(time, e, 4), time) for e in error.T]).T
    rough = error - smooth
    spectrum = np.abs(np.fft.rfft(rough * np.hanning(len(time))[:, None], 8192, axis=0))
    peak = np.unravel_index(np.argmax(spectrum), spectrum.shape)[0]
    rate = np.fft.rfftfreq(8192, float(np.mean(np.diff(time))))[peak]
    return float(np.max(rough.std(axis=0))) * 1e3, float(rate)


WIDE = {"parameters.sensor.range": [1e6] * 6}
"""A force sensor that no limit cycle drives out of range."""


def test_instability_grows_at_the_structural_mode_into_a_limit_cycle(figure):
    """Gain 18 without filter: growth first, then saturated valves hold the oscillation."""
    changes = {"plant": "ves2_pressure", "legs.gain": 18.0, "run.duration": 5.0, "run.log": "leg"}
    run = vt.simulate(vt.Scenario.load("beam_horizontal_truth", {**changes, **WIDE}))
    early, growing, late = (ripple(run, a, a + 1.0) for a in (1.0, 2.0, 4.0))
    assert run.info.outcome == "completed"
    assert growing[0] > 5.0 * early[0]
    assert late[0] > 3.0 * growing[0]
    assert 10.0 < growing[1] < 13.2  # thesis 5.2
    figure("pressure form, gain 18: limit cycle after 4 s, rms of a leg", late[0], 60.0, "mm")
    area, supply = np.pi / 4 * 0.05**2, 1e7
    assert np.max(np.abs(run["truth.leg_force"])) < area * supply  # what the pump can hold


def test_with_the_sensor_as_it_is_growth_ends_the_run_and_is_on_record():
    changes = {"plant": "ves2_pressure", "legs.gain": 18.0, "run.duration": 8.0, "run.log": "leg"}
    run = vt.simulate(vt.Scenario.load("beam_horizontal_truth", changes))
    assert run.info.outcome == "wrench_range"
    end = run.time[-1]
    assert ripple(run, end - 0.5, end)[0] > 3.0 * ripple(run, end - 1.5, end - 1.0)[0]


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
