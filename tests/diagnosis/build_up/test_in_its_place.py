"""Others that do as well in a proved cause's place are found by full fits, where columns bend."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from linear import JOINTS, MASS, Linear, recorded, seen

from ves_twin.diagnosis.bank.screen import Screen
from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.build_up.builder import present_in
from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.build_up.halves import halves_at
from ves_twin.diagnosis.build_up.in_full import in_full
from ves_twin.diagnosis.build_up.in_its_place import Replaced
from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.build_up.report import report_of
from ves_twin.diagnosis.build_up.stand_ins import StandIns
from ves_twin.diagnosis.model.forward import Hypothesis, Parameter
from ves_twin.diagnosis.record.evidence import Evidence

LARGEST = 0.6


@dataclass(frozen=True)
class Stalled(Linear):
    """What is left of a command once a dead band and dry friction have had their part of it."""

    kinds: tuple[str, ...] = ("band", "dry", "drag")

    @property
    def parameters(self):
        ends = {"band": (0.0, 1.0), "dry": (0.0, 1.0), "drag": (-5.0, 5.0)}
        sizes = [Parameter(f"{k}@{j}:size", "1", 0.0, *ends[k]) for k in self.kinds for j in JOINTS]
        return (MASS, *sizes)

    @property
    def hypotheses(self):
        signs = {"band": (1,), "dry": (1,), "drag": (1, -1)}
        return tuple(
            Hypothesis(k, j, (f"{k}@{j}:size",), (0.01,), (LARGEST,), signs=signs[k])
            for k in self.kinds
            for j in JOINTS
        )

    def simulate(self, programme, values, refined=False):
        rest = Linear(("drag",)).simulate(programme, values)
        taken = [
            values.get(f"band@{j}:size", 0.0) + values.get(f"dry@{j}:size", 0.0) for j in JOINTS
        ]
        command = programme.drive["q"]
        return rest + np.sign(command) * np.maximum(np.abs(command) - np.array(taken), 0.0)


def built(kinds=("band", "dry", "drag")):
    """Proof and full fit of a dead band, about itself, and what may stand in its place."""
    plant = Stalled(kinds=kinds)
    hidden = {"band@a:size": 0.35}
    one, two = (seen(plant, recorded(plant, hidden, seed, error=0.02)) for seed in (6, 7))
    first = halves_at(one, two, one.runs.origin, plant.hypotheses)

    def fitted(halves, point):
        found = [n for n, t in enumerate(halves.regression.trials) if t.cause.label == "band@a"]
        proof = prove(halves.regression, halves.held, found[:1])
        left = halves.regression.fit(proof.proved).residual
        evidence = Evidence(one.runs, one.measured, discrepancy(one.runs, left, memory=False))
        return proof, evidence, in_full(halves.regression, proof.proved, point, evidence)

    proof, _, fit = fitted(first, one.runs.origin)
    present = present_in([first.regression.trials[n] for n in proof.proved], fit)
    halves = halves_at(one, two, fit.shift, plant.hypotheses, present)
    proof, evidence, fit = fitted(halves, fit.shift)
    return halves, proof, Replaced(proof, fit, build_bank(one.runs), evidence, two)


def test_dry_friction_does_the_work_of_a_dead_band_though_no_column_beside_it_tells():
    halves, proof, replaced = built()
    (band,) = proof.proved
    assert replaced.fit.sizes == pytest.approx([0.35], rel=0.1)  # the error has a memory
    trials = halves.regression.trials
    assert "dry@a" not in {trials[k].cause.label for k in StandIns.of(proof).within[band]}
    others = replaced.others(proof.proved)
    assert [trials[k].cause.label for k in others[band]] == ["dry@a"]
    left = replaced.held.measured - replaced.held.runs.one(replaced.fit.shift)
    ends = np.zeros(left.shape), np.asarray(left, float)
    (beside,) = report_of(halves, proof, ends, replaced=replaced).proved
    assert (beside.firm, beside.acts_like) == (False, ("dry@a",))


def test_a_signature_is_like_itself_by_a_cosine_of_one_beside_tolerances():
    _, proof, replaced = built()
    likely = dict(
        replaced._alike(Screen(replaced.bank, replaced.evidence.whitening), *proof.proved, set())
    )
    assert {*likely} <= {"band@a", "dry@a"}
    change = replaced.bank.signature(int(replaced.bank.entries(0)[-1]))
    white = replaced.evidence.whitening.apply(change)
    screen = Screen(replaced.bank, replaced.evidence.whitening)
    size = float(white @ screen.metric.project(white)) ** 0.5
    own = int(replaced.bank.entries(0)[-1])
    assert screen.match(white)[own] / screen.power[own] ** 0.5 / size == pytest.approx(1.0)


def test_nothing_is_in_the_place_of_what_no_other_cause_is_like():
    halves, proof, replaced = built(("band", "drag"))
    assert replaced.others(proof.proved) == {proof.proved[0]: []}
    assert halves.regression.trials[proof.proved[0]].bent
