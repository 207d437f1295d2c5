"""A proved name is firm only where its sizes are known apart from what the model has already."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear import Linear, halves

from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.build_up.report import report_of
from ves_twin.diagnosis.build_up.result import BuildUp, Proved
from ves_twin.diagnosis.verdict.cause import Cause, Estimate
from ves_twin.diagnosis.verdict.sized import sized
from ves_twin.report.diagnosis.proved import standing_words

ENDS = {"level": (0.0, 2.0)}


@pytest.mark.parametrize(
    ("value", "high", "firm", "ended"),
    [(1.7, 1.9, True, False), (1.7, 2.0, False, False), (1.99, 2.0, False, True)],
)
def test_a_size_whose_interval_reaches_the_end_of_its_range_is_not_firm(value, high, firm, ended):
    """At the end itself it stands for something else; a crane's viscous friction of 4.3 N s/m
    within 0 to 21 was called that, and 4 was true.
    """
    size = Estimate(value, 1.5, high, "N", 0.0)
    cause = Cause("coulomb_friction", "joint", {"level": size}, 1.0, True, None)
    one = Proved("coulomb_friction", "joint", {}, 1e-3, 20, {"torque": (2.0, 1.0)}, True)
    (told,) = sized(BuildUp((one,), 1, 0.05, 0.05, {}, {}), (cause,), ENDS)
    assert told.firm is firm
    assert told.ended is ended
    assert told.wide is not (firm or ended)
    assert ("so not proved" in standing_words(told)) is ended


@pytest.mark.parametrize("out_of_step", [False, True])
def test_a_name_is_not_firm_where_its_channel_is_not_followed_at_all(out_of_step):
    """What makes a simulation out of step smaller improves it, whatever is wrong with it."""
    both = halves(Linear(), {"coulomb@a:size": 0.8}, 51, error=0.02)
    labels = [trial.cause.label for trial in both.regression.trials]
    proof = prove(both.regression, both.held, [labels.index("coulomb@a")])
    assert proof.proved
    left = proof.bench.residual(proof.proved)
    if out_of_step:
        left = left - 2.0 * both.measured
    (one,) = report_of(both, proof, (left, left)).proved
    assert one.unfollowed == (("torque.a",) if out_of_step else ())
    assert one.firm is not out_of_step
    assert ("torque.a is still not followed at all" in standing_words(one)) is out_of_step


@pytest.mark.parametrize(
    ("value", "spread", "firm"), [(0.0008, 0.1, False), (0.0013, 0.4, False), (0.0021, 0.1, True)]
)
def test_a_delay_that_may_be_less_than_a_row_is_not_firm(value, spread, firm):
    """When in its row a log stamps each column is not known (EMPS, 0.8 ms in rows of 1 ms)."""
    size = Estimate(value, (1.0 - spread) * value, (1.0 + spread) * value, "s", 0.0)
    cause = Cause("actuator_delay", "motor", {"actuator_delay@motor:delay": size}, 1.0, True, None)
    one = Proved("actuator_delay", "motor", {}, 1e-9, 20, {"torque": (2.0, 1.0)}, True)
    ends = {"actuator_delay@motor:delay": (0.0, 0.05)}
    (told,) = sized(BuildUp((one,), 1, 0.05, 0.05, {}, {}), (cause,), ends, row=0.001)
    assert told.firm is firm
    assert told.below_row is not firm


@pytest.mark.parametrize(("low", "firm"), [(0.2, True), (-0.2, False)])
def test_a_size_whose_interval_holds_the_models_own_value_is_not_firm(low, firm):
    size = Estimate(1.0, low, 1.8, "N", 0.0)
    cause = Cause("coulomb_friction", "joint", {"level": size}, 1.0, True, None)
    one = Proved("coulomb_friction", "joint", {}, 1e-3, 20, {"torque": (2.0, 1.0)}, True)
    (told,) = sized(BuildUp((one,), 1, 0.05, 0.05, {}, {}), (cause,), ENDS)
    assert told.parameters["level"].value == 1.0
    assert told.firm is firm


@pytest.mark.parametrize(
    ("cosine", "sine", "firm"), [(0.9, -0.2, True), (-0.2, -0.2, False), (0.9, 0.4, True)]
)
def test_of_a_vector_one_size_away_from_the_models_own_value_is_enough(cosine, sine, firm):
    sizes = {
        "cosine": Estimate(1.0, cosine, 1.1, "N", 0.0),
        "sine": Estimate(0.1, sine, 0.5, "N", 0.0),
    }
    cause = Cause("ripple", "joint.12", sizes, 1.0, True, None)
    one = Proved("ripple", "joint.12", {}, 1e-3, 20, {"torque": (2.0, 1.0)}, True)
    ends = dict.fromkeys(sizes, (-2.0, 2.0))
    built = BuildUp((one,), 1, 0.05, 0.05, {}, {})
    assert sized(built, (cause,), ends, components=set(sizes))[0].firm is firm


@pytest.mark.parametrize(("p", "firm"), [(0.04, True), (0.1, False)])
def test_a_name_that_only_many_sure_ones_beside_it_let_pass_is_not_firm(p, firm):
    size = Estimate(1.0, 0.5, 1.5, "N", 0.0)
    cause = Cause("coulomb_friction", "joint", {"level": size}, 1.0, True, None)
    one = Proved("coulomb_friction", "joint", {}, p, 20, {"torque": (2.0, 1.0)}, True)
    (told,) = sized(BuildUp((one,), 7, 0.05, 0.05, {}, {}), (cause,), ENDS)
    assert told.firm is firm


def test_what_full_simulation_fits_to_nothing_is_not_proved():
    size = Estimate(0.0, 0.0, 3e-4, "m", 0.0)
    cause = Cause("backlash", "joint", {"level": size}, 1.0, True, None)
    one = Proved("backlash", "joint", {}, 1e-3, 20, {"torque": (2.0, 1.9)}, True)
    assert not sized(BuildUp((one,), 1, 0.05, 0.05, {}, {}), (cause,), ENDS)


@pytest.mark.parametrize(
    ("kind", "value", "firm"),
    [
        ("stribeck_friction", -1.5, False),
        ("stribeck_friction", 1.5, True),
        ("quadratic_drag", -1.5, False),
        ("coulomb_friction", -1.5, True),
    ],
)
def test_what_no_machine_has_less_of_than_none_is_no_mechanism(kind, value, firm):
    """Grease's friction of a measured arm was called a Stribeck friction of -1.5 N m, firmly."""
    size = Estimate(value, value - 0.4, value + 0.4, "N", 0.0)
    cause = Cause(kind, "joint", {"level": size}, 1.0, True, None)
    one = Proved(kind, "joint", {}, 1e-9, 20, {"torque": (2.0, 1.0)}, True)
    (told,) = sized(BuildUp((one,), 1, 0.05, 0.05, {}, {}), (cause,), {"level": (-9.0, 9.0)})
    assert told.firm is firm
    assert ("grows less than in proportion" in standing_words(told)) is not firm


def test_efforts_that_a_motion_lacks_have_nothing_to_follow():
    """They are measured as zeros, and no name would be firm where more than noise is left."""
    both = halves(Linear(), {"coulomb@a:size": 0.8}, 51, error=0.02)
    labels = [trial.cause.label for trial in both.regression.trials]
    proof = prove(both.regression, both.held, [labels.index("coulomb@a")])
    left = 50.0 * proof.bench.residual(proof.proved)
    zeros = replace(both, measured=np.zeros_like(both.measured))
    (one,), (other,) = (report_of(two, proof, (left, left)).proved for two in (both, zeros))
    assert one.unfollowed
    assert not other.unfollowed


@pytest.mark.parametrize("kind", ["coulomb_friction", "viscous_friction"])
@pytest.mark.parametrize(
    ("beside", "high", "firm"),
    [
        ("quadratic_drag@a", -0.1, False),
        ("stribeck_friction@a", -0.1, False),
        ("quadratic_drag@b", -0.1, True),
        ("quadratic_drag@a", 0.1, True),
        ("joint_spring@a", -0.1, True),
    ],
)
def test_a_friction_is_not_firm_where_a_sublinear_one_is_proved_at_its_place(
    kind, beside, high, firm
):
    """Of an arm whose friction is F + k |v|^0.6 a viscous friction was firm, which it has not."""
    other, target = beside.split("@")
    sizes = (Estimate(1.0, 0.5, 1.5, "N", 0.0), Estimate(-0.3, -0.6, high, "N", 0.0))
    names = ((kind, "a"), (other, target))
    causes = tuple(
        Cause(*name, {"level": size}, 1.0, True, None)
        for name, size in zip(names, sizes, strict=True)
    )
    proved = tuple(Proved(*name, {}, 1e-3, 20, {"torque": (2.0, 1.0)}, firm=True) for name in names)
    told, _ = sized(BuildUp(proved, 2, 0.05, 0.05, {}, {}), causes, {"level": (-2.0, 2.0)})
    assert told.firm is firm
    assert ("friction grows less than in proportion" in standing_words(told)) is not firm
