"""profiled: intervals that the profile of chi^2 carries."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import SD, Toy, programme

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.fit.profile import profiled
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared

FED = programme(1)
FRICTION, RIPPLE = (
    next(h for h in Toy().hypotheses if h.effect == effect) for effect in ("friction", "ripple")
)


@pytest.fixture(scope="module")
def evidence():
    runs = Runs(Toy(), (FED,), (0, 1))
    clean = Toy().simulate(FED, {"friction.size": 0.05, "plant.slope": 0.06})
    noise = np.random.default_rng(2).standard_normal(clean.shape) * SD
    return Evidence(runs, (clean + noise).astype(np.float32), whitening_declared(runs))


def fitted(evidence, causes):
    runs = evidence.runs
    return refine(evidence, causes, runs.origin, linearise(runs, runs.origin))


@pytest.mark.parametrize("causes", [(FRICTION,), (FRICTION, RIPPLE)])
def test_what_a_jacobian_knows_right_stays(evidence, causes):
    """Of a linear plant, whose profile is the parabola of its Jacobian."""
    fit = fitted(evidence, causes)
    sds = np.sqrt(np.diag(profiled(evidence, fit).covariance) / np.diag(fit.covariance))
    assert sds == pytest.approx(1.0, abs=0.1)


def test_an_interval_that_is_six_times_too_narrow_becomes_that_of_the_profile(evidence):
    fit = fitted(evidence, (FRICTION,))
    narrow = replace(fit, covariance=fit.covariance / 36.0)
    found = profiled(evidence, narrow)
    assert np.sqrt(found.covariance / fit.covariance) == pytest.approx(1.0, abs=0.1)
    assert found.posterior is fit.posterior
