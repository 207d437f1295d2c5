"""on_line: sizes at the least chi^2 of their lines, as sure as single runs allow."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from toy import SD, Toy, programme

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.fit.on_line import on_line
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared

FED = programme(1)
FRICTION = next(h for h in Toy().hypotheses if h.effect == "friction")
TRUE = 0.05


def measured(plant, size=TRUE):
    """A record of the plant, its noise as declared."""
    runs = Runs(plant, (FED,), (0, 1))
    clean = Toy().simulate(FED, {"friction.size": size, "plant.slope": 0.06})
    noise = np.random.default_rng(2).standard_normal(clean.shape) * SD
    return Evidence(runs, (clean + noise).astype(np.float32), whitening_declared(runs))


def fitted(evidence):
    runs = evidence.runs
    return refine(evidence, (FRICTION,), runs.origin, linearise(runs, runs.origin))


def off(evidence, fit, sds):
    """The fit as a search leaves it that ended so many sd from its best, all else as good."""
    along = fit.posterior[:, 0] / np.sqrt(fit.posterior[0, 0])
    shift = fit.shift.copy()
    shift[fit.active] += sds * along
    at = (shift, fit.local, 0, fit.step_share)
    return refine(evidence, (FRICTION,), *at, steps=0, known=fit.columns)


@dataclass(frozen=True)
class Hunting(Toy):
    """Answers off by chance, another way for every set of values."""

    chance: float = 0.0

    def simulate(self, programme, values, refined=False):
        rows = super().simulate(programme, values, refined)
        told = np.frombuffer(np.array(sorted(values.values())).tobytes(), np.uint32)
        rng = np.random.default_rng(told)
        return rows + self.chance * rng.standard_normal(rows.shape) * SD


def test_what_is_at_its_best_stays():
    evidence = measured(Toy())
    fit = fitted(evidence)
    found = on_line(evidence, fit)
    sd = np.sqrt(fit.covariance[0, 0])
    assert found.sizes[0] == pytest.approx(fit.sizes[0], abs=0.05 * sd)
    assert found.covariance[0, 0] == pytest.approx(fit.covariance[0, 0], rel=0.05)


@pytest.mark.parametrize("sds", [-2.0, 1.0, 2.5])
def test_a_size_that_a_search_left_beside_its_best_is_brought_there(sds):
    evidence = measured(Toy())
    best = fitted(evidence)
    left = off(evidence, best, sds)
    sd = np.sqrt(best.covariance[0, 0])
    assert abs(left.sizes[0] - best.sizes[0]) > 0.9 * abs(sds) * sd
    found = on_line(evidence, left)
    assert found.sizes[0] == pytest.approx(best.sizes[0], abs=0.05 * sd)
    assert found.chi2 == pytest.approx(best.chi2, abs=0.05)
    assert found.residual @ found.residual < left.residual @ left.residual


def test_an_interval_that_is_too_narrow_becomes_that_of_chi2():
    evidence = measured(Toy())
    fit = fitted(evidence)
    narrow = replace(fit, covariance=fit.covariance / 9.0, posterior=fit.posterior / 9.0)
    found = on_line(evidence, narrow)
    assert found.covariance[0, 0] == pytest.approx(fit.covariance[0, 0], rel=0.1)


def test_where_single_runs_are_off_by_chance_a_size_is_less_sure():
    """Each answer is off by a tenth of the noise, and chi^2 by some 10."""
    fit = fitted(measured(Toy()))
    found = on_line(measured(Hunting(chance=0.1)), fit)
    assert 1.02 < np.sqrt(found.covariance[0, 0] / fit.covariance[0, 0]) < 2.0


def test_at_a_bound_a_fit_stays_as_it_is():
    evidence = measured(Toy(), size=0.001)
    fit = fitted(evidence)
    evidence.runs.low[fit.active[0]] = fit.shift[fit.active[0]]
    assert on_line(evidence, fit) is fit
