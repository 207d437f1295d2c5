"""Intervals count choices of causes that are not proved, each weighed by its evidence."""

from itertools import product
from math import comb

import numpy as np
import pytest
from linear import Linear, halves
from scipy.stats import multivariate_normal

from ves_twin.diagnosis.build_up import averaged
from ves_twin.diagnosis.build_up.averaged import _Chain, averaged_half_widths
from ves_twin.diagnosis.build_up.discrepancy import discrepancy


def enumerated(columns, target, spread):
    """Probability of each choice, and mean and variance of the first amplitude, by closed forms."""
    found = []
    for chosen in product((False, True), repeat=columns.shape[1]):
        part = columns[:, list(chosen)]
        covariance = np.eye(len(target)) + spread**2 * part @ part.T
        evidence = multivariate_normal(np.zeros(len(target)), covariance).logpdf(target)
        evidence -= np.log(comb(len(chosen), sum(chosen)))
        if chosen[0]:
            gain = spread**2 * part.T @ np.linalg.inv(covariance)
            variance = spread**2 * (1.0 - gain[0] @ part[:, 0])
            found.append((evidence, float(gain[0] @ target), variance))
    weights = np.exp(np.array([one[0] for one in found]) - max(one[0] for one in found))
    means, variances = (np.array([one[k] for one in found]) for k in (1, 2))
    mean = weights @ means / weights.sum()
    return mean, np.sqrt(weights @ (variances + (means - mean) ** 2) / weights.sum())


def test_draws_of_the_chain_have_the_moments_of_all_choices_enumerated(monkeypatch):
    monkeypatch.setattr(averaged, "STEPS", 30_000)
    rng = np.random.default_rng(4)
    columns = rng.standard_normal((40, 4))
    columns[:, 1] = columns[:, 0] + 0.3 * columns[:, 1]  # much like the first
    target = 0.5 * columns[:, 0] + 0.2 * columns[:, 2] + rng.standard_normal(40)
    free = np.full(4, np.inf)
    places = [np.array([k]) for k in range(4)]
    chain = _Chain(columns.T @ columns, columns.T @ target, places, 0.7, -free, free)
    drawn = chain.drawn(np.array([True, False, False, False]), np.random.default_rng(1))[:, 0]
    drawn = drawn[~np.isnan(drawn)]
    mean, sd = enumerated(columns, target, 0.7)
    assert drawn.mean() == pytest.approx(mean, abs=0.1 * sd)  # draws are correlated
    assert drawn.std() == pytest.approx(sd, rel=0.1)


def test_a_choice_with_an_amplitude_that_cannot_be_is_never_drawn():
    rng = np.random.default_rng(4)
    columns = rng.standard_normal((40, 2))
    columns[:, 1] = columns[:, 0] + 0.1 * columns[:, 1]
    target = columns[:, 0] + 0.1 * rng.standard_normal(40)
    ends = np.array([np.inf, 0.01])
    places = [np.array([0]), np.array([1])]
    chain = _Chain(columns.T @ columns, columns.T @ target, places, 1.0, -ends, ends)
    drawn = chain.drawn(np.array([True, False]), np.random.default_rng(1))
    alone = np.isnan(drawn[:, 0])
    assert np.all(np.isnan(drawn[alone, 1]))


def widths(plant, hidden, proved):
    regression = halves(plant, hidden, 7).regression
    labels = [f"{trial.cause.label}:size" for trial in regression.trials]
    numbers = [labels.index(name) for name in proved]
    whitening = discrepancy(regression.half.runs, regression.half.target, memory=False)
    left = regression.solve(numbers, whitening).residual
    return averaged_half_widths(regression, numbers, whitening, left, 0.97)


def test_a_cause_that_another_one_could_share_is_known_less():
    """A twin of viscous friction, v + 0.02 sin 9 q, may take its place; a harmonic may not."""
    hidden = {"viscous@a:size": 0.6, "offset@b:size": 0.5}
    told = {
        kind: widths(Linear(("viscous", "offset", kind)), hidden, list(hidden))
        for kind in ("twin", "harmonic")
    }
    assert told["twin"]["viscous@a:size"] > 3.0 * told["harmonic"]["viscous@a:size"]
    ratio = told["twin"]["offset@b:size"] / told["harmonic"]["offset@b:size"]
    assert ratio == pytest.approx(1.0, abs=0.5)


def test_the_same_record_has_the_same_widths():
    hidden = {"viscous@a:size": 0.6}
    first, again = (widths(Linear(), hidden, list(hidden)) for _ in range(2))
    assert first == again
    assert set(first) == set(hidden)


def test_where_nothing_is_proved_there_is_nothing_to_tell():
    assert widths(Linear(), {"viscous@a:size": 0.6}, []) == {}
