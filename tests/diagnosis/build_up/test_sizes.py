"""Tests of what is told of sizes and of tuned numbers where model error counts."""

import numpy as np
from linear import Known, recorded, seen
from scipy.stats import norm

from ves_twin.diagnosis.build_up.converged import converged
from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.build_up.sizes import half_widths
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.whitening import whitening_declared

HIDDEN = {"mass": 1.04, "coulomb@a:size": 0.5}


def fitted(seed: int):
    """The mass (a tolerance) and one friction, in coloured error of 30 times the noise."""
    plant = Known(kinds=("viscous", "coulomb"))
    one = seen(plant, recorded(plant, HIDDEN, seed, error=0.03))
    cause = next(h for h in plant.hypotheses if h.label == "coulomb@a")
    bare = Evidence(one.runs, one.measured, whitening_declared(one.runs))
    first = converged(bare, (cause,), one.runs.origin, one.runs.origin)
    rest = np.asarray(one.measured - first.prediction, float)
    evidence = Evidence(one.runs, one.measured, discrepancy(one.runs, rest, 1.0, memory=False))
    return first, evidence, converged(evidence, (cause,), one.runs.origin, first.shift)


def test_intervals_of_tuned_numbers_hold_the_truth_where_those_of_noise_do_not():
    told, by_noise, quantile = 0, 0, norm.isf(0.05)
    for seed in range(12):
        first, evidence, fit = fitted(seed)
        names = [evidence.runs.coordinates[i].parameter.name for i in fit.active]
        at = names.index("mass")
        off = abs(fit.shift[fit.active[at]] - 0.04)
        told += off <= half_widths(evidence, fit, 0.9)[at]
        noise = quantile * np.sqrt(first.posterior[at, at])
        by_noise += abs(first.shift[first.active[at]] - 0.04) <= noise
    assert told >= 9  # of 12 at 90 %: fewer by chance at 0.4 %
    assert by_noise <= 7


def test_a_tolerance_is_told_no_wider_than_it_is_declared():
    _, evidence, fit = fitted(1)
    half, runs = half_widths(evidence, fit, 0.9), evidence.runs
    assert len(half) == len(fit.active)
    quantile = half_widths(evidence, fit, 0.9) / np.maximum(runs.sd[fit.active], 1e-30)
    assert np.all(quantile[len(fit.sizes) :] <= 1.895)  # Student, 7 degrees of freedom
