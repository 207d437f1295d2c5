"""A proved name rests on others where without them it would hardly be there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear import Linear, halves

from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.build_up.report import report_of
from ves_twin.diagnosis.build_up.rests_on import rests_on
from ves_twin.diagnosis.build_up.result import Proved, Size
from ves_twin.report.diagnosis.proved import standing_words


@pytest.fixture(scope="module")
def proved():
    """Two that nearly cancel, as a motor's gain and the wheel that it drives, and a friction."""
    hidden = {"viscous@a:size": 0.8, "twin@a:size": -0.8, "coulomb@a:size": 0.3}
    both = halves(Linear(kinds=("viscous", "twin", "coulomb")), hidden, 51, error=0.002)
    labels = [trial.cause.label for trial in both.regression.trials]
    chosen = [labels.index(f"{kind}@a") for kind in ("viscous", "twin", "coulomb")]
    proof = prove(both.regression, both.held, chosen)
    assert sorted(proof.proved) == sorted(chosen)
    return both, proof, {name: labels.index(name) for name in labels}


def test_what_only_cancels_another_rests_on_it_and_what_acts_by_itself_on_none(proved):
    _, proof, trial = proved
    assert rests_on(proof, trial["twin@a"]) == ("viscous@a",)
    assert rests_on(proof, trial["viscous@a"]) == ("twin@a",)
    assert rests_on(proof, trial["coulomb@a"]) == ()


SIZE = {"size": Size(1.0, 0.8, 1.2, "1", 0.0)}


@pytest.mark.parametrize("ended", [False, True])
def test_a_name_is_not_firm_that_rests_on_one_whose_range_ends(ended):
    """Of a reaction wheel a motor of 1.46 times the torque, at its end, asked for 34 % more wheel."""
    takes = {"wheel": (2.0, 1.0)}
    gain = Proved("actuator_gain", "motor", SIZE, 1e-8, 20, takes, False, ended=ended)
    wheel = Proved(
        "body_inertia", "wheel", SIZE, 1e-6, 20, takes, True, rests_on=("actuator_gain@motor",)
    )
    told = wheel.beside([gain, wheel])
    assert told.firm is not ended
    assert ("rests on actuator gain at motor, whose range ends" in standing_words(told)) is ended


@pytest.mark.parametrize(("grows", "firm"), [(1.1, True), (1.5, False)])
def test_a_name_is_not_firm_that_spoils_a_channel_where_it_acts(grows, firm):
    """What a coupling of two joints takes from one torque it may not add to the other."""
    plant = Linear(kinds=("viscous",), couplings=("sum",))
    both = halves(plant, {"coupling@sum:size": 0.8}, 51, error=0.02)
    labels = [trial.cause.label for trial in both.regression.trials]
    proof = prove(both.regression, both.held, [labels.index("coupling@sum")])
    left = proof.bench.residual(proof.proved)
    change = proof.bench.residual([])[:, 1] - left[:, 1]  # what the other torque is off without it
    left[:, 1] = change * grows / (1.0 - grows)
    still = replace(both, measured=np.zeros_like(both.measured))  # nothing to follow
    (one,) = report_of(still, proof, (left, left)).proved
    assert one.spoils == (() if firm else ("torque.b",))
    assert one.firm is firm
