"""Causes beyond two: each must prove itself on held-out recordings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import QUICK, Toy, programme, record, shape

from ves_twin.core.budget import Budget
from ves_twin.core.recording.recording import POSES
from ves_twin.diagnosis.bank.rungs import FEWER
from ves_twin.diagnosis.build_up.result import UNFINISHED
from ves_twin.diagnosis.decide import ONE_BY_ONE
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.model.forward import Excitation, Hypothesis
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.report.diagnosis.answer import headline
from ves_twin.report.diagnosis.basis import basis_sentences

PLANT = Toy().without("ripple")
HIDDEN = {"friction.size": 0.3, "drift.size": 0.4, "lag.size": 0.3}
FOUR = replace(QUICK, causes=4, nulls=60)


def measured(seed: int, hidden=HIDDEN, ripple: float = 0.05):
    """A record with causes and with a background that the library lacks."""
    fed = programme(seed)
    rng = np.random.default_rng(seed)
    background = ripple * shape("ripple", fed.drive["drive.u"][:, 0], fed.time)
    return record(rng, hidden, fed=fed, added=background, plant=PLANT)


def named(verdict):
    return {cause.effect for cause in verdict.causes}


@pytest.mark.slow
def test_three_causes_are_part_of_it_where_a_background_stays():
    verdict = diagnose(PLANT, [measured(1)], held_out=[measured(2)], settings=FOUR)
    assert verdict.verdict is Kind.PARTIAL
    assert named(verdict) == {"friction", "drift", "lag"}
    for cause in verdict.causes:
        ((name, estimate),) = cause.parameters.items()
        # a background of 0.05 that no parameter has bends sizes by a few per cent
        assert estimate.value == pytest.approx(HIDDEN[name], rel=0.1)
    assert verdict.gain.low > 0.5
    before, after = verdict.gain.errors["out.0"]
    assert after < 0.5 * before


@pytest.mark.slow
def test_a_cause_that_held_out_recordings_do_not_show_is_not_named():
    once = measured(1)
    other = measured(2, {k: v for k, v in HIDDEN.items() if k != "lag.size"})
    verdict = diagnose(PLANT, [once], held_out=[other], settings=FOUR)
    assert "lag" not in named(verdict)


@pytest.mark.slow
def test_without_held_out_recordings_stretches_of_the_record_itself_prove():
    verdict = diagnose(PLANT, [measured(1)], settings=FOUR)
    assert verdict.basis.held_out == "split"
    assert verdict.verdict is Kind.PARTIAL
    assert {"friction", "lag"} <= named(verdict)
    assert any("cut into stretches" in said for said in basis_sentences(verdict))


@pytest.mark.slow
def test_where_no_more_than_two_causes_are_asked_for_nothing_is_built_up():
    verdict = diagnose(PLANT, [measured(1)], held_out=[measured(2)], settings=QUICK)
    assert verdict.put_to_proof is None
    assert verdict.proved == ()


def test_shapes_of_many_terms_enter_the_bank_one_at_a_time():
    shapes = Hypothesis("drift", "here", tuple("abcd"), (0.01,) * 4, (1.0,) * 4)
    departures = shapes.departures()
    assert departures.shape == (24, 4)
    assert np.all(np.count_nonzero(departures, axis=1) == 1)


def test_poses_at_rest_keep_every_row_and_have_noise_without_memory():
    fed = programme()
    uneven = np.sort(np.random.default_rng(0).choice(1000, 40, replace=False)).astype(float)
    poses = replace(
        record(np.random.default_rng(1)),
        time=uneven,
        signals={n: v[:40] for n, v in record(np.random.default_rng(1)).signals.items()},
    )
    poses = replace(poses, info=replace(poses.info, log=POSES))
    still = Excitation.of(poses, ("drive.u",))
    assert still.poses
    assert still.identity != Excitation("", uneven, still.drive).identity
    runs = Runs(Toy(), (still,), (0, 1))
    whitening = whitening_declared(runs)
    rows = np.random.default_rng(2).standard_normal((40, 2)).astype(np.float32)
    assert whitening.apply(rows) == pytest.approx((rows / [0.01, 0.05]).ravel(), rel=1e-5)
    assert np.all(whitening.adapted(whitening.apply(rows)).colour == pytest.approx(0.0, abs=1e-9))
    assert np.array_equal(runs.times[0], uneven)
    assert not Excitation.of(
        replace(poses, time=np.arange(40.0), info=replace(poses.info, log="")), ("drive.u",)
    ).poses
    assert not fed.poses


def test_a_diagnosis_without_time_ends_with_a_verdict_and_says_what_it_left_out():
    hurried = replace(FOUR, minutes=1e-6)
    verdict = diagnose(PLANT, [measured(1)], held_out=[measured(2)], settings=hurried)
    assert verdict.verdict in (Kind.PARTIAL, Kind.UNKNOWN)
    assert "pairs of causes" in verdict.basis.left_out
    assert verdict.proved
    assert UNFINISHED in verdict.basis.left_out
    assert "they may be far off" in headline(verdict)
    assert FEWER in verdict.basis.left_out
    unhurried = diagnose(PLANT, [measured(1)], settings=FOUR)
    assert FEWER not in unhurried.basis.left_out
    assert verdict.statistics.effect_threshold > 0.0
    assert any("Left out to save time:" in text for text in basis_sentences(verdict))


@pytest.mark.parametrize(
    ("at", "proves"),
    [
        ("null distribution", False),
        ("fitting the tolerances", False),
        ("what each cause would change", False),
        ("choosing causes", True),
    ],
)
def test_a_diagnosis_that_is_ended_tells_what_is_known_by_then(at, proves):
    budget = Budget()

    def progress(done: float, what: str) -> None:
        if what == at:
            assert budget.end()

    once, other = [measured(1)], [measured(2)]
    verdict = diagnose(PLANT, once, held_out=other, settings=FOUR, progress=progress, budget=budget)
    assert budget.over
    assert verdict.verdict in (Kind.PARTIAL, Kind.UNKNOWN)
    assert bool(verdict.proved) is proves
    assert (UNFINISHED if proves else ONE_BY_ONE) in verdict.basis.left_out
    assert proves or verdict.causes or verdict.nearest  # what comes nearest by then
    assert any("Left out to save time" in text for text in basis_sentences(verdict))


def test_a_diagnosis_that_knows_nothing_yet_is_not_ended():
    budget = Budget()

    def progress(done: float, what: str) -> None:
        if what == "the model as it was given":
            assert not budget.end()

    verdict = diagnose(PLANT, [measured(1)], settings=QUICK, progress=progress, budget=budget)
    assert not budget.over
    assert verdict.basis.left_out == ()
