"""Laws fitted to simulated pendulums: numbers, bands, evidence, and labels that stay apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pendulum import FED, MACHINE, SDS, TORQUE, fed

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.fit.refine import Fit, refine
from ves_twin.diagnosis.law.band import band_of_form
from ves_twin.diagnosis.law.candidate import Candidate, Closed, Table, matern
from ves_twin.diagnosis.law.contact import Hold, Play
from ves_twin.diagnosis.law.fit_law import LawFit, ended, fit_law
from ves_twin.diagnosis.law.forms import (
    CUBE,
    DEAD_ZONE,
    FORMS,
    LIMITED,
    LINEAR,
    SIGNED_SQUARE,
    TONE,
)
from ves_twin.diagnosis.law.propose import Limits, resolved, search_laws
from ves_twin.diagnosis.law.screen import law_screen, ranges, smooth_candidates
from ves_twin.diagnosis.law.smoothness import smoothest
from ves_twin.diagnosis.law.with_law import WithLaw
from ves_twin.diagnosis.model.law_forward import LawForward, Variable
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.unseen.held_out_gain import held_out_gain
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.machines.mjcf.motion.forward import MjcfForward

FORWARD = MjcfForward.of(MACHINE)
JOINT, ANGLE, RATE = FORWARD.law_places()
DRAG = 0.004
"""N m s^2/rad^2, some 40 sigma."""

BENT = 0.02
"""What columns where nothing departs may differ by from those at a fit: they bend."""


def square(x: np.ndarray) -> np.ndarray:
    return -DRAG * np.abs(x) * x


def dragged() -> tuple[Evidence, LawFit]:
    """A pendulum with drag in the square of speed, and commissioning errors fitted alone."""
    return hidden("speed@joint", square)


@cache
def hidden(
    of: str, curve: Callable[[np.ndarray], np.ndarray], rows: int = len(TORQUE)
) -> tuple[Evidence, LawFit]:
    """A pendulum with a curve, and commissioning errors fitted alone."""
    programme = fed(TORQUE[:rows, 0])
    x = np.linspace(-12.0, 12.0, 8001)
    knots, values = (tuple(x.tolist()),), tuple(curve(x).tolist())
    law = Law("joint", LawKind.EFFORT, LawShape.TABLE, (of,), knots, values)
    rows = FORWARD.simulate(programme, {"body_mass@link:mass": 1.004}, False, (law,))
    rows = rows + np.random.default_rng(3).standard_normal(rows.shape) * SDS
    signals = {"joint.angle": rows[:, :1], "joint.rate": rows[:, 1:], **programme.drive}
    recording = Recording(programme.time, signals, RecordingInfo("measured", scenario="dragged"))
    seen = preprocess(FORWARD, [recording])
    evidence = Evidence(seen.runs, seen.measured, whitening_declared(seen.runs))
    base = linearise(seen.runs, seen.runs.origin, forward_step=1.0)
    alone = refine(evidence, (), seen.runs.origin, base, 2)
    return evidence, fit_law(evidence, None, alone)


def speed() -> Variable:
    return next(v for v in JOINT.variables if v.what == "speed")


def test_the_pendulum_is_a_plant_with_places_for_laws():
    assert isinstance(FORWARD, LawForward)
    assert [p.name for p in (JOINT, ANGLE, RATE)] == ["joint", "joint.angle", "joint.rate"]
    names = {"position@joint", "speed@joint", "time", "command@drive"}
    assert all({v.name for v in place.variables} == names for place in (JOINT, ANGLE, RATE))


def test_the_screen_puts_the_true_place_and_variable_first():
    evidence, none = dragged()
    ends = ranges(FORWARD, none)
    single = [c for c in smooth_candidates([JOINT, RATE], ends) if isinstance(c, Table)]
    first = law_screen(evidence, single, none)[0].candidate
    assert first.label == "joint(speed@joint)"


def test_a_closed_form_comes_back_with_its_number_within_its_band():
    evidence, none = dragged()
    ends = ranges(FORWARD, none)["speed@joint"]
    fit = fit_law(evidence, Closed(JOINT, (speed(),), (SIGNED_SQUARE,), ((),), ends), none.fit)
    sd = float(np.sqrt(fit.fit.covariance[0, 0]))
    assert abs(fit.numbers[0] + DRAG) < 4.0 * sd
    assert sd < 0.05 * DRAG
    assert fit.log_evidence > none.log_evidence + 100.0
    assert fit.fit.chi2 < 1.2 * len(fit.fit.residual)
    assert fit.fit.pull < 4.0


def test_a_table_follows_the_truth_within_its_band_and_a_form_of_one_number_beats_it():
    evidence, none = dragged()
    ends = ranges(FORWARD, none)
    tables = [c for c in smooth_candidates([JOINT], ends) if c.label == "joint(speed@joint)"]
    table = fit_law(evidence, tables[0], none.fit)
    assert isinstance(table.candidate, Table)
    knots = np.array(table.candidate.knots)
    off = table.numbers - square(knots)
    within = np.abs(off) < 3.0 * np.sqrt(np.diag(table.fit.covariance))
    assert np.mean(within) > 0.8
    assert np.std(off) < 0.1 * np.std(square(knots))
    closed = Closed(JOINT, (speed(),), (SIGNED_SQUARE,), ((),), ends["speed@joint"])
    assert fit_law(evidence, closed, none.fit).log_evidence > table.log_evidence


@pytest.mark.parametrize("forms", [(SIGNED_SQUARE,), (LINEAR, CUBE)], ids=["true", "near"])
def test_the_band_of_a_form_holds_the_truth_where_the_form_only_comes_near(forms):
    evidence, none = dragged()
    ends = ranges(FORWARD, none)["speed@joint"]
    fit = fit_law(evidence, Closed(JOINT, (speed(),), forms, ((),) * len(forms), ends), none.fit)
    assert fit.candidate is not None
    at = np.linspace(*ends, 61)
    low, high = band_of_form(evidence, fit, at, 0.9)
    law, truth = fit.candidate.law(fit.numbers).at(at), square(at)
    shift = np.mean(law - truth)
    assert np.mean((truth + shift >= low) & (truth + shift <= high)) > 0.8
    assert np.median(high - low) < 0.2 * np.std(truth)
    assert np.all((law >= low) & (law <= high))


def ripple(x: np.ndarray) -> np.ndarray:
    return 0.02 * np.sin(16.0 * x + 1.0)


@pytest.mark.slow
def test_a_table_gets_the_knots_that_a_ripple_asks_for():
    evidence, none = hidden("position@joint", ripple)
    ends = ranges(FORWARD, none)
    tables = [c for c in smooth_candidates([JOINT], ends) if c.label == "joint(position@joint)"]
    coarse = fit_law(evidence, tables[0], none.fit)
    fine = resolved(evidence, coarse)
    assert fine.count > 1.9 * coarse.count
    x = np.linspace(0.9 * ends["position@joint"][0], 0.9 * ends["position@joint"][1], 400)
    off = [
        np.std(fit.candidate.law(fit.numbers).at(x) - ripple(x)) / np.std(ripple(x))
        for fit in (coarse, fine)
        if fit.candidate is not None
    ]
    assert off[1] < 0.25 < off[0]
    drag = fit_law(*dragged_table())
    assert resolved(dragged()[0], drag) is drag


def dragged_table() -> tuple[Evidence, Candidate, Fit]:
    evidence, none = dragged()
    ends = ranges(FORWARD, none)
    tables = [c for c in smooth_candidates([JOINT], ends) if c.label == "joint(speed@joint)"]
    return evidence, tables[0], none.fit


def test_evidence_of_a_smooth_prior_is_the_gaussian_integral():
    """log N(z; 0, I + Z K Z') - log N(z; 0, I), by the definition."""
    rng = np.random.default_rng(2)
    columns, z = rng.standard_normal((40, 7)), rng.standard_normal(40) * 2.0
    table = Table(JOINT, (speed(),), tuple(np.linspace(-1.0, 1.0, 7).tolist()))
    none = np.zeros((40, 1))
    found = smoothest(columns, none, z, 1.0, table)
    cover = np.eye(40) + columns @ (found.size**2 * table.kernels[found.length]) @ columns.T
    wanted = -0.5 * (z @ np.linalg.solve(cover, z) - z @ z + np.linalg.slogdet(cover)[1])
    assert_allclose(found.gain, wanted, rtol=1e-6)


@pytest.mark.parametrize("length", [0.08, 0.25, 0.8])
def test_correlations_of_a_smooth_prior_are_positive_definite(length):
    values = np.linalg.eigvalsh(matern(np.linspace(-3.0, 5.0, 25), length))
    assert values.min() > 0.0


@pytest.mark.parametrize("variable", list(FORMS))
def test_every_closed_form_is_finite_over_its_range_and_written_with_its_numbers(variable):
    span = (0.0, 4.0) if variable == "time" else (-3.0, 5.0)
    of = next(v for v in JOINT.variables if v.what == variable)
    for form in (*FORMS[variable], TONE):
        wide = span[1] - span[0]
        shares = form.starts[0] if form is not TONE else (9.0 / wide, 0.5 / wide)
        inner = tuple((span[0] if form.relative else 0.0) + s * wide for s in shares)
        law = Closed(JOINT, (of,), (form,), (inner,), span).law(np.array([2.0, *inner]))
        assert np.all(np.isfinite(law.values))
        assert np.all(np.diff(law.knots[0]) > 0.0)
        x = np.linspace(*span, 50)
        exact = 2.0 * form.at(x, wide, *inner)
        assert_allclose(law.at(x), exact, atol=0.02 * np.max(np.abs(exact)) + 1e-12)
        assert law.form.startswith("2")
        assert "p" not in law.form.replace("exp", "").replace("step", "")


def test_what_a_dead_zone_lets_through_and_what_it_keeps_are_all_of_a_command():
    x = np.linspace(-2.0, 2.0, 41)
    through, kept = (form.at(x, 4.0, 0.3) for form in (DEAD_ZONE, LIMITED))
    assert_allclose(through + kept, x)
    assert_allclose(through[np.abs(x) <= 0.3], 0.0)
    assert np.max(kept) == 0.3
    assert {DEAD_ZONE, LIMITED} <= {*FORMS["command"]}


def test_laws_of_one_label_cannot_be_told_apart_and_are_refused():
    twice = (Play(ANGLE, ()), Play(ANGLE, ()))
    with pytest.raises(InvalidInputError, match="labels"):
        WithLaw(FORWARD, twice)
    assert len(WithLaw(FORWARD, (Play(ANGLE, ()), Hold(ANGLE, (), 3))).hypotheses) == 2


def test_a_law_whose_numbers_are_zero_leaves_the_plant_as_it_is():
    table = replace(Table(JOINT, (speed(),), (-5.0, 0.0, 5.0)))
    rows = WithLaw(FORWARD, (table,)).simulate(FED, {})
    assert_allclose(rows, FORWARD.simulate(FED, {}), atol=1e-12)


@pytest.mark.parametrize("samples", [400, 15_000])
def test_a_fit_goes_on_while_chi_2_falls_by_nats_however_long_the_record(samples: int):
    """Of VES II fits of one law from two starts once ended 85 nats apart, each in the noise."""
    assert not ended(5.0, 1.02 * samples, samples)
    assert ended(0.5, samples, samples)
    assert ended(5.0, 1e6 + samples, samples)  # far off, another noise is learnt first


def test_columns_known_without_a_law_serve_for_what_it_is_worth_on_other_recordings():
    evidence, alone = dragged()
    form = Closed(JOINT, (speed(),), (SIGNED_SQUARE,), ((),), (-7.0, 7.0))
    law = fit_law(evidence, form, alone.fit)
    runs = replace(evidence.runs, forward=law.fit.local.runs.forward)
    asked = runs, evidence.measured, evidence.whitening, alone.fit, law.fit
    base = linearise(evidence.runs, evidence.runs.origin)
    exact, known = held_out_gain(*asked), held_out_gain(*asked, base=base)
    assert exact.share is not None
    assert exact.share > 0.9
    for name in ("share", "before", "after", "without"):
        assert_allclose(getattr(known, name), getattr(exact, name), rtol=BENT)


@pytest.mark.nightly
def test_a_search_says_what_it_is_doing_until_its_end():
    evidence, alone = hidden("speed@joint", square, 700)  # its stages, not what it finds
    told: list[str] = []
    search = search_laws(
        evidence, alone.fit, Limits(6.0, 3.8, 0.02), lambda _, what: told.append(what)
    )
    assert search is not None
    stages = list(dict.fromkeys(told))
    assert stages[0] == "screening laws"
    for first, then in (
        ("fitting laws", "memories of readings"),
        ("memories of readings", "fitting the likeliest laws again"),
        ("fitting the likeliest laws again", "adding knots"),
        ("adding knots", "closed forms"),
    ):
        assert stages.index(first) < stages.index(then)
    after = told[len(told) - told[::-1].index("closed forms") :]
    assert "fitting the likeliest laws again" in after
    assert told[-1] == "screening laws"
