"""Delay lines: the signal of so many seconds ago, for any number of seconds."""

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.plant.physics import delay
from ves_twin.plant.physics.delay import LONGEST, take_late

TICK = 341e-6
ROUND_OFF = 1e-15
"""Of signals of size one: two products and a sum."""


def line(*delays):
    block = np.zeros(1, delay.PARAMETERS)
    block["slide"]["delay"][0, : len(delays)] = delays
    delay.count_ticks(block[0], TICK)
    return block


def passed(block, signal):
    """What comes out of the slide line for a signal (n, k) that stood at its first value."""
    state = np.zeros(1, delay.STATE)
    state["slide_past"][..., : signal.shape[1]] = signal[0]
    out = np.empty_like(signal)
    for now, late in zip(signal, out, strict=True):
        take_late(block[0]["slide"], state[0]["slide_past"], now, late)
    return out


@pytest.mark.parametrize("ticks", [0.25, 1.0, 7.6, LONGEST - 2.0])
def test_a_late_signal_is_the_straight_line_through_earlier_ticks(ticks):
    signal = np.random.default_rng(2).uniform(-1.0, 1.0, (200, 6))
    signal[0] = 0.0
    out = passed(line(*[ticks * TICK] * 6), signal)
    n = np.arange(200.0)
    for i in range(6):
        expected = np.interp(n - ticks, n, signal[:, i])
        np.testing.assert_allclose(out[:, i], expected, rtol=0, atol=50 * ROUND_OFF)


def test_each_column_has_its_own_delay_and_none_stays_as_it_is():
    signal = np.random.default_rng(3).uniform(-1.0, 1.0, (50, 3))
    out = passed(line(0.0, 3 * TICK), signal)
    np.testing.assert_array_equal(out[:, [0, 2]], signal[:, [0, 2]])
    np.testing.assert_allclose(out[3:, 1], signal[:-3, 1], rtol=0, atol=20 * ROUND_OFF)


def test_a_line_may_write_over_what_it_takes():
    signal = np.random.default_rng(4).uniform(-1.0, 1.0, (40, 6))
    block, state = line(*[2.5 * TICK] * 6), np.zeros(1, delay.STATE)
    state["slide_past"][:] = signal[0]
    expected = passed(block, signal)
    for now, late in zip(signal, expected, strict=True):
        take_late(block[0]["slide"], state[0]["slide_past"], now, now)
        np.testing.assert_array_equal(now, late)


def test_without_delays_there_is_no_line():
    assert line(0.0)[0]["slide"]["kept"] == 0
    assert line(1e-9)[0]["slide"]["kept"] == 2
    assert line((LONGEST - 2) * TICK)[0]["slide"]["kept"] == LONGEST


def test_a_delay_longer_than_the_line_is_refused_in_seconds():
    with pytest.raises(InvalidInputError, match=r"delay of the slide.*0\.05.*0\.0211 s, 62 ticks"):
        line(0.05)


def test_every_state_belongs_to_a_line():
    named = [past for pasts in delay.PASTS.values() for past in pasts]
    assert sorted(named) == sorted(delay.STATE.names)
    assert set(delay.PASTS) == set(delay.PARAMETERS.names)
