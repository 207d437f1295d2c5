"""Stretches of a recording that are held out have rows enough, or the refusal says what to do."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.record.preprocess import fewest_rows
from ves_twin.machines.mjcf.recordings.interleaved_split import alternate, enough


def recording_of(seconds, period=0.02):
    time = period * np.arange(round(seconds / period))
    info = RecordingInfo("measured", scenario="traj8", period=period)
    return Recording(time, {"x": time[:, None]}, info)


def rows_of(recording, length, rate=100.0):
    fitted, held = alternate(recording, length, rate)
    return [len(one.time) for one in fitted], [len(one.time) for one in held]


def test_a_last_stretch_with_too_few_rows_is_joined_to_the_one_before():
    assert rows_of(recording_of(7.4), 2.0) == ([100, 170], [100])
    assert rows_of(recording_of(8.0), 2.0) == ([100, 100], [100, 100])


def test_two_stretches_of_which_one_is_too_short_are_made_equal():
    assert rows_of(recording_of(4.2), 2.5) == ([105], [105])


def test_as_few_rows_are_enough_as_the_analysis_needs():
    assert fewest_rows(0.02) == 100
    fewest = fewest_rows(0.01, 50.0)
    recording = recording_of(2 * 0.01 * fewest, 0.01)
    assert rows_of(recording, enough(recording, 50.0), 50.0) == ([fewest], [fewest])


def test_a_recording_too_short_for_two_stretches_is_refused_with_the_stretch_and_the_way_out():
    with pytest.raises(InvalidInputError) as refused:
        alternate(recording_of(3.32), 2.0, 35.0)
    words = str(refused.value)
    assert "traj8 from 2.00 to 3.30 s, a stretch of --alternate: got 66" in words
    assert "two stretches take 4.00 s, and it has 3.32 s" in words
    assert "--held-out" in words


def test_stretches_that_are_too_short_are_refused_with_a_length_that_is_taken():
    recording = recording_of(10.0)
    with pytest.raises(InvalidInputError, match=r"at least 100: --alternate 2$"):
        alternate(recording, 0.5, 100.0)
    assert min(min(rows) for rows in rows_of(recording, 2.0)) >= 100


@pytest.mark.parametrize("start", [0.0, 3.3, 1000.123])
@pytest.mark.parametrize(
    ("native", "rate"), [(10, 10), (30, 12.5), (125, 100), (250, 100), (500, 200)]
)
def test_a_length_that_is_advised_is_taken_wherever_the_clock_begins(native, rate, start):
    """By rounding 99 of 100 rows lay in a stretch of 100 periods from 3.3 s on."""
    time = start + np.arange(4 * native + 7 * fewest_rows(1.0 / native, rate)) / native
    recording = Recording(time, {"x": time[:, None]}, RecordingInfo("measured", scenario="log"))
    fitted, held = rows_of(recording, enough(recording, rate), rate)
    assert min(*fitted, *held) >= fewest_rows(1.0 / native, rate)
