"""Frozen values: their arrays cannot be written either."""

from dataclasses import fields, replace

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.simulator.build import belief_of, emulated_of


def arrays_of(value: ReadOnly) -> list[np.ndarray]:
    """Every array of a value, also those in its mappings."""
    found = [getattr(value, field.name) for field in fields(value)]
    inner = [item for one in found if isinstance(one, dict) for item in one.values()]
    return [one for one in [*found, *inner] if isinstance(one, np.ndarray)]


@pytest.fixture(scope="module")
def recording() -> Recording:
    values = {"leg.length": np.ones((3, 6))}
    return Recording(np.arange(3.0), values, RecordingInfo("measured"))


def test_a_recording_cannot_be_written(recording):
    for array in arrays_of(recording):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 7.0
    for part in (recording.window(0.0, 2.0), replace(recording, info=recording.info)):
        assert len(arrays_of(part)) == 2
        assert not any(array.flags.writeable for array in arrays_of(part))


def test_what_made_an_array_may_write_it_still():
    time = np.arange(3.0)
    assert not Recording(time, {}, RecordingInfo("measured")).time.flags.writeable
    time[0] = -1.0


def test_what_a_run_rests_on_cannot_be_written():
    """Geometry, belief and beam are shared by everything that is built from them."""
    scenario = vt.Scenario.load("beam_horizontal_truth")
    belief = belief_of(scenario)
    for value in (belief, belief.geometry, emulated_of(scenario)):
        assert arrays_of(value)
        assert not any(array.flags.writeable for array in arrays_of(value))
