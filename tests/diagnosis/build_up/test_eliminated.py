"""Eliminated: what trials leave beside nuisances at their best is what a fit of all leaves."""

import numpy as np
import pytest

from ves_twin.diagnosis.build_up.eliminated import Eliminated

CHANNELS, ROWS, NUISANCES, TRIALS = 3, 200, 7, 9


@pytest.fixture
def drawn():
    """Columns (c, rows, k), nuisances first, and a target (c, rows)."""
    rng = np.random.default_rng(8)
    columns = rng.standard_normal((CHANNELS, ROWS, NUISANCES + TRIALS))
    return columns, columns @ rng.standard_normal(NUISANCES + TRIALS) + 0.3


@pytest.mark.parametrize("chosen", [[], [4], [8, 0, 3], list(range(TRIALS))])
def test_amplitudes_and_errors_are_those_of_one_fit_of_all_columns(drawn, chosen):
    columns, target = drawn
    weights, prior = np.array([1.0, 0.2, 30.0]), 0.7
    gram = columns.transpose(0, 2, 1) @ columns
    cross, power = np.einsum("crk,cr->ck", columns, target), np.sum(target**2, axis=1)
    found = Eliminated.of((gram, cross, power), NUISANCES, weights, prior)
    scale = np.random.default_rng(1).uniform(0.1, 3.0, len(chosen))
    shares, left = found.fit(np.array(chosen, int), scale)

    own = columns[:, :, [*range(NUISANCES), *(NUISANCES + n for n in chosen)]]
    own = own * np.concatenate([np.ones(NUISANCES), scale])
    hessian = np.einsum("c,crk,crj->kj", weights, own, own) + prior * np.eye(own.shape[2])
    direct = np.linalg.solve(hessian, np.einsum("c,crk,cr->k", weights, own, target))
    rest = target - own @ direct
    assert shares == pytest.approx(direct, rel=1e-9, abs=1e-12)  # rounding of sums of 200 rows
    assert left == pytest.approx(np.sum(rest**2, axis=1), rel=1e-9)


def test_other_weights_or_another_prior_ask_for_another_one():
    products = np.eye(2)[None], np.ones((1, 2)), np.ones(1)
    found = Eliminated.of(products, 1, np.ones(1), 1.0)
    assert found.serves(np.ones(1), 1.0)
    assert not found.serves(np.ones(1), 0.5)
    assert not found.serves(2.0 * np.ones(1), 1.0)
