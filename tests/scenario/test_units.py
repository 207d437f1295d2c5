"""Texts with units become SI numbers; anything doubtful is refused."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.units import FREQUENT, _registry, to_si


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        (3, "m", 3.0),
        (3.5, "m", 3.5),
        ("3", "m", 3.0),
        ("180 deg", "rad", math.pi),
        ("90 degrees", "rad", math.pi / 2),
        ("12 mm", "m", 0.012),
        ("79.3 Hz", "Hz", 79.3),
        ("1.5 kN", "N", 1500.0),
        ("2 N*m", "N*m", 2.0),
        ("2 N m", "N*m", 2.0),
        ("10 N*m/deg", "N*m/rad", 10.0 * 180.0 / math.pi),
        ("100 bar", "Pa", 1e7),
        ("-2.5e-3 s", "s", -0.0025),
        ("2 Hz", "1/s", 2.0),
        ("90°", "rad", math.pi / 2),
    ],
)
def test_a_quantity_is_converted(value, unit, expected):
    assert to_si(value, unit, "x") == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(("given_unit", "unit"), [*FREQUENT, ("N", "N"), ("Hz", "Hz")])
@given(number=st.floats(-1e9, 1e9))
def test_the_short_way_gives_what_the_unit_library_gives_to_the_last_bit(given_unit, unit, number):
    slowly = _registry().Quantity(number, given_unit).to(unit).magnitude
    assert to_si(f"{number!r} {given_unit}", unit, "x") == slowly


@pytest.mark.parametrize(
    ("value", "unit"),
    [
        ("3 m", "s"),
        ("3 kg", "N"),
        ("3 blah", "m"),
        ("three", "m"),
        ("", "m"),
        ("nan", "m"),
        ("inf", "m"),
        ("1e999", "m"),
        (float("nan"), "m"),
        (float("-inf"), "m"),
        (True, "m"),
        (None, "m"),
        ([1.0], "m"),
        ({}, "m"),
        ("1/0", "m"),
        ("12,5 mm", "m"),
        ("[1, 2]", "m"),
        ("6.28 rad/s", "Hz"),
        ("1 Hz", "rad/s"),
        ("5 cycle/s", "Hz"),
        ("3 rps", "Hz"),
    ],
    ids=str,
)
def test_anything_else_is_refused_in_one_line(value, unit):
    with pytest.raises(InvalidInputError) as caught:
        to_si(value, unit, "leg.rod_mass")
    assert "leg.rod_mass" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_percentage_is_a_hundredth():
    assert to_si("50 %", "1", "x") == 0.5


@settings(deadline=None, derandomize=True, max_examples=200)
@given(st.floats(-1e6, 1e6))
def test_a_number_with_a_unit_is_the_number(value):
    assert to_si(f"{value!r} m", "m", "x") == value
    assert to_si(value, "m", "x") == value


@settings(deadline=None, derandomize=True, max_examples=100)
@given(st.text("0123456789.,eE+-*/ ()[]mdegrasNkHz%#\n", max_size=12))
def test_any_text_is_a_finite_number_or_refused(text):
    try:
        number = to_si(text, "m", "x")
    except InvalidInputError:
        return
    assert math.isfinite(number)
