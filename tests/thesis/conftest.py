"""Shared by the tests of the scorecard."""

import pytest

from ves_twin.thesis.claim import load_claims
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluators.registry import ANSWERS
from ves_twin.thesis.verdict import judge


@pytest.fixture(scope="session")
def claims():
    return load_claims()


@pytest.fixture
def verdict_on(claims):
    """`verdict_on(claim, plant)`: evaluate a claim on a plant, nothing shared with other calls."""

    def evaluate(name, plant):
        claim = claims[name]
        return judge(claim, ANSWERS[name](Context(plant, quick=True), claim))

    return evaluate
