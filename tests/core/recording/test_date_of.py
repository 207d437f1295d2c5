"""Dates of recordings, by name and by the clock of an import."""

from __future__ import annotations

from datetime import datetime

import numpy as np
import pytest

from ves_twin.core.recording.date_of import date_of
from ves_twin.core.recording.recording import Recording, RecordingInfo


def recording(zero=None):
    imported = {} if zero is None else {"zero": zero}
    return Recording(np.arange(3.0), {}, RecordingInfo("measured", imported=imported))


@pytest.mark.parametrize(
    ("name", "date"),
    [
        ("2026-03-14.csv", datetime(2026, 3, 14)),
        ("axis_20260314_0930.parquet", datetime(2026, 3, 14, 9, 30)),
        ("run 2026.03.14 09-30-15.csv", datetime(2026, 3, 14, 9, 30, 15)),
        ("2026-03-14T0930", datetime(2026, 3, 14, 9, 30)),
        ("part-12345678.csv", None),
        ("2026-13-14.csv", None),
        ("2026-02-30.csv", None),
        ("run7.csv", None),
    ],
)
def test_a_date_is_read_from_a_name_or_not_at_all(name, date):
    assert date_of(name, recording()) == date


def test_a_clock_that_counts_from_1970_tells_the_date_and_another_one_does_not():
    assert date_of("run7.csv", recording(1_773_480_600.0)) == datetime(2026, 3, 14, 9, 30)
    assert date_of("run7.csv", recording(70.0)) is None
    assert date_of("2026-03-15.csv", recording(1_773_480_600.0)) == datetime(2026, 3, 15)
