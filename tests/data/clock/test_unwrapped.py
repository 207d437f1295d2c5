"""An angle that is told within one turn is unwrapped; nothing else is touched."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.data.clock.unwrapped import unwrapped

TIME = np.linspace(0.0, 10.0, 1001)
TURNS = 2.0 * np.pi * (0.3 * TIME + 0.4 * np.sin(1.3 * TIME))


@pytest.mark.parametrize("turn", [2.0 * np.pi, 360.0])
@pytest.mark.parametrize("low", [-0.5, 0.0])
def test_a_wrapped_angle_is_the_way_that_was_turned(turn, low):
    way = TURNS * turn / (2.0 * np.pi)
    told = (way / turn - low) % 1.0 * turn + low * turn
    found, wraps = unwrapped(told, turn)
    assert wraps == np.count_nonzero(np.abs(np.diff(told)) > 0.5 * turn)
    assert wraps > 2
    assert found - found[0] == pytest.approx(way - way[0], abs=1e-9 * turn)


@pytest.mark.parametrize(
    "values",
    [
        TURNS,  # whole already
        np.where(TIME < 5.0, -1.2, 2.9),  # one step, of less than a turn
        np.sign(np.sin(TIME)) * 150.0,  # a command that is switched
        4.0 * np.random.default_rng(0).standard_normal(1000),  # steps of all sizes
        np.where(np.arange(1001) == 500, 6.2, 0.01 * np.sin(TIME)) * 0.5,  # one wrong row
        np.zeros(0),
    ],
)
def test_what_does_not_wrap_stays_as_it_is(values):
    found, wraps = unwrapped(values, 2.0 * np.pi)
    assert wraps == 0
    assert found is values
