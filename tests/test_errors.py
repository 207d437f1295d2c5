"""Errors travel between processes as what they are."""

import pickle

import pytest

from ves_twin.errors import InvalidInputError, UnknownNameError, VersionError, VesTwinError


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
