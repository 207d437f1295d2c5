"""A rig with structure that its model lacks, diagnosed against itself in order."""

import numpy as np
import pytest
from pendulum import BLIND, PLANT, SPRING

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.suites.machine import BlindRig


@pytest.fixture(scope="module")
def settings(banks):
    return Settings(nulls=40, cache=banks)


def record(seed, programme="train", hidden=None):
    """One rig, always with drag that the library lacks; noise anew for each recording."""
    values = BLIND.commissioned(np.random.default_rng(7))
    for name, size in (hidden or {}).items():
        values[name] = values.get(name, 0.0) + size
    rig = BlindRig(values, "quadratic_drag", 0.005)
    return BLIND.record(rig, programme, np.random.default_rng(seed))


@pytest.mark.nightly
def test_what_is_always_there_is_no_fault_and_what_came_is_named(settings):
    sick = record(1, hidden={SPRING: 0.02})
    assert diagnose(PLANT, [sick], settings=settings).verdict is not Kind.NAMED
    usual = [record(2)]
    verdict = diagnose(PLANT, [sick], baseline=usual, settings=settings)
    assert (verdict.verdict, verdict.causes[0].effect) == (Kind.NAMED, "joint_spring")
    assert verdict.basis.baseline == "measured"
    same = diagnose(PLANT, [record(3)], baseline=usual, settings=settings)
    assert same.verdict is Kind.NOTHING


def test_a_baseline_of_another_programme_is_refused(settings):
    with pytest.raises(InvalidInputError, match="baseline of recording 1"):
        diagnose(PLANT, [record(1)], baseline=[record(2, "held_out")], settings=settings)
