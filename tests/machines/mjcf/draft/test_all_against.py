"""Efforts of a whole arm that are turned are told together, before any swap of two of them."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import changed, drafted, scales

from ves_twin.machines.mjcf.draft.all_against import all_turned
from ves_twin.machines.mjcf.draft.effort_fit import EffortFit
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot

TORQUES = ("tau1", "tau2", "tau3")


def match(column: str) -> Match:
    """Of an effort's column."""
    spot = Spot(Quantity.EFFORT, column, "N*m", frozenset(), 1, joint=column)
    return Match(column, spot, "N*m", True, 1.0, ())


def work_of(sign: float) -> EffortFit:
    """Of an effort that is friction, turned or not."""
    speed = np.sin(np.linspace(0.0, 60.0, 3000))
    return EffortFit.of(sign * speed, np.zeros_like(speed), speed, free=False)


def test_all_efforts_of_an_arm_that_count_the_other_way_are_turned_together(arm, columns, write):
    log = changed(columns, **{n: -columns[n] for n in TORQUES})
    found, rig = drafted(arm, write(log))
    told = [words for words in found.look if "together they brake what they drive" in words]
    assert [words.split(":")[0] for words in told] == ["tau1, tau2, tau3"]
    assert [s for n, s in scales(rig).items() if n.endswith("effort")] == [-1.0] * 3
    assert not any("swapped" in words for words in found.look)


def test_right_efforts_stay(arm, columns, write):
    _, rig = drafted(arm, write(columns))
    assert [s for n, s in scales(rig).items() if n.endswith("effort")] == [1.0] * 3


@pytest.mark.parametrize(
    ("signs", "power", "turned"),
    [((-1, -1, -1), -1.0, True), ((-1, -1), -1.0, False), ((-1, -1, 1), -1.0, False)],
    ids=["all", "two of a small machine", "two of three"],
)
def test_nearly_all_of_three_or_more_must_act_against_their_motion(signs, power, turned):
    fits = {match(f"u{n}"): work_of(sign) for n, sign in enumerate(signs)}
    told = all_turned(list(fits), fits, power)
    assert (told is not None) is turned
    if told:
        assert [m.scale for m in told[0]] == [-1.0] * len(signs)


def test_an_effort_that_the_model_is_right_about_speaks_against_it():
    """Of four torques three were turned, and the fourth, told as turned with them, back again."""
    speed = np.sin(np.linspace(0.0, 60.0, 3000))
    need = np.cos(np.linspace(0.0, 60.0, 3000)) + 0.3 * speed
    fits = {match(f"u{n}"): work_of(-1.0) for n in range(3)}
    assert all_turned(list(fits), fits, -1.0)
    fits |= {match("u3"): EffortFit.of(need, need, speed, free=False)}
    assert all_turned(list(fits), fits, -1.0) is None


def test_efforts_that_give_power_in_all_stay():
    fits = {match(f"u{n}"): work_of(-1.0) for n in range(3)}
    assert all_turned(list(fits), fits, 0.1) is None
