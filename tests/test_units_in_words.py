"""units: what stands behind a number."""

from __future__ import annotations

import pytest

from ves_twin.core.units import SI_UNITS, unit_tail
from ves_twin.diagnosis.verdict.cause import Estimate


@pytest.mark.parametrize("unit", sorted(SI_UNITS))
def test_a_unit_stands_behind_its_number_unless_it_is_a_count_or_a_share(unit):
    shown = f"3{unit_tail(unit)}"
    assert shown == ("3" if unit in ("1", "dimensionless") else f"3 {unit}")


def test_a_gain_that_is_found_has_no_unit_in_words():
    gain = Estimate(-0.0212, -0.0233, -0.0192, "1", 0.0)
    assert gain.words == "-0.0212 (nominal 0; -0.0233 to -0.0192)"


def test_a_place_that_moved_is_told_with_how_far_it_moved():
    """`shift = -0.087 m (nominal -0.12)` of a mass centre was read as a shift."""
    place = Estimate(-0.087, -0.107, -0.067, "m", -0.12)
    assert place.words == "-0.087 m (nominal -0.12, a change of 0.033; -0.107 to -0.067)"
