"""Runs that are not made, since what they would tell is known: counts, and that answers stay."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from toy import QUICK, SD, Toy, programme

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.explain.explain import _clear, explain
from ves_twin.diagnosis.explain.judge import _commissioning
from ves_twin.diagnosis.fit.assess import assess, pull_limit
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.fits import start_of, tried
from ves_twin.diagnosis.fit.null import Thresholds
from ves_twin.diagnosis.fit.refine import Fit, refine
from ves_twin.diagnosis.fit.search import ATTEMPTS, FARTHEST, SECANT, Search
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs, silent
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.unseen.held_out_gain import _Carried, held_out_gain

FED = programme(1)
LEVELS = Thresholds(15.0, 5.0, np.zeros(0), np.zeros(0))
DEAR = replace(QUICK, sparse=True)
ONE = {"friction.size": 0.2, "plant.slope": 0.03}


@dataclass(frozen=True)
class Counting(Toy):
    """A toy that counts its runs."""

    counted: tuple[list[int], ...] = ([],)

    def simulate(self, programme, values, refined=False):
        self.counted[0].append(1)
        return super().simulate(programme, values, refined)


def count(runs: Runs) -> int:
    return len(runs.forward.counted[0])


def noisy(values, fed=FED, seed=3):
    clean = Toy().simulate(fed, values)
    noise = np.random.default_rng(seed).standard_normal(clean.shape) * SD
    return (clean + noise).astype(np.float32)


@pytest.fixture
def runs():
    return Runs(Counting(counted=([],)), (FED,), (0, 1))


@pytest.fixture
def first(runs):
    """A record of one cause, looked at, and a bank that was paid for before."""
    bank = build_bank(runs)
    return assess(noisy(ONE), bank, whitening_declared(runs), 15.0, 5.0, 4.0, sparse=True)


def spent(first, settings: Settings) -> tuple[Fit, int]:
    before = count(first.evidence.runs)
    found = explain(first, LEVELS, settings)
    assert found.adequate
    return found.best, count(first.evidence.runs) - before


def test_a_clear_cause_takes_a_third_of_the_runs_and_is_told_the_same(first, monkeypatch):
    usual, many = spent(first, QUICK)
    monkeypatch.setattr(
        "ves_twin.diagnosis.explain.explain.settled", lambda *_: pytest.fail("columns")
    )
    dear, few = spent(first, DEAR)
    assert dear.causes == usual.causes
    assert dear.sizes == pytest.approx(usual.sizes, rel=1e-3)
    assert np.sqrt(dear.covariance) == pytest.approx(np.sqrt(usual.covariance), rel=0.01)
    assert few <= many / 3


@pytest.fixture
def asked(monkeypatch):
    """How many fits each time columns were asked for at them; none are computed."""
    counts = []

    def noted(evidence, fits, desk):
        counts.append(len(fits))
        return fits

    monkeypatch.setattr("ves_twin.diagnosis.explain.explain.settled", noted)
    return counts


def test_columns_are_computed_at_a_fit_that_is_not_clear(first, asked, monkeypatch):
    monkeypatch.setattr("ves_twin.diagnosis.explain.explain._clear", lambda *_: False)
    explain(first, LEVELS, DEAR)
    assert asked == [1]  # one near suspect, which was fitted with the commissioning errors


def test_what_is_clear_and_yet_leaves_more_than_noise_gets_columns_at_its_fit(
    first, asked, monkeypatch
):
    monkeypatch.setattr("ves_twin.diagnosis.explain.explain._clear", lambda *_: True)
    explain(first, replace(LEVELS, misfit=-10.0), DEAR, together=False)
    assert asked[0] == 1


def test_clear_is_one_fit_that_leaves_noise_without_a_strained_error(first):
    desk = FitContext(first, LEVELS, DEAR, silent)
    (fit,) = tried(desk, first.suspects[:1])
    assert _clear(desk, [fit])
    rival = replace(fit, chi2=3.9 * fit.chi2)
    assert not _clear(desk, [fit, rival])
    assert _clear(desk, [fit, replace(fit, chi2=4.1 * fit.chi2)])
    assert not _clear(replace(desk, thresholds=replace(LEVELS, misfit=0.1)), [fit])
    axis = fit.active[-1]
    limit = pull_limit(first.screen.bank, DEAR.alpha)
    for strain, clear in ((0.99, True), (1.01, False)):
        shift = fit.shift.copy()
        shift[axis] = strain * limit * fit.local.runs.sd[axis]
        assert _clear(desk, [replace(fit, shift=shift)]) == clear


def test_a_cause_that_was_fitted_with_the_commissioning_errors_is_gone_on_with(first, monkeypatch):
    monkeypatch.setattr("ves_twin.diagnosis.fit.fits.job", lambda *_: pytest.fail("begun anew"))
    runs, before = first.evidence.runs, count(first.evidence.runs)
    (fit,) = tried(FitContext(first, LEVELS, DEAR, silent), first.suspects[:1])
    assert fit.causes == first.beside.causes
    assert count(runs) - before <= 3  # the point, and a step or two that find nothing


@pytest.mark.parametrize(("share", "anew"), [(0.0, 0), (0.99, 0), (1.01, 2)])
def test_columns_of_a_cause_serve_while_its_size_is_within_their_span(runs, share, anew):
    (cause,) = (h for h in runs.forward.hypotheses if h.effect == "friction")
    evidence = Evidence(runs, noisy(ONE), whitening_declared(runs))
    local, where = linearise(runs, runs.origin), runs.indices(cause)
    start = runs.depart(runs.origin, where, np.array([0.2]))
    search = Search(evidence, where, local)
    jacobian = search.jacobian(search.at(start, 0.0))
    again = Search(evidence, where, local)
    moved = runs.depart(start, where, np.array([0.2 * (1.0 + share * SECANT)]))
    point, before = again.at(moved, 0.0), count(runs)
    assert again.begun(point, search.of_causes) / again.unit == pytest.approx(
        jacobian / search.unit, abs=1e-3
    )
    assert count(runs) - before == anew


def test_a_fit_that_ended_is_probed_without_another_search(runs):
    (cause,) = (h for h in runs.forward.hypotheses if h.effect == "friction")
    evidence = Evidence(runs, noisy(ONE), whitening_declared(runs))
    fit = refine(evidence, (cause,), runs.origin, linearise(runs, runs.origin))
    at, before = (fit.shift, fit.local), count(runs)
    probed = refine(evidence, (cause,), *at, probed=True, steps=0, known=fit.columns)
    # the point, either side along one direction, and steps by what that showed
    assert count(runs) - before <= 1 + 2 + ATTEMPTS
    assert probed.sizes == pytest.approx(fit.sizes, rel=1e-3)


@pytest.mark.parametrize(("clear", "held"), [(0.0, True), (1e9, False)])
def test_what_commissioning_errors_do_without_a_clear_cause_is_what_a_rig_in_order_may(
    first, clear, held
):
    """A gain of 1.3 is 15 of its sd, which a rig in order has not."""
    runs = first.evidence.runs
    evidence = Evidence(runs, noisy(ONE | {"plant.gain": 1.3}), whitening_declared(runs))
    (cause,) = (h for h in runs.forward.hypotheses if h.effect == "friction")
    begin = start_of(first)
    leader = refine(evidence, (cause,), begin.shift, begin.local)
    desk = FitContext(first, replace(LEVELS, effect=clear), DEAR, silent)
    found, rough = _commissioning(desk, evidence, leader, False)
    limit = pull_limit(first.screen.bank, DEAR.alpha)
    assert rough == held
    assert (found.pull <= limit * (1.0 + 1e-9)) == held
    assert found.pull < FARTHEST


def test_the_model_before_takes_one_run_of_the_held_out_recordings(runs):
    """And one without the causes; all else is the extended model's own."""
    (cause,) = (h for h in runs.forward.hypotheses if h.effect == "friction")
    evidence = Evidence(runs, noisy(ONE), whitening_declared(runs))
    local = linearise(runs, runs.origin)
    fits = [refine(evidence, causes, runs.origin, local) for causes in ((), (cause,))]
    there = Runs(Counting(counted=([],)), (programme(2),), (0, 1))
    base, before = linearise(there, there.origin), count(there)
    _Carried.of(there, fits[1], base)
    alone, before = count(there) - before, count(there)
    gain = held_out_gain(
        there, noisy(ONE, programme(2), 4), whitening_declared(there), *fits, base=base
    )
    assert count(there) - before == alone + 2
    assert gain.share == pytest.approx(1.0, abs=0.02)
