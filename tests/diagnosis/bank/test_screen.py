"""The screen against the inner product it stands for."""

from __future__ import annotations

import numpy as np
import pytest
from toy import Toy, programme, record

from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.prewhitened import Prewhitened
from ves_twin.diagnosis.bank.screen import Screen
from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.whitening import whitening_declared

ROUNDING = 1e-9
"""Of sums over 1600 samples in double precision, after four digits cancel."""


@pytest.fixture(scope="module")
def seen():
    return preprocess(Toy(), [record(np.random.default_rng(2), fed=programme())], Workers(1), 50.0)


@pytest.fixture(scope="module")
def bank(seen):
    return build_bank(seen.runs)


def test_power_gram_and_match_are_those_of_the_marginal_covariance(seen, bank):
    screen = Screen(bank, whitening_declared(seen.runs))
    z = screen.whitening.apply(seen.measured - bank.base.prediction)
    shapes = np.array([screen.whitening.apply(bank.signature(k)) for k in range(len(bank.owner))]).T
    columns = screen.metric.columns
    covariance = np.eye(len(z)) + columns @ columns.T
    weighted = np.linalg.solve(covariance, shapes)
    gram = shapes.T @ weighted
    scale = np.max(gram)
    assert screen.gram == pytest.approx(gram, rel=1e-5, abs=ROUNDING * scale)  # single shapes
    assert screen.power == pytest.approx(np.diag(gram), rel=1e-5, abs=ROUNDING * scale)
    assert screen.match(z) == pytest.approx(weighted.T @ z, rel=1e-5, abs=1e-5)


def test_a_bank_filtered_before_is_the_bank_under_any_colour_and_level(seen, bank):
    declared = whitening_declared(seen.runs)
    z = declared.apply(seen.measured - bank.base.prediction)
    own = declared.adapted(z)
    assert not np.array_equal(own.colour, declared.colour)
    shaped = Prewhitened(bank, declared)
    assert shaped.bent(own) == pytest.approx(own.apply(bank.bent).T, rel=1e-12, abs=1e-12)
    assert shaped.columns(own) == pytest.approx(own.apply(bank.base.columns).T, abs=1e-12)
