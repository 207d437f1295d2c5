"""Torques of another clock than the positions are told where all joints of an arm say so."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import drafted

from ves_twin.machines.mjcf.draft.late import Pushed, words_of_lag


def told(columns: dict[str, np.ndarray], arm, write, rows: int) -> list[str]:
    """What a draft says of lags where torques of row k are those of row k - rows."""
    count = len(columns["t"]) - abs(rows)
    begin = {"t": 0, "tau": max(-rows, 0)}
    shifted = {
        name: values[begin.get(name.rstrip("123"), max(rows, 0)) :][:count]
        for name, values in columns.items()
    }
    found, _ = drafted(arm, write(shifted))
    return [words for words in found.look if "the positions by" in words]


@pytest.mark.parametrize(("rows", "way"), [(20, "lag"), (-20, "lead")])
def test_torques_a_tenth_of_a_second_off_are_told_with_the_way(columns, arm, write, rows, way):
    """An arm's torques that come from a recorder of their own."""
    (words,) = told(columns, arm, write, rows)
    assert words.startswith(f"the efforts {way} the positions by 0.1 s")


def test_of_torques_in_time_nothing_is_told(columns, arm, write):
    assert told(columns, arm, write, 0) == []
    assert told(columns, arm, write, 1) == []


def test_one_or_two_joints_are_not_enough():
    """Play, or links that are modelled wrong, pass for a lag."""
    time = 0.01 * np.arange(2000)
    rows = np.arange(50, 1950)
    need = [np.sin(w * time) + np.sin(1.7 * w * time) for w in (2.0, 3.1, 4.3)]
    late = [np.roll(one, 10) for one in need]
    pushed = [
        Pushed(y, x[rows], np.gradient(x, 0.01)[rows], False)
        for x, y in zip(need, late, strict=True)
    ]
    assert words_of_lag(pushed[:2], rows, 0.01) == []
    (words,) = words_of_lag(pushed, rows, 0.01)
    assert "lag the positions by 0.1 s" in words


def test_one_joint_of_five_that_is_all_friction_does_not_hide_a_lag_of_the_others():
    """Of a wrist's friction a lag tells little, and its fit may get worse."""
    time, rows = 0.01 * np.arange(2000), np.arange(50, 1950)
    tones = (1.0, 1.7, 2.9, 4.1)
    need = [sum(np.sin(w * k * time + k) for k in tones) for w in (1.0, 1.3, 1.6, 1.9)]
    speeds = [np.gradient(one, 0.01) for one in need]
    pairs = [(np.roll(x, 10), x) for x in need]
    scatter = np.random.default_rng(2).standard_normal(2000)
    rubbing = (0.3 * speeds[0] + 0.1 * scatter, 0.1 * need[0])
    pushed = [
        Pushed(y, x[rows], v[rows], False)
        for (y, x), v in zip([*pairs, rubbing], [*speeds, speeds[0]], strict=True)
    ]
    (words,) = words_of_lag(pushed, rows, 0.01)
    assert "lag the positions by 0.1 s" in words
    two = [pushed[0], pushed[4], pushed[4]]
    assert words_of_lag(two, rows, 0.01) == []
