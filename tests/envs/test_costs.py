"""Costs and channels against closed forms."""

import numpy as np
import pytest

from ves_twin.envs.channels import Channel, Channels
from ves_twin.envs.costs import VIBRATION_CORNER, VIBRATION_LIMIT, Costs, Limits
from ves_twin.simulator.cycles import SAMPLE

PERIOD = 1.0 / 75.0
LIMITS = Limits(np.full(6, 1.5), 0.2, np.array([100.0] * 3 + [50.0] * 3))


def sample(leg_length, wrench):
    """Readings of one cycle."""
    samples = np.zeros(1, SAMPLE)
    samples["leg_length"], samples["wrench"] = leg_length, wrench
    return samples


def costs_after(force):
    """Costs after forces along x (n,), legs at home."""
    costs = Costs(LIMITS, PERIOD)
    costs.begin(np.array([force[0], 0.0, 0.0]))
    for value in force:
        costs.update(sample(np.full(6, 1.5), np.array([value, 0, 0, 0, 0, 0.0])))
    return costs


def test_nothing_is_free_of_cost_up_to_nine_tenths_and_one_at_the_limit():
    costs = Costs(LIMITS, PERIOD)
    for share, expected in ((0.5, 0.0), (0.9, 0.0), (0.95, 0.5), (1.0, 1.0), (1.1, 2.0)):
        length = np.full(6, 1.5)
        length[2] -= share * 0.2
        costs.update(sample(length, np.zeros(6)))
        assert costs.costs()["stroke"] == pytest.approx(expected, abs=1e-9)
        costs.update(sample(np.full(6, 1.5), np.array([0, 0, 0, 0, -share * 50.0, 0])))
        assert costs.costs()["wrench"] == pytest.approx(expected, abs=1e-9)


def test_a_steady_force_is_no_vibration():
    assert costs_after(np.full(300, 80.0)).used[2] == 0.0


@pytest.mark.parametrize("frequency", [8.0, 12.0, 18.0])
def test_a_vibration_counts_by_its_rms_behind_two_high_passes(frequency):
    """Each section z-transforms to k (1 - 1/z) / (1 - k/z); its gain at the frequency is exact."""
    time = np.arange(600) * PERIOD
    used = costs_after(60.0 * np.sin(2 * np.pi * frequency * time)).used[2]
    keep = 1.0 / (1.0 + 2.0 * np.pi * VIBRATION_CORNER * PERIOD)
    z = np.exp(2j * np.pi * frequency * PERIOD)
    gain = abs(keep * (1 - 1 / z) / (1 - keep / z)) ** 2
    # the mean square over 0.5 s still ripples with the vibration
    assert used == pytest.approx(gain * 60.0 / np.sqrt(2.0) / VIBRATION_LIMIT, rel=0.05)


def test_slow_forces_hardly_count():
    time = np.arange(600) * PERIOD
    slow = costs_after(60.0 * np.sin(2 * np.pi * 0.5 * time)).used[2]
    fast = costs_after(60.0 * np.sin(2 * np.pi * 12.0 * time)).used[2]
    assert slow < 0.05 * fast


def test_a_vector_has_its_values_in_order_and_within_bounds():
    table = Channels(
        Channel.within("a", ("m", "m"), 1.0, "two"),
        Channel("b", ("s",), np.zeros(1), np.ones(1), "one"),
    )
    row = table.vector({"b": np.array([5.0]), "a": np.array([0.5, -3.0])})
    np.testing.assert_array_equal(row, [0.5, -1.0, 1.0])
    assert table.columns == ("a.1", "a.2", "b")
    np.testing.assert_array_equal(table.split(row)["a"], [0.5, -1.0])
