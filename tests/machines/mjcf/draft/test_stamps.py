"""Stamps that a row repeats: a few rows are left out, a clock that is too coarse is refused."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import drafted

from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording


def with_repeats(columns, rows):
    """A log in which some rows have the stamp, and nothing else, of the row before."""
    time = columns["t"].copy()
    time[rows] = time[rows - 1]
    return columns | {"t": time}


def test_a_few_rows_that_repeat_a_stamp_are_left_out_and_told(arm, columns, write):
    rows = np.arange(50, len(columns["t"]), 100)
    _, rig = drafted(arm, write(columns))
    whole = read_rig_recording(write(columns), rig)
    found = read_rig_recording(write(with_repeats(columns, rows)), rig)
    told = found.info.imported["suspected"]
    assert [f"stamp of the row before are left out: {len(rows)}" in words for words in told] == [
        True
    ]
    path = "turn.position"
    kept = np.interp(whole.time, found.time, found[path][:, 0])
    assert np.max(np.abs(kept - whole[path][:, 0])) < 0.01 * np.ptp(whole[path])


def test_a_log_with_repeated_stamps_is_drafted(arm, columns, write):
    """It was refused, by a row of its window, though its own text had told of them."""
    rows = np.arange(50, len(columns["t"]), 100)
    found, _ = drafted(arm, write(with_repeats(columns, rows)))
    assert any(f"{len(rows)} steps do not rise" in words for words in found.look)


def test_a_clock_that_repeats_every_other_stamp_is_refused(arm, columns, write):
    _, rig = drafted(arm, write(columns))
    rows = np.arange(1, len(columns["t"]), 2)
    with pytest.raises(InvalidInputError, match="strictly increasing"):
        read_rig_recording(write(with_repeats(columns, rows)), rig)
