"""Explanations of a record: which fits are made, ranked, called adequate, and given up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import QUICK, SD, Toy, programme

from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.explain import explain as explain_module
from ves_twin.diagnosis.explain.explain import FAR, _far, explain
from ves_twin.diagnosis.explain.judge import (
    CLEAR,
    SLACK,
    _commissioning,
    _held,
    _ranked,
    _second,
    judge,
    suspects_at,
)
from ves_twin.diagnosis.explain.pairs import PAIRS, _alone, _better
from ves_twin.diagnosis.explain.probability import probabilities
from ves_twin.diagnosis.fit.assess import STRANGE, assess, pull_limit
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.fits import CLOSE, _starts, job, refined
from ves_twin.diagnosis.fit.null import Thresholds
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.fit.search import FARTHEST
from ves_twin.diagnosis.record.runs import Runs, silent
from ves_twin.diagnosis.record.whitening import whitening_declared

FED = programme(1)
LEVELS = Thresholds(15.0, 5.0, np.zeros(0), np.zeros(0))


@pytest.fixture(scope="module")
def bank():
    return build_bank(Runs(Toy(), (FED,), (0, 1)))


@pytest.fixture
def looked(bank):
    def look(values, added=0.0, library=None):
        clean = Toy().simulate(FED, values) + added
        noise = np.random.default_rng(3).standard_normal(clean.shape) * SD
        runs = (library or bank).base.runs
        rows = (clean + noise).astype(np.float32)
        return assess(rows, library or bank, whitening_declared(runs), 15.0, 5.0, 4.0)

    return look


def effects(fit):
    return {cause.effect for cause in fit.causes}


ONE = {"friction.size": 0.05, "plant.slope": 0.03}
TWO = {"friction.size": 0.1, "ripple.size": 0.1}
STRAINED = {"friction.size": 0.1, "plant.gain": 1.3}  # 15 sd of what commissioning leaves open


def test_one_cause_explains_a_record_of_one(looked):
    found = explain(looked(ONE), LEVELS, QUICK)
    assert effects(found.best) == {"friction"}
    assert found.best is found.chosen[0] is found.fits[0]
    assert found.adequate
    assert found.score < LEVELS.misfit
    assert found.second < LEVELS.effect
    # the truth is within four sd of the fit
    assert abs(found.best.sizes[0] - 0.05) < 4.0 * np.sqrt(found.best.covariance[0, 0])
    assert found.commissioning.causes == ()
    assert found.commissioning.chi2 > found.best.chi2 + 15.0
    assert found.weights[0] == max(found.weights)
    assert found.weights[0] > 0.9
    # noise of the declared size: four sd of chi^2
    n = len(found.best.residual)
    assert found.best.chi2 < n + 4.0 * np.sqrt(2.0 * n)


def test_fits_stand_by_rising_chi2_and_none_is_there_twice(looked):
    found = explain(looked(ONE), LEVELS, replace(QUICK, candidates=6))
    assert [fit.chi2 for fit in found.fits] == sorted(fit.chi2 for fit in found.fits)
    every = [frozenset(effects(fit)) for fit in (*found.fits, *found.hopeless)]
    assert len(every) == len(set(every)) >= 2  # a rival to show
    for fit in found.hopeless:
        assert fit.chi2 > 3.0 * found.best.chi2


def test_those_near_the_likeliest_are_fitted_and_two_at_least(looked):
    record = looked(ONE)
    found = explain(record, LEVELS, replace(QUICK, candidates=6))
    suspects = record.suspects
    reach = suspects[0].score - max(FAR * suspects[0].score, CLOSE)
    near = [s for n, s in enumerate(suspects) if n < 2 or s.score >= reach]
    assert len(near) < len(suspects)
    names = {record.screen.bank.hypotheses[s.hypothesis].effect for s in near}
    assert {effect for fit in (*found.fits, *found.hopeless) for effect in effects(fit)} == names


def test_a_fit_begins_at_the_size_of_the_bank_too_where_that_is_another(looked):
    record = looked(ONE)
    suspect = record.suspects[0]
    rows = record.screen.bank.entries(suspect.hypothesis)
    match = record.screen.match(record.z)[rows]
    nearest = rows[np.argmax(2.0 * match - record.screen.power[rows])]
    own = record.screen.bank.sizes[nearest]
    assert len(_starts(record, replace(suspect, sizes=1.2 * own))) == 1
    scaled, other = _starts(record, replace(suspect, sizes=3.0 * own))
    assert np.array_equal(scaled, 3.0 * own)
    assert np.array_equal(other, own)


@pytest.mark.parametrize("true_leads", [False, True])
def test_a_fit_that_stopped_short_goes_on_from_what_its_rival_found(
    looked, monkeypatch, true_leads
):
    """Each is searched once more from the other's commissioning errors, the leader if it loses."""
    record = looked(ONE)
    runs, base = record.evidence.runs, record.screen.bank.base
    library = {h.effect: h for h in record.screen.bank.hypotheses}
    true, wrong = (
        refine(record.evidence, (library[name],), runs.origin, base) for name in ("friction", "lag")
    )
    assert wrong.chi2 > true.chi2 + 40.0
    short = {true.causes: wrong.chi2 + 30.0}

    def stopped(jobs, desk, what):
        """The search of the true cause stops short wherever it begins at its own errors."""
        own = [np.array_equal(job.shift, true.shift) for job in jobs]
        return [
            replace(fit, chi2=short.get(fit.causes, fit.chi2)) if alone else fit
            for fit, alone in zip(refined(jobs, desk, what), own, strict=True)
        ]

    monkeypatch.setattr("ves_twin.diagnosis.explain.judge.refined", stopped)
    desk = FitContext(record, LEVELS, QUICK, silent)
    leader = true if true_leads else wrong
    found = _ranked(desk, record.evidence, leader, [true, wrong], False)
    assert [fit.causes for fit in found] == [true.causes, wrong.causes]
    assert found[0].chi2 == pytest.approx(true.chi2, rel=1e-3)


def test_two_causes_explain_what_one_does_not(looked):
    record = looked(TWO)
    single = explain(record, LEVELS, QUICK, together=False)
    assert not single.adequate
    assert len(single.best.causes) == 1
    assert single.alone == ()
    double = explain(record, LEVELS, QUICK)
    assert double.adequate
    assert effects(double.best) == {"friction", "ripple"}
    assert double.best.sizes == pytest.approx([0.1, 0.1], rel=0.1)
    assert double.best.chi2 < single.best.chi2 - LEVELS.effect
    alone = {frozenset(effects(fit)) for fit in double.alone}
    assert {frozenset({"friction"}), frozenset({"ripple"})} <= alone
    assert all(len(fit.causes) == 1 for fit in double.alone)


@pytest.mark.parametrize("known", ["friction", "ripple"])
@pytest.mark.parametrize(("values", "names"), [(ONE, {"friction"}), (TWO, {"friction", "ripple"})])
def test_no_pair_is_named_where_either_of_its_causes_does_as_well_alone(
    looked, values, names, known
):
    """The one that was known before stopped short, or is the wrong one."""
    record = looked(values)
    evidence, base = record.evidence, record.screen.bank.base
    causes = [h for h in record.screen.bank.hypotheses if h.effect in ("friction", "ripple")]
    pair = refine(evidence, tuple(causes), evidence.runs.origin, base)
    before = next(refine(evidence, (h,), pair.shift, base) for h in causes if h.effect == known)
    desk = FitContext(record, LEVELS, QUICK, silent)
    double = judge(desk, [pair])
    alone = [_alone(double, cause) for cause in causes]
    found = _better(desk, double, double.best.chi2 + 1e3, alone, (before,))
    assert found.adequate
    assert effects(found.best) == names
    told = [fit.causes for fit in (*found.fits, *found.hopeless, *found.alone)]
    assert len(told) == len(set(told))
    assert {(cause,) for cause in causes} <= set(told)


def test_a_single_cause_that_strains_a_tolerance_is_no_better_than_a_pair(looked):
    record = looked(ONE)
    evidence, base = record.evidence, record.screen.bank.base
    causes = [h for h in record.screen.bank.hypotheses if h.effect in ("friction", "ripple")]
    desk = FitContext(record, LEVELS, QUICK, silent)
    double = judge(desk, [refine(evidence, tuple(causes), evidence.runs.origin, base)])
    alone = [_alone(double, cause) for cause in causes]
    limit = pull_limit(record.screen.bank, QUICK.alpha)
    axis = alone[0].active[-1]
    strained = [replace(fit, shift=fit.shift + 0.0) for fit in alone]
    for fit in strained:
        fit.shift[axis] = 1.1 * limit * fit.local.runs.sd[axis]
        assert fit.pull > limit
    found = _better(desk, double, double.best.chi2 + 1e3, strained, ())
    assert len(found.best.causes) == 2


def test_a_second_cause_is_found_beside_the_best_where_the_bank_proposes_no_pair(
    looked, monkeypatch
):
    """The bank's pairs are of what stands at nominal; beside a fit a second cause shows better."""
    monkeypatch.setattr("ves_twin.diagnosis.bank.screen.Screen.pairs", lambda *_: [])
    double = explain(looked(TWO), LEVELS, QUICK)
    assert double.adequate
    assert effects(double.best) == {"friction", "ripple"}


@pytest.mark.parametrize("rough", [False, True])
def test_what_a_rough_fit_of_commissioning_errors_leaves_too_much_makes_nothing_likelier(
    looked, monkeypatch, rough
):
    """The model's error is a share of what the cause takes off chi^2, as far as that is sure."""
    place = "ves_twin.diagnosis.explain.judge"
    allowed = []

    def noted(fits, allowance, odds):
        allowed.append(allowance)
        return probabilities(fits, allowance, odds)

    def left(*given):
        fit = _commissioning(*given)[0]
        return replace(fit, chi2=fit.chi2 + 1e4), rough

    monkeypatch.setattr(f"{place}.probabilities", noted)
    usual = explain(looked(ONE), LEVELS, QUICK, together=False)
    monkeypatch.setattr(f"{place}._commissioning", left)
    explain(looked(ONE), LEVELS, QUICK, together=False)
    taken = usual.commissioning.chi2 - usual.best.chi2
    sure = taken if rough else taken + 1e4
    plain, with_more = allowed
    assert plain == pytest.approx(QUICK.model_error**2 * taken, rel=1e-6)
    # the power of the cause is the fall of chi^2 of a linear plant; noise of another level differs
    assert with_more == pytest.approx(QUICK.model_error**2 * sure, rel=1e-3)


@pytest.mark.parametrize(
    ("sparse", "short", "rough", "rounds"),
    [
        (False, 40.0, False, []),
        (False, -5.0, False, [QUICK.rounds]),
        (True, 40.0, False, [0]),
        (True, 400.0, True, []),
        (True, -5.0, False, [0, QUICK.rounds]),
    ],
)
def test_commissioning_errors_get_new_columns_where_the_cause_takes_off_little(
    looked, monkeypatch, sparse, short, rough, rounds
):
    """`short`: by how much chi^2 without the cause is beyond what counts as clear."""
    record, asked = looked({"friction.size": 0.2}), []
    runs, evidence = record.evidence.runs, record.evidence
    friction = next(h for h in record.screen.bank.hypotheses if h.effect == "friction")
    leader = refine(evidence, (friction,), runs.origin, record.screen.bank.base)
    base = record.screen.bank.base
    far = pull_limit(record.screen.bank, QUICK.alpha) if sparse else FARTHEST
    taken = refine(evidence, (), runs.origin, base, farthest=far).chi2 - leader.chi2
    assert SLACK * leader.chi2 == pytest.approx(160.0, abs=20.0)

    def noted(evidence, fit, count):
        asked.append(count)
        return fit

    monkeypatch.setattr("ves_twin.diagnosis.explain.judge.again", noted)
    level = replace(LEVELS, effect=(taken - short) / CLEAR)
    desk = FitContext(record, level, replace(QUICK, sparse=sparse), silent)
    fit, told = _commissioning(desk, evidence, leader, False)
    assert fit.causes == ()
    assert (told, asked) == (rough, rounds)
    assert _commissioning(desk, evidence, leader, True)[1] == sparse


def test_pairs_beside_the_best_leave_room_for_those_of_the_bank(looked, monkeypatch):
    record, tried = looked(TWO), []
    odd = [s for s in record.suspects if _name(record, s) in {"drift", "lag"}]
    monkeypatch.setattr("ves_twin.diagnosis.bank.screen.Screen.pairs", lambda *_: [tuple(odd)])

    def noted(evidence, causes, sizes, start):
        tried.append({cause.effect for cause in causes})
        return job(evidence, causes, sizes, start)

    monkeypatch.setattr("ves_twin.diagnosis.explain.pairs.job", noted)
    explain(record, LEVELS, QUICK)
    pairs = [names for names in tried if len(names) == 2]
    assert {"drift", "lag"} in pairs
    assert len(pairs) <= PAIRS


def _name(record, suspect):
    return record.screen.bank.hypotheses[suspect.hypothesis].effect


def test_what_no_cause_of_the_library_explains_is_not_adequate(looked):
    time = FED.time[:, None]
    strange = 0.3 * np.sin(2.0 * np.pi * 9.0 * time) * np.where(time > 4.0, [1.0, -2.0], 0.0)
    found = explain(looked({}, added=strange), LEVELS, QUICK)
    assert not found.adequate
    assert found.score > LEVELS.misfit


def test_what_no_cause_comes_near_is_given_up_before_pairs_and_second_causes(looked, monkeypatch):
    time = FED.time[:, None]
    strange = 3.0 * np.sin(2.0 * np.pi * 9.0 * time) * np.where(time > 4.0, [1.0, -2.0], 0.0)
    for where in ("judge", "pairs"):
        name = f"ves_twin.diagnosis.explain.{where}.suspects_at"
        monkeypatch.setattr(name, lambda *_: pytest.fail("looked"))
    many = replace(QUICK, sparse=True)
    found = explain(looked({}, added=strange), LEVELS, many)
    assert found.far
    assert not found.adequate
    assert found.second is None
    several = replace(many, causes=3)  # building up goes on from any of them
    monkeypatch.undo()
    assert not explain(looked({}, added=strange), LEVELS, several).far
    assert not explain(looked({}, added=strange), LEVELS, QUICK).far
    assert not explain(looked(ONE), LEVELS, many).far
    assert not explain(looked(TWO), LEVELS, many).far


@pytest.mark.parametrize(("left", "far"), [(0.4, False), (0.6, True)])
def test_what_no_cause_takes_half_of_is_far(looked, left, far):
    """`left`: share of the chi^2 above noise that the best cause leaves."""
    time = FED.time[:, None]
    strange = 3.0 * np.sin(2.0 * np.pi * 9.0 * time) * np.where(time > 4.0, [1.0, -2.0], 0.0)
    first = looked({}, added=strange)
    desk = FitContext(first, LEVELS, replace(QUICK, sparse=True), silent)
    alone = first.commissioning
    noise = len(alone.residual)
    best = replace(alone, chi2=noise + left * (alone.chi2 - noise))
    assert best.chi2 > STRANGE * noise
    assert _far(desk, [replace(best, chi2=2.0 * best.chi2), best]) == far
    assert not _far(replace(desk, settings=QUICK), [best])


def test_a_machine_of_many_parameters_names_the_same(looked):
    for values in (ONE, TWO):
        usual, sparse = (
            explain(looked(values), LEVELS, replace(QUICK, sparse=many)) for many in (False, True)
        )
        assert effects(sparse.best) == effects(usual.best)
        assert sparse.adequate == usual.adequate
        assert sparse.best.sizes == pytest.approx(usual.best.sizes, rel=1e-3)


def test_where_runs_are_dear_a_strained_pair_comes_before_single_causes_are_weighed(
    looked, monkeypatch
):
    record, dear = looked(STRAINED), replace(QUICK, sparse=True)
    usual = explain(record, LEVELS, QUICK)
    monkeypatch.setattr(
        "ves_twin.diagnosis.explain.explain.judge", lambda *_: pytest.fail("weighed")
    )
    found = explain(record, LEVELS, dear)
    assert found.adequate
    assert effects(found.best) == effects(usual.best) == {"friction", "gain"}
    order = [cause.effect for cause in usual.best.causes]
    mine = dict(zip((c.effect for c in found.best.causes), found.best.sizes, strict=True))
    assert [mine[name] for name in order] == pytest.approx(usual.best.sizes, rel=1e-3)
    alone = found.alone[0]
    assert len(alone.causes) == 1
    assert alone.chi2 > found.best.chi2 + LEVELS.effect
    monkeypatch.undo()
    assert len(explain(record, LEVELS, dear, together=False).best.causes) == 1


def test_a_second_cause_that_takes_too_little_off_is_no_pair_however_strained(looked):
    record = looked(STRAINED)
    high = replace(LEVELS, effect=1e6)
    assert len(explain(record, high, replace(QUICK, sparse=True)).best.causes) == 1


def test_a_cause_that_takes_less_off_than_the_threshold_explains_nothing(looked):
    record = looked(ONE)
    fall = explain(record, LEVELS, QUICK)
    taken = fall.commissioning.chi2 - fall.best.chi2
    high = replace(LEVELS, effect=2.0 * taken)
    assert not explain(record, high, QUICK, together=False).adequate
    low = replace(LEVELS, effect=1.2 * taken)  # a cause may take LEAST of it
    assert explain(record, low, QUICK, together=False).adequate


def test_an_empty_library_explains_nothing():
    empty = build_bank(Runs(Toy(causes=(), with_gain=False), (FED,), (0, 1)))
    clean = Toy().simulate(FED, ONE).astype(np.float32)
    first = assess(clean, empty, whitening_declared(empty.base.runs), 15.0, 5.0, 4.0)
    assert explain(first, LEVELS, QUICK) is None


def test_every_fit_near_the_first_is_held_where_that_costs_less_than_a_further_cause(
    looked, monkeypatch
):
    """Whichever of them is the most probable in the end, its tolerances are those of a rig."""
    record = looked(STRAINED)
    evidence, base = record.evidence, record.screen.bank.base
    causes = [h for h in record.screen.bank.hypotheses if h.effect in ("friction", "ripple")]
    fits = [refine(evidence, (cause,), evidence.runs.origin, base) for cause in causes]
    ranked = sorted(fits, key=lambda fit: fit.chi2)
    limit = pull_limit(record.screen.bank, QUICK.alpha)
    assert [fit.pull > limit for fit in ranked] == [True, True]
    held = _held(evidence, ranked, limit, clear=1e6)
    assert [fit.pull <= limit for fit in held] == [True, True]
    assert held[0].chi2 <= held[1].chi2
    assert _held(evidence, ranked, limit, clear=1e-6) == ranked
    apart = 0.5 * (ranked[1].chi2 - ranked[0].chi2)
    tried = []

    def counted(*given, **named):
        tried.append(given[1])
        return refine(*given, **named)

    monkeypatch.setattr("ves_twin.diagnosis.explain.judge.refine", counted)
    again = _held(evidence, ranked, limit, clear=apart)
    assert tried == [ranked[0].causes]  # the other is too far behind to be the most probable
    assert any(fit is ranked[1] for fit in again)


def test_progress_is_a_share_of_each_stage(looked):
    told = []
    explain(looked(TWO), LEVELS, QUICK, progress=lambda share, what: told.append((share, what)))
    assert all(0.0 <= share <= 1.0 for share, _ in told)
    stages = list(dict.fromkeys(what for _, what in told))
    assert stages[0] == "fitting single causes"
    assert {"fitting its rivals", "weighing rivals", "fitting pairs of causes"} <= set(stages)
    assert "signatures" in stages


def test_no_signatures_are_simulated_anew_where_the_nominal_ones_find_nothing_more(looked):
    told = []
    found = explain(looked(ONE), LEVELS, QUICK, progress=lambda share, what: told.append(what))
    assert ("signatures" in told) == (found.second >= LEVELS.effect)
    told.clear()
    low = replace(LEVELS, effect=0.0)
    explain(looked(ONE), low, QUICK, together=False, progress=lambda share, what: told.append(what))
    assert "signatures" in told


def test_further_causes_are_all_that_a_fit_has_not_and_their_best_score_is_told(looked):
    record = looked(TWO)
    desk = FitContext(record, LEVELS, QUICK, silent)
    runs = record.evidence.runs
    (cause,) = (h for h in runs.forward.hypotheses if h.effect == "friction")
    fit = refine(record.evidence, (cause,), runs.origin, record.screen.bank.base)
    rest, scores = suspects_at(desk, record.evidence, fit)
    every = {h.label for h in record.screen.bank.hypotheses}
    assert {h.label for h in rest} == every - {cause.label}
    told = _second(desk, record.evidence, fit, 0.0)
    assert rest[scores[0].hypothesis].effect == "ripple"
    assert told == scores[0].score > scores[1].score
    # below the threshold and an allowance nothing is simulated for it
    spared = replace(desk, progress=lambda *_: pytest.fail("simulated"))
    assert _second(spared, record.evidence, fit, 1e9) > LEVELS.effect


@pytest.mark.parametrize(("size", "rough"), [(3.0, True), (0.03, False)])
def test_a_glance_at_single_causes_will_do_where_all_leave_many_times_the_noise(
    looked, monkeypatch, size, rough
):
    """A satellite's were weighed for minutes before its many causes were looked for."""
    time = FED.time[:, None]
    strange = size * np.sin(2.0 * np.pi * 9.0 * time) * np.where(time > 4.0, [1.0, -2.0], 0.0)
    record, calls = looked({}, added=strange), []
    monkeypatch.setattr(explain_module, "settled", lambda e, fits, desk: calls.append(1) or fits)
    found = explain(record, LEVELS, QUICK, glance=True)
    assert (found.rough, not calls) == (rough, rough)
    assert not found.adequate
    assert not explain(record, LEVELS, QUICK).rough
    assert calls
