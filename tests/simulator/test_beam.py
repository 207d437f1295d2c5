"""The beam experiment of the thesis runs stably for 60 s, and its error is accounted for."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.simulator.emulation_error import emulation_error

pytestmark = pytest.mark.slow

SIX_SECONDS = 476  # rows of 12.617 ms


def envelope(values: np.ndarray) -> np.ndarray:
    """Peak magnitude in each whole stretch of six seconds."""
    whole = len(values) // SIX_SECONDS * SIX_SECONDS
    return np.abs(values[:whole]).reshape(-1, SIX_SECONDS).max(axis=1)


def test_beam_is_stable_for_a_minute(beam_minute, figure):
    peaks = envelope(beam_minute["truth.pose"][:, 1])
    assert beam_minute.info.outcome == "completed"
    # thesis model on paper: 117 mm; calibrated prototype of the rig: 115 mm, decaying to 4 mm
    figure("beam: peak of Y less 115 mm", abs(peaks[0] - 0.115) * 1e3, 3.0, "mm")
    figure("beam: peak of Y in the last 6 s of 60", peaks[-1] * 1e3, 8.0, "mm")
    figure("beam: last 6 s over the first", peaks[-1] / peaks[0], 0.1, "")


def test_no_vibration_grows_at_the_structural_modes(beam_minute, figure):
    """Rows at 79 Hz resolve 10 to 13.2 Hz, where an unstable loop vibrates."""

    def vibration(rows: slice) -> float:
        y = beam_minute["truth.pose"][rows, :3] * 1e3
        spectrum = np.abs(np.fft.rfft(y * np.hanning(len(y))[:, None], axis=0)) / len(y) * 4
        f = np.fft.rfftfreq(len(y), beam_minute.info.period)
        return float(np.max(spectrum[(f > 9.0) & (f < 14.0)]))

    late = vibration(slice(-SIX_SECONDS, None))
    figure("beam: largest line from 9 to 14 Hz in the last 6 s", late, 0.05, "mm")


# A third above what was measured for seed 0; other seeds stay below it (noise is a small part).
LIMITS = {
    "y": (9.3, 3.0), "z": (4.1, 3.2), "rx": (0.9, 0.45), "ry": (0.8, 0.47), "rz": (1.2, 0.4),
}  # fmt: skip


@pytest.mark.parametrize("axis", list(LIMITS))
def test_most_of_the_error_is_the_legs_bandwidth_and_noise(beam_minute, figure, axis):
    names = ("truth.pose", "reference.pose", "reference.pose_leg_lag")
    error = emulation_error([tuple(beam_minute[name] for name in names)])[axis]
    unit = "mrad" if axis.startswith("r") else "mm"
    figure(f"beam: rms emulation error {axis}", error.rms * 1e3, LIMITS[axis][0], unit)
    figure(
        f"beam: rms that the legs do not explain, {axis}",
        error.rms_rest * 1e3,
        LIMITS[axis][1],
        unit,
    )


def test_leg_bandwidth_explains_most_of_the_error_along_the_swing(beam_minute, figure):
    truth, ideal, lag = (
        beam_minute[n][:, 1] for n in ("truth.pose", "reference.pose", "reference.pose_leg_lag")
    )
    left = np.mean((truth - lag) ** 2) / np.mean((truth - ideal) ** 2)
    figure("beam: share of the error in Y (power) not explained by the legs", left, 0.15, "")


def test_gravity_estimate_one_cycle_old_beats_a_fresh_one():
    """The reading lags by the 20 Hz low-pass, so a fresh estimate runs ahead of it."""
    rests = []
    for age in (0, 1):
        changes = {"gravity.age": age, "run.noise": False, "run.duration": 10.0}
        run = vt.simulate(vt.Scenario.load("beam_horizontal_truth", changes))
        rest = run["truth.pose"][:, 1] - run["reference.pose_leg_lag"][:, 1]
        rests.append(np.sqrt(np.mean(rest**2)))
    assert rests[1] < 0.7 * rests[0]
