"""Shares as percent: never all of it where it is not, and ends that differ look different."""

from ves_twin.core.quantity import shares


def test_a_share_below_one_never_reads_as_all_of_it():
    assert shares(0.9974, 0.9968, 0.9978) == ["99.74 %", "99.68 %", "99.78 %"]
    assert shares(0.9996) == ["99.96 %"]


def test_plain_shares_have_no_decimals():
    assert shares(0.85, 0.8, 0.91) == ["85 %", "80 %", "91 %"]
    assert shares(1.0) == ["100 %"]


def test_what_is_not_known_is_a_dash():
    assert shares(None, 0.5) == ["-", "50 %"]
