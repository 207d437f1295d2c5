"""spread: intervals that what is left carries."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from toy import SD, Toy, programme

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.fit.spread import spread
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared

FED = programme(1)
FRICTION = next(h for h in Toy().hypotheses if h.effect == "friction")
SIZE = 0.05
DRAWS = 120


def missed(colour: float, loud: float) -> FloatArray:
    """Errors of the size in its own sd, before and after (draws, 2), under slow noise besides."""
    runs = Runs(Toy(), (FED,), (0, 1))
    base, whitening = linearise(runs, runs.origin), whitening_declared(runs)
    clean = Toy().simulate(FED, {"friction.size": SIZE})
    found = []
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        noise = SD * rng.standard_normal(clean.shape)
        slow = lfilter([1.0 - colour], [1.0, -colour], rng.standard_normal(clean.shape), axis=0)
        slow *= loud * np.array(SD) * np.sqrt((1.0 + colour) / (1.0 - colour))
        evidence = Evidence(runs, (clean + noise + slow).astype(np.float32), whitening)
        fit = refine(evidence, (FRICTION,), runs.origin, base)
        wide = spread(evidence, fit)
        off = fit.sizes[0] - SIZE
        found.append([off / np.sqrt(one.covariance[0, 0]) for one in (fit, wide)])
    return np.array(found)


def held(errors: FloatArray) -> float:
    """Share of 90 % intervals that hold the truth."""
    return float(np.mean(np.abs(errors) < 1.645))


def test_under_slow_noise_that_no_model_has_intervals_hold_nine_of_ten() -> None:
    plain, wide = missed(0.9, 0.5).T
    assert held(plain) < 0.75
    assert held(wide) > 0.84  # 90 % less two standard deviations of 120 draws


def test_under_the_noise_that_is_declared_they_stay_nearly_as_narrow() -> None:
    plain, wide = missed(0.0, 0.0).T
    assert 0.84 < held(wide) < 0.97
    assert np.median(np.abs(plain / wide)) < 1.25


def test_everything_but_the_covariance_of_sizes_stays() -> None:
    runs = Runs(Toy(), (FED,), (0, 1))
    clean = Toy().simulate(FED, {"friction.size": SIZE})
    evidence = Evidence(runs, clean.astype(np.float32), whitening_declared(runs))
    fit = refine(evidence, (FRICTION,), runs.origin, linearise(runs, runs.origin))
    wide = spread(evidence, fit)
    assert wide.posterior is fit.posterior
    assert replace(wide, covariance=fit.covariance) == fit
    assert wide.covariance[0, 0] >= fit.covariance[0, 0]
    assert wide.covariance == pytest.approx(fit.covariance, rel=0.6)
