"""What fits only at an end of its range leaves its place to a cause that has room."""

from __future__ import annotations

import pytest
from linear import Narrow, recorded, seen

from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.build_up.halves import halves_at
from ves_twin.diagnosis.build_up.in_full import in_full
from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.build_up.within_range import within_range
from ves_twin.diagnosis.record.evidence import Evidence


def told(size: float, kinds=("viscous", "twin")):
    """Names before and after, where viscous friction up to 0.1 was proved; its twin has room."""
    plant = Narrow(kinds=kinds)
    hidden = {f"{kinds[-1]}@a:size": size}
    one, two = (seen(plant, recorded(plant, hidden, seed, error=0.01)) for seed in (6, 7))
    halves = halves_at(one, two, one.runs.origin, plant.hypotheses)
    regression, point = halves.regression, one.runs.origin
    labels = [trial.cause.label for trial in regression.trials]
    proof = prove(regression, halves.held, [labels.index("viscous@a")])
    assert len(proof.proved) == 1
    left = regression.fit(proof.proved).residual
    evidence = Evidence(one.runs, one.measured, discrepancy(one.runs, left, memory=False))
    before = in_full(regression, proof.proved, point, evidence, probed=True)
    after, fit = within_range(proof, before, point, evidence)
    return [labels[n] for n in after.proved], fit, before, after.tested - proof.tested


def test_a_cause_at_the_end_of_its_range_leaves_its_place_to_one_with_room():
    names, fit, before, tried = told(0.14)
    assert names == ["twin@a"]
    assert fit.chi2 < before.chi2
    assert fit.sizes == pytest.approx([0.14], rel=0.1)
    assert tried == 1


def test_a_cause_within_its_range_stays_whatever_could_stand_for_it():
    names, fit, before, tried = told(0.07)
    assert names == ["viscous@a"]
    assert fit is before
    assert tried == 0


def test_a_cause_at_the_end_that_nothing_can_stand_for_stays():
    names, fit, before, _ = told(0.14, kinds=("spring", "viscous"))
    assert names == ["viscous@a"]
    assert fit is before
