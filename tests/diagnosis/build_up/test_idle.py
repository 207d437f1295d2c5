"""What is proved must still take something away where all of it is fitted in full."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear import Linear, recorded, seen

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.build_up import build_up as build_up_module
from ves_twin.diagnosis.build_up.halves import halves_at
from ves_twin.diagnosis.build_up.idle import idle, missed
from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.whitening import whitening_declared

HIDDEN = {"viscous@a:size": 1.0, "coulomb@b:size": 0.8}


def fitted(hidden):
    """Two causes that held-out data prove, their full fit, and both halves."""
    plant = Linear(kinds=("viscous", "coulomb"))
    one, two = (seen(plant, recorded(plant, hidden, seed)) for seed in (5, 6))
    runs = one.runs
    halves = halves_at(one, two, runs.origin, plant.hypotheses)
    labels = [trial.cause.label for trial in halves.regression.trials]
    chosen = [labels.index(name) for name in ("viscous@a", "coulomb@b")]
    proof = prove(halves.regression, halves.held, chosen)
    assert len(proof.proved) == 2
    causes = tuple(halves.regression.trials[n].cause for n in proof.proved)
    evidence = Evidence(runs, one.measured, whitening_declared(runs))
    fit = refine(evidence, causes, runs.origin, linearise(runs, runs.origin), 1)
    return proof, fit, runs, two


@pytest.fixture(scope="module")
def proved():
    return fitted(HIDDEN)


def moved(proof, fit, runs, size):
    """The same fit with the second cause at another size."""
    shift = fit.shift.copy()
    cause = proof.bench.regression.trials[proof.proved[1]].cause
    shift[runs.indices(cause)] = size
    return replace(fit, shift=shift)


def test_causes_that_take_something_away_stay(proved):
    proof, fit, runs, held = proved
    assert idle(proof, runs, held, fit) is None


@pytest.mark.parametrize("size", [0.0, -0.8, 3.0])
def test_a_cause_that_takes_nothing_away_at_its_size_is_told(proved, size):
    proof, fit, runs, held = proved
    assert idle(proof, runs, held, moved(proof, fit, runs, size)) == proof.proved[1]


def test_a_size_at_which_the_plant_fails_is_not_taken_for_idle(proved, monkeypatch):
    proof, fit, runs, held = proved
    first = runs.indices(proof.bench.regression.trials[proof.proved[0]].cause)

    class Failing:
        def __getattr__(self, name):
            return getattr(held.runs, name)

        def one(self, shift):
            rows = held.runs.one(shift)
            return rows if np.any(shift[first]) else np.full_like(rows, np.nan)

    assert idle(proof, runs, replace(held, runs=Failing()), fit) is None


def test_a_cause_that_is_there_and_earns_next_to_nothing_is_told(monkeypatch):
    """Surely there, at p of less than 1 %, and worth a few hundredths of the squares."""
    proof, fit, runs, held = fitted({"viscous@a:size": 1.0, "coulomb@b:size": 0.03})
    small = proof.proved[1]
    beside, without = (proof.bench.bare(n)[1] for n in (proof.proved, proof.proved[:1]))
    share = without / beside - 1.0
    assert 0.0 < share < 0.05
    assert proof.differences[small].p < 0.01
    place = "ves_twin.diagnosis.build_up.idle.EARNS"
    monkeypatch.setattr(place, 0.1 * share)
    assert idle(proof, runs, held, fit) is None
    monkeypatch.setattr(place, 1.1 * share)
    assert idle(proof, runs, held, fit) == small


def test_a_cause_whose_work_others_do_when_refitted_is_told(proved, monkeypatch):
    """As it was fitted it takes much away; without it the rest is fitted to do the same."""
    proof, fit, runs, held = proved
    whole = proof.bench.bare(proof.proved)
    monkeypatch.setattr("ves_twin.diagnosis.build_up.proof.Bench.bare", lambda *_: whole)
    assert idle(proof, runs, held, fit) in proof.proved


def test_a_cause_without_which_the_full_fit_predicts_worse_is_missed(proved):
    """Sizes of the columns are those of one-step errors: others did a friction's work there alone."""
    proof, fit, runs, held = proved
    without = moved(proof, fit, runs, 0.0)
    assert missed(proof, proof.proved[1], runs, held, (fit, without))
    assert not missed(proof, proof.proved[1], runs, held, (fit, fit))
    assert not missed(proof, proof.proved[1], runs, held, (without, fit))


def test_what_the_full_fit_needs_stays_though_it_seems_idle(proved, monkeypatch):
    proof, _, runs, held = proved
    plant = runs.forward
    one = seen(plant, recorded(plant, HIDDEN, 5))
    halves = halves_at(one, held, one.runs.origin, plant.hypotheses)
    evidence = Evidence(one.runs, one.measured, whitening_declared(one.runs))
    monkeypatch.setattr(build_up_module, "idle", lambda proof, *_: proof.proved[1])
    kept, _ = build_up_module._at_work(halves, proof, one.runs.origin, evidence, held)
    assert kept.proved == proof.proved
