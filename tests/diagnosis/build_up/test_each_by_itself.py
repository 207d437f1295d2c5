"""Two couplings of two joints without any coupling in them are told as a friction of each."""

from __future__ import annotations

import pytest
from linear import Linear, recorded, seen

from ves_twin.diagnosis.build_up.each_by_itself import each_by_itself
from ves_twin.diagnosis.build_up.halves import halves_at
from ves_twin.diagnosis.build_up.proof import prove

SUM, DIFFERENCE = "coupling@sum", "coupling@difference"
EACH = {"viscous_friction@a", "viscous_friction@b"}


@pytest.mark.parametrize(
    ("hidden", "told"),
    [
        ({f"{label}:size": 1.0 for label in EACH}, EACH),
        ({f"{SUM}:size": 0.6, f"{DIFFERENCE}:size": 0.3}, {SUM, DIFFERENCE}),
    ],
)
def test_sum_and_difference_are_told_as_what_each_joint_has_where_nothing_is_coupled(hidden, told):
    plant = Linear(("viscous_friction", "offset"), couplings=("sum", "difference"))
    one, two = (seen(plant, recorded(plant, hidden, seed)) for seed in (5, 6))
    halves = halves_at(one, two, one.runs.origin, plant.hypotheses)
    trials = halves.regression.trials
    first = {t.cause.label: n for n, t in reversed(list(enumerate(trials)))}
    proof = prove(halves.regression, halves.held, [first[SUM], first[DIFFERENCE]])
    assert len(proof.proved) == 2
    after = each_by_itself(proof)
    assert {trials[n].cause.label for n in after.proved} == told
    assert after.tested <= proof.tested + 2
