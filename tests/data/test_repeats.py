"""Readings that a log repeats from row to row: found by their lengths, and taken straight between."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.data.repeats import read_at, repeats, unheld

COUNT = 2.0 * np.pi / 1250
"""Of an encoder [rad]."""


def swing(rows: int, every: int, size: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """An angle in counts at each row, and as a log has it whose sensor is read every so many."""
    angle = np.round(size * np.sin(0.02 * np.arange(rows)) / COUNT) * COUNT
    return angle, angle[every * (np.arange(rows) // every)]


@pytest.mark.parametrize("every", [1, 2, 5, 8])
def test_the_length_of_repeats_is_found(every):
    assert repeats(swing(1000, every)[1]) == every


def test_the_longest_usual_length_counts_where_two_clocks_are_out_of_step():
    rows = np.sin(0.02 * np.concatenate([[15 * k, 15 * k + 6, 15 * k + 12] for k in range(60)]))
    held = np.repeat(rows, [6, 6, 3] * 60)
    assert repeats(held) == 6


def test_steps_of_a_coarse_encoder_and_noise_are_no_repeats():
    slow = np.round(np.sin(0.002 * np.arange(4000)) / COUNT) * COUNT
    assert repeats(slow) == 1
    assert repeats(np.random.default_rng(1).standard_normal(500)) == 1
    assert repeats(np.ones(500)) == 1
    assert repeats(np.repeat([0.0, 1.0], 50)) == 1


def test_residue_of_rounding_is_no_step_of_an_encoder():
    slow = np.round(np.sin(0.002 * np.arange(4000)) / COUNT) * COUNT
    off = 1.1 * (np.arange(4000) % 7)
    assert repeats((slow + off) - off) == 1


def test_between_readings_an_angle_is_nearer_to_what_it_was():
    """Held for 5 rows it is 2 rows late in the mean."""
    angle, held = swing(1000, 5)
    late, off = held - angle, unheld(held, 5) - angle
    assert np.std(off) < 0.1 * np.std(late)
    assert np.array_equal(unheld(angle, 1), angle)


def test_readings_are_even_whatever_rows_show_them_first():
    """Every 5 rows in truth, and shown for 6, 6 and 3."""
    angle = np.sin(0.02 * np.arange(1500))
    counts = np.tile([6, 6, 3], 100)
    shown = np.repeat(angle[5 * np.arange(300)], counts)
    off = [
        np.std(np.gradient(unheld(one, 6))[50:-50] - np.gradient(angle)[50:-50])
        for one in (shown, angle[5 * (np.arange(1500) // 5)])
    ]
    jitter = np.interp(np.arange(1500), np.cumsum(counts) - counts, angle[5 * np.arange(300)])
    assert off[0] < 2.0 * off[1]
    assert off[0] < 0.25 * np.std(np.gradient(jitter)[50:-50] - np.gradient(angle)[50:-50])


def test_what_stands_still_is_read_on():
    """Else a line would be drawn from where a machine stopped to where it moved again."""
    still = np.concatenate([np.zeros(40), np.arange(1.0, 9.0).repeat(4), np.full(30, 8.0)])
    assert np.all(np.abs(unheld(still, 4)[:37]) < 1e-12)  # rounding of times of readings
    assert read_at(still, 4)[:12].tolist() == [True, False, False, False] * 3
