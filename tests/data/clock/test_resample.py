"""Held values at the rows of a recording: neither old by jitter nor ahead of their time."""

import numpy as np
import pytest

from ves_twin.core.signals import Role
from ves_twin.data.clock.resample import resample
from ves_twin.data.mapping.import_map import Gaps, Way

STEP = 0.01


def age(period: float, jitter: float) -> float:
    """Mean time since a held ramp was stamped, at rows of STEP [s]."""
    rng = np.random.default_rng(2)
    time = np.arange(0.0, 4.0, period)
    time = time + rng.uniform(-jitter, jitter, len(time))
    rows = STEP * np.arange(20, 380)
    found = resample(time.copy(), time, period, rows, STEP, Way.HOLD, Role.COMMAND, Gaps.HOLD)
    return float(np.mean(rows - found.values))


@pytest.mark.parametrize("jitter", [2e-5, 5e-4])
def test_jitter_of_the_stamps_makes_no_command_a_row_older(jitter):
    assert abs(age(STEP, jitter)) < 0.02 * STEP


@pytest.mark.parametrize("period", [1e-3, 1e-4])
def test_a_command_that_is_faster_than_the_rows_is_not_taken_from_ahead(period):
    assert -0.1 * period < age(period, 0.0) < period
