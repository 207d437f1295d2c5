"""Errors travel between processes as what they are."""

import pickle

import pytest

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VersionError, VesTwinError


@pytest.mark.parametrize(
    "error",
    [
        VesTwinError("plain"),
        InvalidInputError("arm.mass", -1.0, "a mass"),
        UnknownNameError("signal", "leg.lenght", ["leg.length"]),
        VersionError("rig.toml", 7, 1),
    ],
)
def test_an_error_survives_pickling(error):
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert str(again) == str(error)


def test_a_message_lists_no_more_names_than_fit_a_terminal():
    few = str(UnknownNameError("signal", "zzz", ["a", "b"]))
    many = str(UnknownNameError("signal", "zzz", [f"column.{k:03d}" for k in range(400)]))
    assert few.endswith("known: a, b")
    assert many.endswith("column.049, and 350 more")
