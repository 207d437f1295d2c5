"""What the motion of held-out recordings asks for tells a law from what only simulates well."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from dragged_arm import fitted, seen

from ves_twin.diagnosis.build_up.halves import split
from ves_twin.diagnosis.law.asked import HALF, Asked, asked_of_motion
from ves_twin.diagnosis.law.finding import refuted
from ves_twin.effects.law import Law, LawKind, LawShape


def law() -> Law:
    return fitted().candidate.law(fitted().numbers)


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_the_share_of_a_law_that_is_in_a_motion_is_found(share):
    """Within 0.05: the table's lines between its knots, and a rotor that is off."""
    asked = asked_of_motion(law(), fitted(), seen(6, share))
    assert asked is not None
    assert asked.share == pytest.approx(share, abs=0.05)
    assert asked.sd < 0.1


def test_a_law_is_asked_of_stretches_of_the_very_record_that_it_is_fitted_to():
    """There the held-out half has the programmes of the fitted one, and no number of the law."""
    _, rest = split(seen(5))
    asked = asked_of_motion(law(), fitted(), rest)
    assert asked is not None
    assert asked.share == pytest.approx(1.0, abs=0.1)  # half of the rows


def test_a_law_that_a_motion_has_none_of_is_refuted_with_the_figure():
    words = refuted(asked_of_motion(law(), fitted(), seen(6, 0.0)))
    found = re.fullmatch(r"inverse dynamics finds (-?\d+) % \(\+- (\d+) %\) of .*", words)
    share, sd = (int(part) for part in found.groups())
    assert abs(share) <= 2 * sd + 1


def test_a_law_that_is_there_is_not_refuted():
    assert refuted(asked_of_motion(law(), fitted(), seen(6))) == ""


def test_a_motion_that_noise_hides_says_nothing():
    """A tenth of a radian at 50 Hz: some 100 rad/s^2 where the motion has 10."""
    assert asked_of_motion(law(), fitted(), seen(6, 0.0, 0.1)) is None


def test_a_law_without_a_table_or_of_a_reading_says_nothing():
    one = law()
    for other in (
        replace(one, kind=LawKind.READING),
        replace(one, shape=LawShape.STOP, values=(0.5, 1.0, 100.0, 1.0, 0.0)),
    ):
        assert asked_of_motion(other, fitted(), seen(6)) is None


def test_half_a_law_is_refuted_only_where_two_sd_are_below_it():
    assert refuted(Asked(0.3, 0.05))
    assert not refuted(Asked(0.3, 0.2))
    assert not refuted(Asked(HALF, 0.0001))
    assert not refuted(None)
    assert np.isclose(Asked(0.3, 0.05).most, 0.4)
