"""Shared fixtures: short runs that many tests look at are made once."""

from __future__ import annotations

import pytest

import ves_twin as vt


@pytest.fixture(scope="session")
def beam_run() -> vt.Recording:
    """Five seconds of the beam scenario: the arm's move and the first swing."""
    return vt.simulate(vt.Scenario.load("beam_horizontal_truth", {"run.duration": 5.0}))


@pytest.fixture(scope="session")
def quiet_beam() -> vt.Scenario:
    """The beam scenario without noise, short."""
    return vt.Scenario.load("beam_horizontal_truth", {"run.duration": 3.0, "run.noise": False})
