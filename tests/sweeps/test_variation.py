"""Variation: how values and ranges are written."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ves_twin.core.errors import InvalidInputError
from ves_twin.sweeps.variation import Span, Variation


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("legs.gain=8,12.5,16", (8, 12.5, 16)),
        ("legs.filter=none, error", ("none", "error")),
        ("arm.start=[0,0,0],[0.1,0,0]", ([0, 0, 0], [0.1, 0, 0])),
        ('run.duration="1 s","2 s"', ("1 s", "2 s")),
        ("run.duration=1 s,2 s", ("1 s", "2 s")),
        ("run.noise=true,false", (True, False)),
        ("gravity.file=../a.toml,../b.toml", ("../a.toml", "../b.toml")),
        ("gravity.file=../a.toml", ("../a.toml",)),
    ],
)
def test_a_list_of_values_is_read_as_set_reads_one(text, values):
    variation = Variation.parse(text)
    assert variation.values == values
    assert variation.span is None


@pytest.mark.parametrize(
    ("text", "span"),
    [
        ("legs.gain=8..20", Span(8, 20, 0)),
        ("legs.gain=8..20:5", Span(8, 20, 5)),
        ("legs.gain=-1.5..-0.5:3", Span(-1.5, -0.5, 3)),
        ("arm.q=5 deg..10 deg", Span("5 deg", "10 deg", 0)),
    ],
)
def test_two_dots_are_a_range(text, span):
    assert Variation.parse(text).span == span


def test_the_seed_has_a_short_name():
    assert Variation.parse("seed=1,2").key == "run.seed"


@pytest.mark.parametrize(
    "text", ["", "legs.gain", "=1", "legs.gain=", "legs.gain=1,,2", "a=1..2:1"]
)
def test_what_is_no_variation_is_refused_in_one_line(text):
    with pytest.raises(InvalidInputError) as caught:
        Variation.parse(text)
    assert "\n" not in str(caught.value)


INTEGERS = st.integers(-(2**63), 2**63 - 1)
"""TOML's integers have 64 bits; a larger one stays a text, which the key then refuses."""


@given(st.lists(INTEGERS | st.floats(allow_nan=False, allow_infinity=False), min_size=1))
def test_numbers_come_back_as_they_were_written(numbers):
    assert Variation.parse("k=" + ",".join(map(repr, numbers))).values == tuple(numbers)
