"""Proof by held-out improvement: what is hidden is found, what is not there is not."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from linear import KINDS, Linear, Narrow, drawn, halves, motion, recorded, seen, shape

from ves_twin.diagnosis.build_up import judges as judges_module
from ves_twin.diagnosis.build_up.bench import STRAINED, Bench
from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.build_up.halves import halves_at, split
from ves_twin.diagnosis.build_up.inseparable import inseparable
from ves_twin.diagnosis.build_up.nearest import nearest
from ves_twin.diagnosis.build_up.paired import Difference, paired
from ves_twin.diagnosis.build_up.proof import FALSE_SHARE, NULL_FROM, _again, _null, prove
from ves_twin.diagnosis.build_up.report import report_of
from ves_twin.diagnosis.build_up.select import Selector
from ves_twin.diagnosis.build_up.spanned import spanned_by
from ves_twin.diagnosis.build_up.stand_ins import StandIns
from ves_twin.diagnosis.build_up.trials import Trial, columns_of, trials_at

PLANT = Linear()


def label(trial) -> str:
    return f"{trial.cause.label}:size"


def found(two):
    """Labels that are chosen and proved, and the proof."""
    chosen = Selector(two.regression).run()
    proof = prove(two.regression, two.held, chosen)
    return {label(two.regression.trials[n]) for n in proof.proved}, proof


def test_what_a_residual_is_whitened_by_makes_it_white_and_of_unit_size():
    world = seen(PLANT, recorded(PLANT, {}, 3))
    residual = world.measured - world.runs.one(world.runs.origin)
    z = discrepancy(world.runs, residual).apply(residual).reshape(-1, 2)
    assert np.std(z, axis=0) == pytest.approx(1.0, abs=0.06)
    for lag in range(1, 5):
        memory = np.mean(z[lag:] * z[:-lag], axis=0)
        assert np.all(np.abs(memory) < 4.0 / np.sqrt(len(z)))


def test_no_channel_is_quieter_than_its_declared_noise():
    world = seen(PLANT, recorded(PLANT, {}, 3))
    silent = np.zeros(world.measured.shape)
    z = discrepancy(world.runs, silent).apply(np.full_like(world.measured, PLANT.noise))
    assert np.all(np.isfinite(z))
    assert np.max(np.abs(z)) < 10.0


def test_differences_that_remember_are_seldom_taken_for_an_improvement():
    rng, low = np.random.default_rng(0), 0
    for _ in range(200):
        x = np.convolve(rng.standard_normal(1100), np.ones(40) / 40, "valid")[:1000]
        low += paired(x - 0.02 * abs(x.mean()), np.zeros(1000, int)).p < 0.05
    assert low <= 24  # 10 expected, 24 is four sd more


def test_a_block_never_reaches_over_a_gap():
    piece = np.repeat(np.arange(10), 100)
    assert paired(np.random.default_rng(1).standard_normal(1000), piece).blocks >= 10


@pytest.mark.parametrize("seed", [0, 1])
def test_hidden_causes_are_proved_and_their_sizes_are_right(seed):
    hidden = drawn(np.random.default_rng(seed), 4)
    two = halves(PLANT, hidden, seed)
    names, proof = found(two)
    assert set(hidden) - {"rotor@a:size", "rotor@b:size"} <= names
    _, shares = proof.bench.subset(proof.proved)
    fit = two.regression.solve(proof.proved, proof.bench.fit.whitening)
    for n, at in two.regression.places(proof.proved).items():
        if label(two.regression.trials[n]) in hidden:
            trial = two.regression.trials[n]
            (size,) = trial.departures(fit.shares[at] * fit.scale[at])
            assert size == pytest.approx(hidden[label(trial)], rel=0.25)
    assert len(shares)


def told(two, proof):
    """The report, by the linear model."""
    left = two.regression.solve(proof.proved, proof.bench.fit.whitening).residual
    return report_of(two, proof, (left, proof.bench.residual(proof.proved)))


def test_a_twin_is_a_stand_in_and_takes_the_firm_name_away():
    plant = Linear((*KINDS, "twin"))
    two = halves(plant, {"viscous@a:size": 0.5, "coulomb@b:size": 0.6}, 4)
    names, proof = found(two)
    others = StandIns.of(proof).within
    trials = two.regression.trials
    like = {trials[n].cause.label: {trials[k].cause.label for k in ks} for n, ks in others.items()}
    pair = {"viscous@a", "twin@a"}
    (kept,) = pair & {name.removesuffix(":size") for name in names}
    assert like[kept] >= pair - {kept}
    report = told(two, proof)
    firm = {one.label: one.firm for one in report.proved}
    assert not firm[kept]
    assert firm["coulomb@b"]
    apart = [set(one.names) for one in inseparable(proof, others)]
    assert any(pair <= names for names in apart)


def proved_together(plant, hidden, names):
    """The proof of named causes, and its report by label."""
    two = halves(plant, hidden, 4)
    trials = two.regression.trials
    proof = prove(two.regression, two.held, [n for n, t in enumerate(trials) if label(t) in names])
    assert {label(trials[n]) for n in proof.proved} == set(names)
    return proof, {one.label: one for one in told(two, proof).proved}


def test_a_coupling_that_friction_at_each_joint_spans_is_not_firm():
    """Friction at both joints alike is that on the sum with that on the difference of speeds."""
    plant = Linear(couplings=("sum", "difference"))
    names = ("coupling@sum:size", "coupling@difference:size", "coulomb@b:size")
    hidden = {"viscous@a:size": 1.2, "viscous@b:size": 1.2, "coulomb@b:size": 0.6}
    _, report = proved_together(plant, hidden, names)
    assert not report["coupling@sum"].firm
    assert report["coulomb@b"].firm


def test_a_coupling_alone_is_what_three_others_are():
    plant = Linear(couplings=("sum", "difference"))
    names = ("coupling@sum:size", "coulomb@b:size")
    proof, report = proved_together(plant, {names[0]: 0.8, names[1]: 0.6}, names)
    trials = proof.bench.regression.trials
    (one,) = [n for n in proof.proved if trials[n].cause.effect == "coupling"]
    few = {trials[n].cause.label for n in spanned_by(proof, one)}
    assert few == {"viscous@a", "viscous@b", "coupling@difference"}
    assert report["coupling@sum"].acts_like[0].split(" + ") == [
        trials[n].cause.label for n in spanned_by(proof, one)
    ]
    assert not report["coupling@sum"].firm
    assert report["coulomb@b"].firm


def test_a_coupling_is_firm_where_the_library_has_nothing_that_spans_it():
    plant = Linear(tuple(k for k in KINDS if k != "viscous"), couplings=("sum",))
    names = ("coupling@sum:size", "coulomb@b:size")
    _, report = proved_together(plant, {names[0]: 0.8, names[1]: 0.6}, names)
    assert report["coupling@sum"].firm


def test_the_report_says_what_each_takes_and_what_is_left():
    two = halves(PLANT, {"coulomb@a:size": 0.8}, 7)
    _, proof = found(two)
    report = told(two, proof)
    (one,) = [p for p in report.proved if p.label == "coulomb@a"]
    before, after = one.takes["torque.a"]
    assert before > 2.0 * after
    assert set(one.takes) == {"torque.a"}
    left = report.left["torque.a"]
    assert left.rms == pytest.approx(after)
    assert left.rms == pytest.approx(0.1, rel=0.3)  # the hidden model error
    assert left.noise == pytest.approx(PLANT.noise)
    assert report.false_discovery_rate == FALSE_SHARE
    assert report.tested >= len(report.proved)


def test_a_law_that_the_library_lacks_is_seen_in_what_is_left_and_no_name_is_firm_there():
    lacking = Linear(tuple(k for k in KINDS if k not in ("harmonic", "drag")))
    world = {"harmonic@a:size": 0.7, "viscous@a:size": 0.5}
    one, two = (seen(lacking, recorded(PLANT, world, s, 0.02)) for s in (11, 12))
    both = halves_at(one, two, one.runs.origin, lacking.hypotheses)
    _, proof = found(both)
    report = told(both, proof)
    assert "q.1" in report.left["torque.a"].laws
    about = [p for p in report.proved if p.label in ("spring@a", "offset@a")]
    assert not any(p.firm for p in about)


def test_a_linear_cause_has_one_trial_and_a_bent_one_has_one_for_each_size():
    plant = Linear(("viscous", "gap"))
    world = seen(plant, recorded(plant, {}, 1))
    trials, columns = trials_at(world.runs, world.runs.origin, plant.hypotheses)
    kinds = [t.cause.label for t in trials]
    assert kinds.count("viscous@a") == 1
    assert kinds.count("gap@a") > 2
    assert all(column.shape == (1, 900, 2) for column in columns)


def test_a_trial_stands_for_the_same_cause_before_and_after_it_is_fitted():
    world = seen(PLANT, recorded(PLANT, {}, 1))
    cause = next(h for h in PLANT.hypotheses if h.label == "viscous@a")
    trial = Trial(cause, (0.7,))
    there = world.runs.depart(world.runs.origin, world.runs.indices(cause), np.array([0.3]))
    (one,) = columns_of(world.runs, world.runs.origin, [trial])
    (two,) = columns_of(world.runs, there, [trial])
    assert np.allclose(one, two, atol=1e-5)


def test_a_record_is_split_into_stretches_that_share_no_row():
    world = seen(PLANT, recorded(PLANT, {}, 1))
    one, two = split(world)
    assert not np.any(one.runs.kept & two.runs.kept)
    assert np.all(one.runs.kept | two.runs.kept)
    both = halves_at(one, two, one.runs.origin, PLANT.hypotheses)
    assert len(both.held.own) == 0
    assert both.regression.half.columns.known is both.held.columns.known


def test_a_split_record_proves_what_is_hidden_in_it():
    hidden = {"coulomb@a:size": 0.8, "viscous@b:size": 0.4}
    one, two = split(seen(PLANT, recorded(PLANT, hidden, 5)))
    names, _ = found(halves_at(one, two, one.runs.origin, PLANT.hypotheses))
    assert set(hidden) <= names


def test_rows_without_a_measurement_change_no_proof():
    """A spike in a hole is as if it were not there."""
    record = recorded(PLANT, {"coulomb@a:size": 0.8}, 21)
    torque = record["torque"].copy()
    torque[300:320, 0] = np.nan
    holed = replace(record, signals={**record.signals, "torque": torque})
    one, two = seen(PLANT, holed), seen(PLANT, recorded(PLANT, {"coulomb@a:size": 0.8}, 22))
    names, _ = found(halves_at(one, two, one.runs.origin, PLANT.hypotheses))
    assert "coulomb@a:size" in names


def test_a_cause_whose_held_out_simulation_breaks_off_is_not_proved_and_hinders_none():
    """An air-bearing satellite: a mass centre with which it tips over in one recording alone."""
    both = halves(PLANT, {"coulomb@a:size": 0.8, "viscous@b:size": 0.4}, 31)
    labels = [trial.cause.label for trial in both.regression.trials]
    good, bad = (labels.index(name) for name in ("coulomb@a", "viscous@b"))
    for broken, left in (([bad], (good,)), ([good, bad], ())):
        columns = both.held.columns
        known = {n: np.full_like(columns[n], np.nan) for n in broken}
        held = replace(both.held, columns=replace(columns, known={**columns.known, **known}))
        proof = prove(both.regression, held, [good, bad])
        assert proof.proved == left
        assert all(proof.dropped[n] == 1.0 for n in broken)
        assert not set(broken) & {k for found in StandIns.of(proof).within.values() for k in found}


def test_held_out_columns_are_simulated_for_chosen_trials_alone():
    one, two = (seen(PLANT, recorded(PLANT, {"coulomb@a:size": 0.8}, seed)) for seed in (1, 2))
    both = halves_at(one, two, one.runs.origin, PLANT.hypotheses)
    assert not both.held.columns.known
    proof = prove(both.regression, both.held, [0, 2])
    assert set(both.held.columns.known) == {0, 2}
    assert len(both.regression.half.columns.known) == len(both.regression.trials) > 2
    assert proof.tested == 2


@pytest.mark.parametrize("seed", [1, 3])
def test_what_passes_for_discrepancy_is_looked_for_by_plain_squares_too(seed):
    """Offsets at both joints: a discrepancy learnt without them is slow enough to hide one."""
    regression = halves(PLANT, {"offset@a:size": 0.8, "offset@b:size": 0.8}, seed).regression
    names = [{regression.trials[n].cause.label for n in few} for few in Selector(regression).best()]
    assert {"offset@a", "offset@b"} in names
    assert len(names) == len({frozenset(few) for few in names})


def test_nearest_leaves_no_channel_more_than_nothing_does():
    """Of a machine whose friction at the second joint is of the other sign where it is held out."""
    there = {"coulomb@a:size": 0.8, "coulomb@b:size": -0.6}
    one, two = (
        seen(PLANT, recorded(PLANT, hidden, seed))
        for hidden, seed in (({**there, "coulomb@b:size": 0.6}, 5), (there, 6))
    )
    both = halves_at(one, two, one.runs.origin, PLANT.hypotheses)
    labels = [trial.cause.label for trial in both.regression.trials]
    first, second = labels.index("coulomb@a"), labels.index("coulomb@b")
    bench = prove(both.regression, both.held, [first, second]).bench
    assert nearest(bench, [[first], [second], [first, second]]) == (first,)
    assert nearest(bench, [[second], [first, second]]) == ()
    same = halves_at(one, one, one.runs.origin, PLANT.hypotheses)
    bench = prove(same.regression, same.held, [first, second]).bench
    assert nearest(bench, [[first], [second], [first, second]]) == (first, second)


def test_what_predicts_better_with_a_sign_that_no_machine_has_is_not_proved():
    hidden = {"coulomb@a:size": -0.8}
    one, two = (seen(PLANT, recorded(PLANT, hidden, seed)) for seed in (5, 6))
    both = halves_at(one, two, one.runs.origin, PLANT.hypotheses)
    regression = both.regression
    labels = [trial.cause.label for trial in regression.trials]
    there = labels.index("coulomb@a")
    assert prove(regression, both.held, [there]).proved == (there,)
    trials = [replace(t, positive=t.cause.label == "coulomb@a") for t in regression.trials]
    assert prove(replace(regression, trials=trials), both.held, [there]).proved == ()


def test_a_tolerance_does_no_causes_work_far_beyond_its_sd():
    """Both rotors are too heavy by 50 sd of the mass, which would stand for either of them."""
    two = halves(Linear(("rotor", "viscous")), {"rotor@a:size": 0.5, "rotor@b:size": 0.5}, 12)
    labels = [trial.cause.label for trial in two.regression.trials]
    chosen = [labels.index("rotor@a"), labels.index("rotor@b")]
    proof = prove(two.regression, two.held, chosen)
    assert set(proof.proved) == set(chosen)
    for some in (chosen[:1], chosen[1:], []):
        at, shares = proof.bench.subset(some)
        full = np.abs(proof.bench.fit.shares[:2])
        assert np.all(np.abs(shares[:2]) <= np.maximum(STRAINED, full) + 1e-9)
        free = at[2:]
        left = proof.bench.fit.gradient[free] - proof.bench.fit.hessian[np.ix_(free, at)] @ shares
        assert left == pytest.approx(np.zeros(len(free)), abs=1e-6 * len(two.held.target))


def test_held_out_rows_without_a_sample_prove_nothing():
    two = halves(Linear(), {"viscous@a:size": 0.6}, 12)
    labels = [trial.cause.label for trial in two.regression.trials]
    chosen = [labels.index("viscous@a")]
    holes = (np.ones_like(two.held.runs.kept),)
    held = replace(two.held, runs=replace(two.held.runs, holes=holes))
    proof = prove(two.regression, held, chosen)
    assert proof.proved == ()
    assert proof.dropped == dict.fromkeys(chosen, 1.0)


def test_each_cause_is_proved_by_the_errors_that_show_it_better():
    """One-step errors where it has edges, plain ones where it is as slow as the model error."""
    hidden = {"coulomb@a": (0.1, True), "viscous@b": (0.4, False)}
    kinds, moved = ("coulomb", "viscous"), motion(1).drive["q"]
    rms = [np.sqrt(np.mean(np.square(shape(k, moved[:, c])))) for c, k in enumerate(kinds)]
    sizes = {f"{label}:size": hidden[label][0] / r for label, r in zip(hidden, rms, strict=True)}
    two = halves(Linear(kinds), sizes, 14, error=0.2)
    labels = [trial.cause.label for trial in two.regression.trials]
    proof = prove(two.regression, two.held, [labels.index(label) for label in hidden])
    judges = {labels[n]: proof.judges.of_trial(n) for n in proof.proved}
    assert {label: bench.memory for label, bench in judges.items()} == {
        label: memory for label, (_, memory) in hidden.items()
    }
    for bench in judges.values():
        assert bool(np.any(bench.fit.whitening.filters[..., 1:])) is bench.memory


@pytest.mark.parametrize(("without", "stays"), [(0.2, True), (0.9, False)])
def test_what_passes_beside_more_is_not_lost_as_they_go(monkeypatch, without, stays):
    """Six causes more leave the first out, beside which the second is plainly there."""
    two = halves(Linear(), {"viscous@a:size": 0.6, "coulomb@a:size": 0.6}, 12)
    labels = [trial.cause.label for trial in two.regression.trials]
    first, second = labels.index("viscous@a"), labels.index("coulomb@a")

    def each(_, kept, asked):
        p = {first: 0.06, second: 0.001 if first in kept else without}
        return {n: Difference(p[n], 1.0, 20) for n in asked}

    monkeypatch.setattr(judges_module, "_each", each)
    found = prove(two.regression, two.held, [first, second], more=6)
    assert (second in found.proved) is stays
    assert first in found.dropped


def test_large_errors_widen_the_scale_where_they_count_by_their_squares():
    """A tenth of the rows with ten times the error: the rms grows by three, the middle hardly."""
    two = halves(Linear(("viscous",)), {"viscous@a:size": 0.2}, 12)
    target = two.held.target.copy()
    target[::10] *= 10.0
    held = replace(two.held, target=target)
    fit = two.regression.fit([0], memory=False)
    kinds = ((False, False), (False, True))
    robust, even = (Bench(fit, held, two.regression, *kind).scale([0]) for kind in kinds)
    plain = Bench(fit, two.held, two.regression, False, True).scale([0])
    assert np.all(even > 2.5 * plain)
    assert np.all(robust < 1.4 * plain)


@pytest.mark.parametrize("errors", judges_module.ERRORS)
def test_what_spans_a_cause_is_told_by_independent_rows_whatever_proves_it(monkeypatch, errors):
    """Friction that is less than the model error: dry friction does as well beside slow error."""
    rms = np.sqrt(np.mean(np.square(shape("viscous", motion(1).drive["q"][:, 0]))))
    plant = Linear(("coulomb", "viscous"))
    two = halves(plant, {"viscous@a:size": 0.1}, 12, error=0.2)
    assert 0.1 * rms < 0.2
    labels = [trial.cause.label for trial in two.regression.trials]
    there = labels.index("viscous@a")
    monkeypatch.setattr(judges_module, "ERRORS", (errors,))
    proof = prove(two.regression, two.held, [there])
    assert proof.proved == (there,)
    assert [labels[n] for n in spanned_by(proof, there)] == ["coulomb@a"]


@pytest.mark.parametrize(
    ("p", "back"), [({5: 0.3, 7: 1e-4}, 7), ({5: 0.3, 7: 0.2}, None), ({}, None)]
)
def test_a_dropped_cause_comes_back_where_held_out_rows_ask_for_it(p, back):
    """Beside what is kept now; the one with the smallest p, if that is clear."""
    wider = SimpleNamespace(each=lambda kept, asked: {n: Difference(p[n], 1.0, 20) for n in asked})
    judges = SimpleNamespace(fitted=lambda names: wider)
    assert _again(judges, [1, 2], list(p), 4.0) == back


def test_as_many_may_be_without_an_effect_as_their_large_p_say():
    """Of p that are even between 0 and 1 a share 1 - NULL_FROM is above it; at most all of them."""
    some = [0.9, 0.8, *[0.01] * 10]
    assert _null(some) == pytest.approx(3.0 / (1.0 - NULL_FROM))
    assert _null([0.001]) == 1.0
    assert _null([0.9] * 3) == 3.0


def test_a_cause_that_would_need_more_than_its_range_is_told_and_takes_the_firm_name_away():
    """A twin rotor's constant torque was twice its range, and a shifted mass stood for it."""
    plant = Narrow(("twin", "viscous", "coulomb"))
    two = halves(plant, {"viscous@a:size": 0.5, "coulomb@b:size": 0.6}, 4)
    labels = [trial.cause.label for trial in two.regression.trials]
    proof = prove(two.regression, two.held, [labels.index("twin@a"), labels.index("coulomb@b")])
    found = StandIns.of(proof)
    own = labels.index("twin@a")
    assert own in proof.proved
    short = {labels[k]: sizes for k, sizes in found.beyond[own].items()}
    assert short == {"viscous@a": pytest.approx([0.5], rel=0.2)}
    assert "viscous@a" not in {labels[k] for k in found.within[own]}
    report = {one.label: one for one in told(two, proof).proved}
    (other,) = report["twin@a"].beyond
    assert (other.label, report["twin@a"].firm) == ("viscous@a", False)
    size = other.parameters["size"]
    assert (size.low, size.high) == (-0.1, 0.1)
    assert size.value == pytest.approx(0.5, rel=0.2)
    assert report["coulomb@b"].beyond == ()
