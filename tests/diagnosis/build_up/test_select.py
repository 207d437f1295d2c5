"""What is chosen for a proof: worth no less than what is hidden, and no cause in another's place."""

from dataclasses import replace

import numpy as np
import pytest
from linear import KINDS, Known, Linear, Narrow, drawn, halves

from ves_twin.diagnosis.build_up.regression import RIDGE
from ves_twin.diagnosis.build_up.select import Selector

PLANT = Linear(couplings=("sum", "difference"))


def choice_of(selector, trials):
    return selector._choice(list(trials))


@pytest.mark.parametrize("seed", range(4))
def test_a_choice_is_worth_no_less_than_what_is_hidden(seed):
    hidden = drawn(np.random.default_rng(30 + seed), 5)
    regression = halves(PLANT, hidden, 30 + seed).regression
    selector = Selector(regression)
    labels = [f"{trial.cause.label}:size" for trial in regression.trials]
    true = selector._pruned([labels.index(name) for name in hidden])
    found = choice_of(selector, selector.run())
    assert found.evidence > true.evidence - 3.0  # ln of odds of 20


@pytest.mark.parametrize("seed", range(3))
def test_what_entered_in_anothers_place_is_exchanged(seed):
    """Begun with a friction's neighbour in its place, and with one that is not there at all."""
    hidden = {"viscous@a:size": 0.6, "coulomb@b:size": 0.8, "spring@a:size": 0.9}
    regression = halves(Linear(KINDS), hidden, 40 + seed).regression
    labels = [f"{trial.cause.label}:size" for trial in regression.trials]
    wrong = [labels.index(name) for name in ("coulomb@a:size", "viscous@b:size", "drag@a:size")]
    chosen = {labels[n] for n in Selector(regression).run(wrong)}
    assert set(hidden) <= chosen
    assert len(chosen) <= len(hidden) + 1


def test_plain_errors_by_products_are_those_of_the_columns():
    regression = halves(PLANT, {"viscous@a:size": 0.6}, 3).regression
    for chosen in ([], [0], [3, 1], list(range(len(regression.trials)))[:6]):
        columns, scale = regression.design(chosen)
        half, level = regression.half, regression.level
        design = np.where(half.kept, columns / level, 0.0).reshape(len(columns), -1).T * scale
        target = np.where(half.kept, half.target / level, 0.0).ravel()
        ridge = RIDGE * np.eye(len(scale))
        shares = np.linalg.solve(design.T @ design + ridge, design.T @ target)
        left = regression.residual(chosen, shares * scale)
        direct = float(np.sum(np.log(regression.half.rms(left))))
        assert regression.plain_error(chosen) == pytest.approx(direct, abs=1e-5)


def test_what_trials_take_by_products_is_what_fits_of_their_columns_leave():
    """Under one discrepancy: chi^2, amplitudes' priors in it, with a trial and without."""
    regression = halves(PLANT, {"viscous@a:size": 0.6, "coulomb@b:size": 0.5}, 3).regression
    fit = regression.fit([2])

    def left(chosen):
        found = replace(regression).solve(chosen, fit.whitening)  # another one, without products
        whole = fit.whitening.apply(found.residual.astype(np.float32))
        return found, float(whole @ whole + found.shares @ found.shares)

    gains = regression.gains(fit, regression.rest([2]))
    for n in (0, 5, 9):
        apart, (found, after) = regression.solve([2, n], fit.whitening), left([2, n])
        assert apart.shares == pytest.approx(found.shares, rel=1e-4, abs=1e-5)
        assert gains.of(n) == pytest.approx(left([2])[1] - after, rel=1e-3, abs=1e-2)


def test_plain_gains_are_those_of_the_columns_in_the_rms_that_a_fit_leaves():
    regression = halves(PLANT, {"viscous@a:size": 0.6, "coulomb@b:size": 0.5}, 3).regression
    fit, half = regression.fit([2]), regression.half
    others = regression.rest([2])
    gains = regression.plain_gains(fit, others)
    weight = half.kept / half.rms(fit.residual)
    for n in others:
        own = (half.columns[n] * weight).reshape(regression.trials[n].width, -1)
        own = own * regression.prior[n][:, None]
        free = np.linalg.solve(
            own @ own.T + np.eye(len(own)), own @ (fit.residual * weight).ravel()
        )
        assert gains.free(n) == pytest.approx(free, rel=1e-3, abs=1e-4)


def test_a_cause_far_beyond_its_range_is_not_chosen_in_the_place_of_another():
    """Friction of 0.6 has the columns of viscous friction, and no machine has so much of it."""
    hidden = {"viscous@a:size": 0.6}
    found = {}
    for plant in (Linear, Narrow):
        regression = halves(plant(("viscous", "twin", "offset")), hidden, 8).regression
        found[plant] = {regression.trials[n].cause.label for n in Selector(regression).run()}
    assert "viscous@a" in found[Linear]
    assert "twin@a" in found[Narrow]
    assert "viscous@a" not in found[Narrow]


def test_what_a_trial_takes_is_told_within_its_range():
    """chi^2 falls by 2 a s - a^2 m at an amplitude a of at most 0.1 in place of 0.6."""
    hidden = {"viscous@a:size": 0.6}
    taken = {}
    for plant in (Linear, Narrow):
        regression = halves(plant(("viscous", "offset")), hidden, 5).regression
        at = [trial.cause.label for trial in regression.trials].index("viscous@a")
        taken[plant] = regression.gains(regression.fit([]), [at]).of(at)
    share = 0.1 / 0.6
    assert taken[Narrow] / taken[Linear] == pytest.approx(2.0 * share - share**2, rel=0.15)


@pytest.mark.parametrize("seed", range(3))
def test_a_cause_is_chosen_in_the_place_of_its_own_tolerance_many_sd_off(seed):
    """Both have one column: the tolerance of 0.05 leaves as little at 12 sd as the cause at 0.6."""
    hidden = {"viscous@a:size": 0.6, "coulomb@b:size": 0.8}
    regression = halves(Known(("viscous", "coulomb", "offset")), hidden, 60 + seed).regression
    found = {regression.trials[n].cause.label for n in Selector(regression).run()}
    assert found == {"viscous@a", "coulomb@b"}
