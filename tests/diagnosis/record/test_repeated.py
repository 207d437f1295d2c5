"""A held-out programme that is a fitted one over again is told from another one."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.repeated import moved_alike, repeated


def programme(begin: float = 0.0, length: float = 10.0, noise: float = 0.0, speed: float = 1.0):
    """A round of two joints, from some time on."""
    time = np.arange(0.0, length, 0.01)
    angle = speed * (time + begin) + 0.3 * np.sin(0.4 * (time + begin))
    path = np.stack([np.sin(angle), np.cos(1.7 * angle)], axis=1)
    path += noise * np.random.default_rng(int(100 * begin)).standard_normal(path.shape)
    return Excitation("round", time, {"q": path})


def test_the_same_programme_again_is_told_though_it_begins_later_and_is_noisy():
    assert repeated([programme()], [programme()])
    assert repeated([programme(begin=0.37, noise=1e-3)], [programme(noise=1e-3)])
    assert repeated([programme(length=9.0)], [programme(begin=50.0), programme()])


@pytest.mark.parametrize("other", [{"begin": 40.0}, {"speed": 1.05}, {"noise": 0.1}])
def test_another_programme_is_none(other):
    assert not repeated([programme(**other)], [programme()])


def test_one_other_programme_is_enough_to_try_what_is_proved():
    assert not repeated([programme(), programme(begin=40.0)], [programme()])
    assert not repeated([], [programme()])


def test_what_is_let_go_is_fed_nothing_that_could_repeat():
    still = Excitation("let go", np.arange(0.0, 5.0, 0.01), {})
    assert not repeated([still], [still])


def test_other_inputs_or_a_longer_programme_are_not_found():
    assert not repeated(
        [Excitation("x", programme().time, {"x": np.ones((1000, 1))})], [programme()]
    )
    assert not repeated([programme(length=30.0)], [programme()])


def test_a_held_command_tells_no_motion_that_repeats():
    """A pendulum let go beside a motor at 0 V, or at 12 V with a reading's noise."""
    time, rng = np.arange(0.0, 5.0, 0.01), np.random.default_rng(1)
    for volts in (np.zeros((500, 1)), 12.0 + 0.01 * rng.standard_normal((500, 1))):
        held = Excitation("held", time, {"u": volts})
        assert not repeated([held], [held])


def test_a_small_joint_beside_a_large_one_counts_by_its_own_range():
    one, other = programme(), programme(begin=40.0)
    both = np.column_stack([one.drive["q"][:, 0], 0.01 * one.drive["q"][:, 1]])
    apart = np.column_stack([one.drive["q"][:, 0], 0.01 * other.drive["q"][:, 1]])
    told = Excitation("a", one.time, {"q": both})
    assert repeated([told], [told])
    assert not repeated([Excitation("b", one.time, {"q": apart})], [told])


def test_one_motion_by_other_commands_is_that_motion_again():
    """Switched currents of a cart's swing-up come at other instants, and the cart moves alike."""
    first, again, other = programme(), programme(noise=0.01), programme(speed=1.05)
    assert moved_alike([again], [first])
    assert not moved_alike([other], [first])
    assert not moved_alike([again, other], [first])


def test_two_wheels_that_turn_on_and_on_are_told_apart_by_what_they_do_beside_that():
    time = np.arange(0.0, 10.0, 0.01)
    one, other = (5.0 * time + 0.3 * np.sin(f * time) for f in (2.0, 5.1))
    told = [Excitation("wheel", time, {"q": q[:, None]}) for q in (one, other)]
    assert moved_alike(told[:1], told[:1])
    assert not moved_alike(told[:1], told[1:])


@pytest.mark.parametrize("empty", ["held", "fitted", "both"])
def test_of_motions_with_empty_cells_nothing_is_said(empty):
    whole = programme()
    path = whole.drive["q"].copy()
    path[500] = np.nan
    holed = Excitation("round", whole.time, {"q": path})
    held = whole if empty == "fitted" else holed
    fitted = whole if empty == "held" else holed
    assert not moved_alike([held], [fitted])
