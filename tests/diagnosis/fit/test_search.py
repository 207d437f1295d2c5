"""The search, where answers hold chance, and the step of integration is worth another trace."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from toy import NUISANCES, QUICK, SD, Toy, programme, record, shape

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.bank.linearise import STEP_SD, linearise
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.fit.refine import refine, residual_about
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import LEVEL_RANGE, whitening_declared
from ves_twin.diagnosis.verdict.verdict import Kind

CHANCE = 0.02
"""Offset that the plant below answers with by chance: two sd of its first channel's noise."""


class Zeroed(Toy):
    """It is zeroed before each run, and friction happened to hold something else each time."""

    def simulate(self, programme, values, refined=False):
        rows = super().simulate(programme, values, refined)
        luck = np.sin(1e7 * values.get("plant.slope", 0.0))
        return rows + CHANCE * luck * np.array([1.0, 0.3])


def zeroed(additive: bool) -> Zeroed:
    return Zeroed(nuisances=(*NUISANCES[:2], replace(NUISANCES[2], additive=additive)))


@pytest.mark.parametrize("slope", [-0.11, 0.03, 0.08])
def test_what_only_adds_is_solved_for_and_its_chance_does_not_end_a_search(slope):
    fed, plant = programme(), zeroed(additive=True)
    runs = Runs(plant, (fed,), (0, 1))
    rows = plant.simulate(fed, {"plant.slope": slope, "plant.gain": 1.03})
    rows = rows + np.random.default_rng(2).standard_normal(rows.shape) * SD
    evidence = Evidence(runs, rows.astype(np.float32), whitening_declared(runs))
    fit = refine(evidence, (), runs.origin, linearise(runs, runs.origin))
    names = [axis.parameter.name for axis in runs.coordinates]
    found = fit.shift[names.index("plant.slope")]
    sd = np.sqrt(fit.posterior[names.index("plant.slope"), names.index("plant.slope")])
    assert abs(found - slope) < 4.0 * sd
    # chi^2 of as many samples has an sd of 56; chance left in would add thousands
    assert fit.chi2 < len(fit.residual) + 4.0 * np.sqrt(2.0 * len(fit.residual))


@dataclass(frozen=True)
class Stepped(Toy):
    """Its integration error is large, and another trace three sd of the slope away."""

    def simulate(self, programme, values, refined=False):
        rows = super().simulate(programme, values, refined)
        turn = 5.0 * values.get("plant.slope", 0.0)
        u, time = programme.drive["drive.u"][:, 0], programme.time
        one, other = shape("ripple", u, time), shape("bump", u, time)
        error = 0.5 * (np.cos(turn) * one + np.sin(turn) * other)
        return rows + (0.5 if refined else 1.0) * error


def test_a_record_is_carried_back_with_the_step_that_it_has_where_it_was_fitted():
    fed, plant = programme(), Stepped()
    runs = Runs(plant, (fed,), (0, 1))
    true = {"plant.slope": 0.15, "plant.gain": 1.02}
    rows = plant.simulate(fed, true, refined=True)
    rows = rows + np.random.default_rng(4).standard_normal(rows.shape) * SD
    evidence = Evidence(runs, rows.astype(np.float32), whitening_declared(runs))
    base = linearise(runs, runs.origin)
    fit = refine(evidence, (), runs.origin, base)
    assert fit.step_share == pytest.approx(1.0 / STEP_SD, abs=0.05)  # half the step: all of it
    left = Metric(evidence.whitening.apply(base.columns).T).project(
        residual_about(evidence, fit, base)
    )
    n = len(left)
    assert left @ left < n + 4.0 * np.sqrt(2.0 * n)


@dataclass(frozen=True)
class Standing(Toy):
    """Its forces tell nothing in the first second."""

    settling: float = 1.0

    @property
    def channels(self):
        return tuple(replace(channel, settling=self.settling) for channel in super().channels)


def test_rows_of_a_rig_that_has_not_settled_tell_nothing():
    fed = programme()
    kick = np.where(fed.time < 0.6, 20.0, 0.0)[:, None] * np.array(SD)
    kicked = record(np.random.default_rng(6), plant=Standing(), added=kick)
    assert diagnose(Standing(), [kicked], settings=QUICK).verdict is Kind.NOTHING
    assert diagnose(Standing(settling=0.0), [kicked], settings=QUICK).verdict is not Kind.NOTHING


def test_settling_takes_a_fifth_of_a_recording_at_most():
    kept = record(np.random.default_rng(6), plant=Standing())
    runs = preprocess(Standing(settling=60.0), [kept]).runs
    assert np.mean(runs.holes[0]) == pytest.approx(0.2, abs=0.01)


def test_the_floor_of_mean_z2_is_one_or_what_a_quiet_channel_leaves():
    runs = Runs(Toy(), (programme(),), (0, 1))
    declared = whitening_declared(runs)
    noise = declared.draw(np.random.default_rng(7), 1.0, 0.0)
    assert declared.floor(declared.apply(noise)) == 1.0
    quiet = noise * np.array([0.1, 1.0], np.float32)
    own = declared.adapted(declared.apply(quiet))
    z = own.apply(quiet)
    # a hundredth of the power, of which the level may follow down to LEVEL_RANGE
    expected = 0.5 * (1.0 + 0.01 / LEVEL_RANGE[0])
    assert own.floor(z) == pytest.approx(expected, abs=0.005)
    # four sd of the other channel's mean of 800 squares
    assert np.mean(z**2) == pytest.approx(expected, abs=4.0 * 0.5 * np.sqrt(2.0 / 800.0))


class Fragile(Toy):
    """It fails beyond a slope: there are no channels there."""

    def simulate(self, programme, values, refined=False):
        rows = super().simulate(programme, values, refined)
        return np.full_like(rows, np.nan) if values.get("plant.slope", 0.0) > 0.02 else rows


def test_a_plant_that_fails_to_one_side_is_fitted_from_the_other():
    fed, plant = programme(), Fragile()
    runs = Runs(plant, (fed,), (0, 1))
    base, sound = linearise(runs, runs.origin), linearise(Runs(Toy(), (fed,), (0, 1)), runs.origin)
    # the toy is linear: one side tells as much as both, but for single precision
    np.testing.assert_allclose(base.columns, sound.columns, rtol=1e-3, atol=1e-5)
    rows = plant.simulate(fed, {"plant.slope": 0.015, "friction.size": 0.05})
    rows = rows + np.random.default_rng(4).standard_normal(rows.shape) * SD
    evidence = Evidence(runs, rows.astype(np.float32), whitening_declared(runs))
    friction = next(h for h in plant.hypotheses if h.effect == "friction")
    fit = refine(evidence, (friction,), runs.origin, base)
    assert np.isfinite(fit.chi2)
    assert abs(fit.sizes[0] - 0.05) < 4.0 * np.sqrt(fit.covariance[0, 0])


def test_a_plant_that_fails_at_its_nominal_numbers_is_told_as_such():
    class Broken(Toy):
        def simulate(self, programme, values, refined=False):
            return np.full_like(super().simulate(programme, values, refined), np.nan)

    with pytest.raises(InvalidInputError, match="nominal plant"):
        build_bank(Runs(Broken(), (programme(),), (0, 1)))


class Bent(Toy):
    """Its offset, which each recording has of its own, also bends the answer."""

    def simulate(self, programme, values, refined=False):
        rows = super().simulate(programme, values, refined)
        offset = values.get("plant.offset", 0.0)
        u, time = programme.drive["drive.u"][:, 0], programme.time
        return rows + 20.0 * offset**2 * shape("bump", u, time)


def test_columns_of_one_recording_stay_nothing_in_the_others_however_often_they_are_turned():
    """A whole secant wrote what one piece of a log surprised by into the starts of all others."""
    plant, two = Bent(), (programme(1), programme(2))
    runs = Runs(plant, two, (0, 1))
    rng, true = np.random.default_rng(5), (0.12, -0.1)
    rows = [
        plant.simulate(fed, {"plant.offset": offset}) for fed, offset in zip(two, true, strict=True)
    ]
    rows = np.concatenate([part + rng.standard_normal(part.shape) * SD for part in rows])
    evidence = Evidence(runs, rows.astype(np.float32), whitening_declared(runs))
    base = linearise(runs, runs.origin)
    base = replace(base, bends=np.ones_like(base.bends))
    fit = refine(evidence, (), runs.origin, base)
    own = [n for n, i in enumerate(runs.nuisances) if runs.coordinates[int(i)].recording >= 0]
    assert len(own) == 2
    for n, (here, there) in zip(own, (runs.slices, runs.slices[::-1]), strict=True):
        assert not np.any(fit.local.columns[n][there])
        assert np.any(fit.local.columns[n][here] != base.columns[n][here])
    assert fit.shift[runs.nuisances[own]] == pytest.approx(true, abs=0.01)
