"""The fit against the closed form of a linear-Gaussian plant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import NUISANCES, SD, Toy, programme, shape

from ves_twin.core.budget import Budget
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.explain.probability import probabilities
from ves_twin.diagnosis.fit.probe import probe
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import ORDER, whitening_declared

SINGLE = 2e-4
"""Relative: predictions are kept in single precision (6e-8) against signals 100 times the noise."""


@pytest.fixture(scope="module")
def case():
    """A record with friction 0.004 and 0.7 sd of each nuisance, and its exact covariance."""
    fed, toy = programme(), Toy()
    runs = Runs(toy, (fed,), (0, 1))
    u, time = fed.drive["drive.u"][:, 0], fed.time
    columns = [
        0.02 * u[:, None] * [0.3, 1.0],
        0.05 * np.gradient(u, time)[:, None] * [0.05, 0.2],
        0.05 * np.ones((len(u), 2)) * [1.0, 0.3],
    ]
    rng = np.random.default_rng(5)
    clean = toy.simulate(fed, {"friction.size": 0.004})
    rows = clean + 0.7 * sum(columns) + rng.standard_normal(clean.shape) * SD
    keep = slice(ORDER + 1, None)  # the whitening needs that many rows to start
    white = np.array([(c / SD)[keep].ravel() for c in columns]).T
    residual = ((rows - toy.simulate(fed, {})) / SD)[keep].ravel()
    covariance = np.eye(len(residual)) + white @ white.T
    local = linearise(runs, runs.origin)
    evidence = Evidence(runs, rows.astype(np.float32), whitening_declared(runs))
    return fed, runs, evidence, local, white, residual, covariance


def signature(name: str, fed) -> np.ndarray:
    u, time = fed.drive["drive.u"][:, 0], fed.time
    if name == "gain":
        return (u[:, None] * [0.3, 1.0] / SD)[ORDER + 1 :].ravel()
    return (shape(name, u, time) / SD)[ORDER + 1 :].ravel()


def closed_form(s, residual, covariance):
    weighted = np.linalg.solve(covariance, s)
    sd = 1 / np.sqrt(s @ weighted)
    size = sd**2 * (weighted @ residual)
    return size, sd, residual @ np.linalg.solve(covariance, residual) - (size / sd) ** 2


@pytest.mark.parametrize(
    ("probed", "left", "expected"), [(False, True, 0), (True, True, 1), (True, False, 0)]
)
def test_a_fit_is_probed_where_that_is_asked_for_and_there_is_time(
    case, monkeypatch, probed, left, expected
):
    _, runs, evidence, local, *_ = case
    probes = []

    def counted(*given):
        probes.append(given)
        return probe(*given)

    monkeypatch.setattr("ves_twin.diagnosis.fit.refine.probe", counted)
    if not left:
        spent = iter([0.0])
        budget = Budget(1.0, lambda: next(spent, 3600.0))
        evidence = replace(evidence, runs=replace(runs, workers=Workers(1, budget)))
    refine(evidence, (), runs.origin, local, probed=probed)
    assert len(probes) == expected


@pytest.mark.parametrize("number", range(6))
def test_size_interval_and_chi2_are_those_of_generalised_least_squares(case, number):
    fed, runs, evidence, local, _, residual, covariance = case
    cause = Toy().hypotheses[number]
    fit = refine(evidence, (cause,), runs.origin, local)
    size, sd, chi2 = closed_form(signature(cause.effect, fed), residual, covariance)
    assert fit.sizes[0] == pytest.approx(size, abs=2e-3 * sd)
    assert np.sqrt(fit.covariance[0, 0]) == pytest.approx(sd, rel=SINGLE)
    assert fit.chi2 == pytest.approx(chi2, abs=0.02 + SINGLE * chi2)


def test_where_no_time_is_left_one_step_is_taken_and_of_linear_causes_that_is_all(case):
    """Of an arm's log that was given 6 of its 8 minutes no tolerance was fitted at all."""
    fed, runs, evidence, local, _, residual, covariance = case
    spent = iter([0.0])
    budget = Budget(1.0, lambda: next(spent, 3600.0))
    evidence = replace(evidence, runs=replace(runs, workers=Workers(1, budget)))
    fit = refine(evidence, (Toy().hypotheses[0],), runs.origin, local)
    size, sd, _ = closed_form(signature(Toy().hypotheses[0].effect, fed), residual, covariance)
    assert budget.over
    assert fit.sizes[0] == pytest.approx(size, abs=0.05 * sd)
    assert np.any(fit.shift[runs.nuisances] != 0.0)


def test_nuisances_are_their_posterior_mean(case):
    _, runs, evidence, local, white, residual, covariance = case
    fit = refine(evidence, (), runs.origin, local)
    mean = white.T @ np.linalg.solve(covariance, residual)
    found = fit.shift[runs.nuisances] / runs.sd[runs.nuisances]
    assert found == pytest.approx(mean, abs=1e-3)


def test_metric_is_the_inverse_covariance(case):
    white, residual, covariance = case[4:]
    direct = np.linalg.solve(covariance, residual)
    assert Metric(white).project(residual) == pytest.approx(direct, abs=1e-8)


def test_probabilities_are_the_integrals_over_size(case):
    """Against a fine quadrature of the dense closed form over the log-uniform prior."""
    fed, runs, evidence, local, _, residual, covariance = case
    causes = [c for c in Toy().hypotheses if c.effect in ("friction", "ripple", "lag")]
    fits = [refine(evidence, (c,), runs.origin, local) for c in causes]
    chosen, weights = probabilities(fits, 0.0, 1e30)
    integrals = []
    sizes = np.geomspace(0.001, 1.0, 200_001)
    for c in causes:
        size, sd, chi2 = closed_form(signature(c.effect, fed), residual, covariance)
        both = [
            np.trapezoid(np.exp(-0.5 * ((sign * sizes - size) / sd) ** 2) / sizes, sizes)
            for sign in (-1, 1)
        ]
        integrals.append(np.log(sum(both)) - 0.5 * chi2)
    exact = dict(zip([c.effect for c in causes], integrals, strict=True))
    first = chosen[0].causes[0].effect
    assert first == "friction"
    for fit, weight in zip(chosen[1:], weights[1:], strict=True):
        odds = exact[fit.causes[0].effect] - exact[first]
        assert np.log(weight / weights[0]) == pytest.approx(
            odds, abs=0.05
        )  # CONVERGED: 0.02 in chi^2


def test_equal_rivals_share_the_probability():
    twins = Toy(causes=("lag", "late"))
    fed = programme()
    runs = Runs(twins, (fed,), (0, 1))
    rng = np.random.default_rng(1)
    rows = twins.simulate(fed, {"lag.size": 0.3})
    rows = rows + rng.standard_normal(rows.shape) * SD
    evidence = Evidence(runs, rows.astype(np.float32), whitening_declared(runs))
    local = linearise(runs, runs.origin)
    fits = [refine(evidence, (h,), runs.origin, local) for h in twins.hypotheses[1:]]
    assert probabilities(fits, 0.0, 100.0)[1] == pytest.approx([0.5, 0.5], abs=0.01)


class Turning(Toy):
    """Its slope turns the response from one channel to the other, by 0.25 rad for one sd."""

    def simulate(self, programme, values, refined=False):
        turn = 5.0 * values.get("plant.slope", 0.0)
        u = programme.drive["drive.u"]
        rows = super().simulate(programme, {**values, "plant.slope": 0.0})
        return rows + 3.0 * u * [np.sin(turn), np.cos(turn)]


@pytest.fixture(scope="module")
def turned():
    """A record of a plant that stands three sd from nominal, where the columns are 43 deg off."""
    known = replace(NUISANCES[0], sd=0.0)  # a gain would take the blame for a part of the turn
    fed, plant = programme(), Turning(nuisances=(known, *NUISANCES[1:]))
    runs = Runs(plant, (fed,), (0, 1))
    true = {"plant.slope": 0.15, "plant.offset": 0.06}
    noise = np.random.default_rng(3).standard_normal((len(fed.time), 2)) * SD
    rows = (plant.simulate(fed, true) + noise).astype(np.float32)
    evidence = Evidence(runs, rows, whitening_declared(runs))
    return runs, evidence, linearise(runs, runs.origin), true


def test_a_search_follows_a_plant_that_turns_without_new_columns(turned):
    runs, evidence, local, true = turned
    fit = refine(evidence, (), runs.origin, local)
    names = [axis.parameter.name for axis in runs.coordinates]
    at_truth = runs.origin
    for name, value in true.items():
        axis = names.index(name)
        at_truth[axis] = value - runs.coordinates[axis].parameter.nominal
    there = evidence.whitening.apply(evidence.measured - runs.one(at_truth))
    # the truth's chi^2 with its priors, which the best point can only undercut; one unit of chi^2
    # is a third of what parts two names
    prior = np.sum((at_truth[runs.nuisances] / runs.sd[runs.nuisances]) ** 2)
    assert fit.chi2 < there @ there + prior + 1.0


def test_the_columns_that_a_fit_hands_on_hold_along_the_way_it_came(turned):
    runs, evidence, local, _ = turned
    fit = refine(evidence, (), runs.origin, local)
    step = 1e-3
    slope = (runs.one(fit.shift * (1.0 + step)) - runs.one(fit.shift)) / step
    spreads = (fit.shift[runs.nuisances] / runs.sd[runs.nuisances]).astype(np.float32)

    def off(columns):
        return np.linalg.norm(np.tensordot(spreads, columns[:-1], axes=1) - slope)

    # a secant over 43 deg is 0.55 as far off as the tangent at its begin; LEAST_MOVE keeps a tenth
    assert off(fit.local.columns) < 0.65 * off(local.columns)


def test_a_fit_begins_at_the_step_share_it_is_given(case):
    _, runs, evidence, local, *_ = case
    found = refine(evidence, (), runs.origin, local, step_share=0.3)
    # the toy has no step: its column is zero and the prior alone pulls the share back
    assert found.step_share == pytest.approx(0.0, abs=1e-6)


def test_a_fit_tells_which_nuisances_an_end_of_what_is_allowed_holds(case):
    """The first one is eight sd off and may go three; what needs little is held by nothing."""
    fed, runs, evidence, local, *_ = case
    names = [runs.coordinates[i].parameter.name for i in runs.nuisances]
    clean = Toy().simulate(fed, {})
    off = np.zeros_like(clean)
    off += 8.0 * 0.02 * fed.drive["drive.u"][:, :1] * [0.3, 1.0]
    far = replace(evidence, measured=(clean + off).astype(np.float32))
    held = refine(far, (), runs.origin, local, farthest=3.0)
    assert [names[list(runs.nuisances).index(i)] for i in held.held] == [NUISANCES[0].name]
    assert len(refine(far, (), runs.origin, local).held) == 0
    assert len(refine(evidence, (), runs.origin, local, farthest=3.0).held) == 0
