"""Dahl's friction and a joint's ripple along given positions: closed forms of the physics."""

from __future__ import annotations

from math import exp

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.effects import DahlFriction, DriveCrossTalk, FrictionBehindGap, Ripple

LEVEL, TRAVEL = 3.0, 0.05
DAHL = DahlFriction("axis", LEVEL, TRAVEL)


def there_and_back(reach: float, rows: int) -> np.ndarray:
    """From zero up to the reach, down to its negative, and up again."""
    turns = [(0.0, reach), (reach, -reach), (-reach, reach)]
    return np.concatenate([np.linspace(*ends, rows) for ends in turns])


def test_dahls_friction_sets_in_and_turns_round_by_its_exponential():
    x = there_and_back(0.12, 400)
    effort = DAHL.hold(x)
    up, down = x[:400], x[400:800]
    assert effort[:400] == pytest.approx(LEVEL * (1.0 - np.exp(-up / TRAVEL)))
    turn = effort[399]
    expected = -LEVEL + (LEVEL + turn) * np.exp(-(0.12 - down) / TRAVEL)
    assert effort[400:800] == pytest.approx(expected)


def test_dahls_friction_depends_on_the_path_and_not_on_how_finely_it_is_told():
    fine = DAHL.hold(there_and_back(0.12, 1201))
    coarse = DAHL.hold(there_and_back(0.12, 13))
    assert fine[::100][[0, 5, 12]] == pytest.approx(coarse[[0, 5, 12]])
    assert fine[-1] == pytest.approx(coarse[-1])


def test_a_wide_loop_of_dahls_friction_takes_its_level_less_its_travel():
    """4 level (reach - travel) a cycle, but for what two turns remember of each other."""
    x = there_and_back(1.0, 20001)[20001:]
    effort = DAHL.hold(np.concatenate([[0.0, 1.0], x]))[2:]
    work = float(np.sum(0.5 * (effort[1:] + effort[:-1]) * np.diff(x)))
    assert work == pytest.approx(4.0 * LEVEL * (1.0 - TRAVEL), rel=1e-6 + 2.0 * exp(-1.0 / TRAVEL))


def test_without_travel_dahls_friction_is_dry_friction():
    x = np.sin(np.linspace(0.0, 10.0, 500))
    moving = np.append(False, np.abs(np.diff(x)) > 1e-4)
    expected = LEVEL * np.sign(np.diff(x, prepend=0.0))[moving]
    assert DahlFriction("axis", LEVEL).hold(x)[moving] == pytest.approx(expected)


def test_presliding_is_softer_by_dahl_than_by_a_spring_and_a_slider():
    """Both of one stiffness at rest; the slider is at its level after one travel."""
    x = np.linspace(0.0, TRAVEL, 50)
    slider = FrictionBehindGap("axis", LEVEL, travel=TRAVEL).hold(x)
    assert slider[-1] == pytest.approx(LEVEL)
    assert DAHL.hold(x)[-1] == pytest.approx(LEVEL * (1.0 - exp(-1.0)))
    assert DAHL.hold(x)[1] == pytest.approx(slider[1], rel=0.02)


def test_a_ripple_has_its_waves_and_gives_back_over_a_turn_what_it_took():
    turn = np.linspace(0.0, 2.0 * np.pi, 3201)[:-1]
    effort = Ripple("axis.320", 0.3, -0.4).hold(turn)
    spectrum = np.abs(np.fft.rfft(effort)) / 1600.0
    assert spectrum[320] == pytest.approx(0.5)  # root of 0.3^2 + 0.4^2
    assert np.delete(spectrum, 320) == pytest.approx(0.0, abs=1e-12)
    assert float(np.mean(effort)) == pytest.approx(0.0, abs=1e-12)  # its work over a turn


@pytest.mark.parametrize(
    ("target", "joint"), [("axis.320", "axis"), ("rail.196.35", "rail"), ("leg/a.b.12", "leg/a.b")]
)
def test_a_ripple_says_joint_and_waves(target, joint):
    assert Ripple(target).parts == (joint,)


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        (Ripple("axis"), "waves a turn, as axis.320"),
        (Ripple("axis.x"), "waves a turn, as axis.320"),
        (DriveCrossTalk("one"), "two drives, as motor_5 from motor_6"),
        (DriveCrossTalk("one from one"), "two drives"),
    ],
)
def test_a_target_that_says_too_little_is_one_clear_line(effect, words):
    with pytest.raises(InvalidInputError, match=words):
        _ = effect.parts
