"""A record before any cause: what the screen, the misfit and the pull say, and when it exceeds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm
from toy import SD, Toy, programme

from ves_twin.diagnosis.bank.prewhitened import Prewhitened
from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.fit.assess import (
    FAR,
    GLANCE,
    STRANGE,
    _left,
    assess,
    first_look,
    pull_limit,
)
from ves_twin.diagnosis.record.adequacy import cells, misfit
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared

FED = programme(1)


@pytest.fixture(scope="module")
def bank():
    return build_bank(Runs(Toy(), (FED,), (0, 1)))


def rows(values, seed=1):
    clean = Toy().simulate(FED, values)
    noise = np.random.default_rng(seed).standard_normal(clean.shape) * SD
    return (clean + noise).astype(np.float32)


FAULTY = {"friction.size": 0.02, "plant.gain": 1.05}


@pytest.fixture(scope="module")
def look(bank):
    return first_look(rows(FAULTY), Prewhitened(bank, whitening_declared(bank.base.runs)))


def dense(look):
    """What the nuisances cannot explain, by the inverse of the whole covariance."""
    white = look.evidence.whitening.apply(look.screen.bank.base.columns).T
    return np.linalg.solve(np.eye(len(look.z)) + white @ white.T, look.z)


def test_what_is_left_and_the_misfit_are_of_the_marginalised_nuisances(look):
    left = dense(look)
    np.testing.assert_allclose(look.left, left, atol=1e-5)
    assert look.misfit == pytest.approx(misfit(cells(look.evidence.whitening, left)), rel=1e-4)


def test_the_best_hypothesis_comes_first_and_scores_what_it_takes_away(look):
    assert look.screen.bank.hypotheses[look.suspects[0].hypothesis].effect in {"friction", "gain"}
    assert look.score == look.suspects[0].score == max(s.score for s in look.suspects)
    assert replace(look, suspects=[]).score == 0.0
    # nothing takes away more than what is there
    assert look.score < look.z @ dense(look)


def test_the_pull_is_the_largest_commissioning_error_in_its_sd(look):
    runs = look.evidence.runs
    white = look.evidence.whitening.apply(look.screen.bank.base.columns).T
    every = white.T @ np.linalg.solve(np.eye(len(look.z)) + white @ white.T, look.z)
    assert look.pull == pytest.approx(np.max(np.abs(every[: len(runs.nuisances)])), rel=1e-3)
    signs = replace(look, z=-look.z)
    assert signs.pull == pytest.approx(look.pull, rel=1e-12)
    assert look.pull > 1.0  # a gain of 2.5 sd


def test_the_last_column_is_the_step_and_no_commissioning_error(bank, look):
    step = np.zeros_like(bank.base.columns)
    step[-1] = 0.5 * bank.base.columns[0]
    columns = bank.base.columns + step
    moved = replace(bank, base=replace(bank.base, columns=columns))
    first = first_look(
        (bank.base.prediction + 20.0 * columns[-1]).astype(np.float32),
        Prewhitened(moved, whitening_declared(bank.base.runs)),
    )
    every = first.screen.metric.nuisances(first.z)
    assert first.pull == np.max(np.abs(every[:-1]))


@pytest.mark.parametrize("bends", [0.0, 0.1, 0.3])
def test_a_share_of_what_commissioning_explains_may_stay(look, bends):
    some = replace(look, bends=bends)
    explained = look.z @ look.z - look.left @ look.left
    assert some.allowance == pytest.approx(bends**2 * explained, rel=1e-9)
    assert replace(some, left=2.0 * some.z).allowance == 0.0


def test_each_of_three_levels_is_enough_to_exceed(look):
    over = 1e9
    assert not look.exceeds(over, over, over)
    assert not look.exceeds(look.score, look.misfit, look.pull)
    assert look.exceeds(0.999 * look.score, over, over)
    assert look.exceeds(over, 0.999 * look.misfit, over)
    assert look.exceeds(over, over, 0.999 * look.pull)
    allowed = replace(look, bends=0.3)
    assert allowed.allowance > 0.0
    assert not allowed.exceeds(look.score - 0.999 * allowed.allowance, over, over)
    assert allowed.exceeds(look.score - 1.001 * allowed.allowance, over, over)


def test_a_record_in_order_is_looked_at_once(bank):
    whitening = whitening_declared(bank.base.runs)
    found = assess(rows({"plant.gain": 1.01}), bank, whitening, 1e6, 1e6, 1e6, bends=0.2)
    assert found.commissioning is None
    assert not found.told
    assert found.bends == 0.2
    alone = first_look(rows({"plant.gain": 1.01}), Prewhitened(bank, whitening))
    assert found.score == pytest.approx(alone.score, rel=1e-12)


@pytest.mark.parametrize("level", [(1.0, 1e6, 1e6), (1e6, 0.1, 1e6), (1e6, 1e6, 0.1)])
def test_a_record_over_any_level_is_fitted(bank, level):
    whitening = whitening_declared(bank.base.runs)
    found = assess(rows(FAULTY), bank, whitening, *level, bends=0.001)
    assert found.commissioning is not None
    assert found.commissioning.causes == ()
    assert found.bends == 0.001


def test_the_second_look_is_about_the_fit_and_has_its_own_noise(bank):
    whitening = whitening_declared(bank.base.runs)
    found = assess(3.0 * rows({}) - 2.0 * Toy().simulate(FED, {}).astype(np.float32), bank,
                   whitening, 1.0, 1.0, 1.0)  # fmt: skip
    low, high = found.evidence.whitening.level.min(), found.evidence.whitening.level.max()
    # noise of three times its declared sd; a level may follow to the root of 2.5
    assert low == high == pytest.approx(np.sqrt(2.5))


class Bent(Toy):
    """The gain bends the slope's share, and runs are counted."""

    count = 0

    def simulate(self, programme, values, refined=False):
        Bent.count += 1
        gain = values.get("plant.gain", 1.0) - 1.0
        slope = values.get("plant.slope", 0.0) * (1.0 + 200.0 * gain**2)
        return super().simulate(programme, {**values, "plant.slope": slope})


IN_ORDER = {"plant.gain": 1.06, "plant.slope": 0.15}
LIMITS = (15.0, 5.0, 4.0)


def assessed(values, added=0.0, sparse=False):
    """A record of a bent plant, and how many runs it took to assess it."""
    library = build_bank(Runs(Bent(), (FED,), (0, 1)))
    clean = Bent().simulate(FED, values)
    noise = np.random.default_rng(1).standard_normal(clean.shape) * SD
    record = (clean + noise + added).astype(np.float32)
    before = Bent.count
    noise_as_declared = whitening_declared(library.base.runs)
    found = assess(record, library, noise_as_declared, *LIMITS, sparse=sparse)
    return found, Bent.count - before


def test_a_rig_in_order_that_bends_is_known_after_a_glance():
    found, runs = assessed(IN_ORDER)
    assert found.commissioning is not None
    assert not found.exceeds(*LIMITS)
    assert runs <= 1 + 2 * 2 * GLANCE  # where it begins, and two steps of two trials each


def test_a_rig_that_a_glance_leaves_a_little_over_its_limits_is_fitted_to_the_noise():
    """No cause is tried there: one beside commissioning errors would leave them far off."""
    found, _ = assessed({"plant.gain": 1.06, "plant.slope": 0.25})
    n = len(found.commissioning.residual)
    assert found.commissioning.chi2 < n + 4.0 * np.sqrt(2.0 * n)


def test_of_many_parameters_no_new_columns_are_computed_where_noise_stays_far():
    strange = 2.0 * np.sin(2.0 * np.pi * 9.0 * FED.time)[:, None] * [1.0, -2.0]
    (whole, runs), (rough, fewer) = (assessed(IN_ORDER, strange, many) for many in (False, True))
    for found in (whole, rough):
        assert found.exceeds(*LIMITS)
        fit = found.commissioning
        assert _left(found) == fit.chi2 / len(fit.residual) > FAR
    assert fewer < runs
    assert _left(replace(whole, commissioning=None)) == 0.0


def test_of_many_parameters_what_comes_near_to_noise_is_fitted_as_of_few():
    values = {"plant.gain": 1.06, "plant.slope": 0.25}
    (few, _), (many, _) = (assessed(values, sparse=sparse) for sparse in (False, True))
    assert many.exceeds(*LIMITS) == few.exceeds(*LIMITS)
    n = len(many.commissioning.residual)
    assert many.commissioning.chi2 < n + 4.0 * np.sqrt(2.0 * n)


def test_a_loud_cause_is_taken_out_of_the_commissioning_errors_that_it_was_fitted_with():
    found, _ = assessed(IN_ORDER | {"bump.size": 0.8})
    name = found.screen.bank.hypotheses[found.suspects[0].hypothesis].effect
    assert name == "bump"
    assert found.exceeds(*LIMITS)
    fit = found.commissioning
    assert fit.causes == ()
    where = {a.parameter.name: i for i, a in enumerate(found.evidence.runs.coordinates)}
    assert fit.shift[where["bump.size"]] == 0.0
    # fitted beside the cause, to the noise of a fit: they do not mimic it
    assert fit.shift[where["plant.gain"]] == pytest.approx(0.06, abs=2e-3)
    assert found.suspects[0].sizes[0] == pytest.approx(0.8, rel=0.05)


def test_a_fit_tells_while_noise_is_most_of_what_the_best_leaves(bank):
    whitening = whitening_declared(bank.base.runs)
    found = assess(rows(FAULTY), bank, whitening, 1.0, 1e6, 1e6)
    fit = found.commissioning
    assert fit is not None
    size = len(fit.residual)
    below = replace(found, commissioning=replace(fit, chi2=found.score + 0.999 * STRANGE * size))
    above = replace(found, commissioning=replace(fit, chi2=found.score + 1.001 * STRANGE * size))
    assert below.told
    assert not above.told


@pytest.mark.parametrize("alpha", [0.01, 0.2])
def test_the_limit_of_the_pull_is_passed_by_any_error_with_alpha(bank, alpha):
    count = len(bank.base.runs.nuisances)
    assert 2.0 * count * norm.sf(pull_limit(bank, alpha)) == pytest.approx(alpha, rel=1e-9)


def test_a_cause_beside_strained_commissioning_errors_is_not_taken(bank):
    whitening = whitening_declared(bank.base.runs)
    record = rows({"friction.size": 0.3, "plant.gain": 1.05})
    taken = assess(record, bank, whitening, *LIMITS)
    assert taken.beside is not None
    assert [cause.effect for cause in taken.beside.causes] == ["friction"]
    effect, level, _ = LIMITS
    strained = assess(record, bank, whitening, effect, level, 0.9 * taken.beside.pull)
    assert strained.beside is None
