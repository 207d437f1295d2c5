"""Shares as percent: never all of it where it is not, and ends that differ look different."""

import pytest

from ves_twin.core.quantity import shares
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.report.diagnosis.basis import taken_words


def test_a_share_below_one_never_reads_as_all_of_it():
    assert shares(0.9974, 0.9968, 0.9978) == ["99.74 %", "99.68 %", "99.78 %"]
    assert shares(0.9996) == ["99.96 %"]


def test_plain_shares_have_no_decimals():
    assert shares(0.85, 0.8, 0.91) == ["85 %", "80 %", "91 %"]
    assert shares(1.0) == ["100 %"]


def test_what_is_not_known_is_a_dash():
    assert shares(None, 0.5) == ["-", "50 %"]


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ((0.06, 0.01, 0.12), "6 % of"),
        ((0.06, 0.01, 0.12), "(1 % to 12 %)"),
        ((1.0, 0.99998, 1.00002), "more than 99 % of"),
        ((1.04, 0.97, 1.1), "100 % of"),
        ((1.04, 0.97, 1.1), "(97 % to 100 %)"),
    ],
)
def test_what_is_taken_away_is_told_with_its_range_and_never_more_than_all(told, words):
    assert words in taken_words(Gain(*told, before=9.0, after=1.0))
