"""A record far louder than its noise: inverse dynamics finds what a linear screen cannot."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from arm import arm, motion

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.forward import Excitation
from ves_twin.diagnosis.law.candidate import Table
from ves_twin.diagnosis.law.closed import closed_forms
from ves_twin.diagnosis.law.fit_law import LawFit, fit_law
from ves_twin.diagnosis.law.loud import LOUD, loud_screen
from ves_twin.diagnosis.law.screen import ranges
from ves_twin.diagnosis.linearise import linearise
from ves_twin.diagnosis.preprocess import preprocess
from ves_twin.diagnosis.refine import refine
from ves_twin.diagnosis.whitening import whitening_declared
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.machines.mjcf.description import Mode
from ves_twin.machines.mjcf.forward import MjcfForward

DRAG = 0.6
"""N m s^2/rad^2: at chi^2 of 10^6 a sample."""


FOLDER = TemporaryDirectory()


@cache
def forward() -> MjcfForward:
    return MjcfForward.of(arm(Path(FOLDER.name), {}), Mode.CONTROL)


def drag(speed: np.ndarray) -> np.ndarray:
    return -DRAG * np.abs(speed) * speed


@cache
def looked() -> tuple[Evidence, LawFit]:
    """An arm with a drag at its second joint, and commissioning errors fitted alone."""
    time, torques = motion(8.0, 5)
    fed = Excitation("", time, {"ta": 4.0 * torques[:, :1], "tb": 4.0 * torques[:, 1:]})
    x = np.linspace(-6.0, 6.0, 6001)
    knots, values = (tuple(x.tolist()),), tuple(drag(x).tolist())
    law = Law("b", LawKind.EFFORT, LawShape.TABLE, ("speed@b",), knots, values)
    rows = forward().simulate(fed, {"rotor_inertia@a:inertia": 0.005}, False, (law,))
    rows = rows + 1e-3 * np.random.default_rng(1).standard_normal(rows.shape)
    signals = {**fed.drive, "qa": rows[:, :1], "qb": rows[:, 1:]}
    recording = Recording(time, signals, RecordingInfo("measured", scenario="dragged"))
    seen = preprocess(forward(), [recording])
    evidence = Evidence(seen.runs, seen.measured, whitening_declared(seen.runs))
    base = linearise(seen.runs, seen.runs.origin, forward_step=1.0)
    alone = refine(evidence, (), seen.runs.origin, base, 2)
    return evidence, fit_law(evidence, None, alone)


def test_inverse_dynamics_puts_place_and_variable_first_and_knows_the_law():
    evidence, none = looked()
    assert none.temper > 10.0 * LOUD
    first, second = loud_screen(evidence, none, forward().law_places())[:2]
    assert first.candidate.label == "b(speed@b)"
    assert first.gain > second.gain + 10.0
    assert isinstance(first.candidate, Table)
    found = first.candidate.law(first.numbers)
    speed = np.linspace(*np.array(first.candidate.knots)[[2, -3]], 50)
    assert np.std(found.at(speed) - drag(speed)) < 0.1 * np.std(drag(speed))


@cache
def fitted() -> LawFit:
    evidence, none = looked()
    first = loud_screen(evidence, none, forward().law_places())[0]
    unstrained = replace(none.fit, shift=np.zeros_like(none.fit.shift))
    return fit_law(evidence, first.candidate, unstrained, first.numbers)


def test_the_fit_from_there_ends_in_the_noise():
    assert fitted().temper < 1.3  # a table's lines between its knots are seen at such loudness


@pytest.mark.nightly
def test_the_closed_form_is_fitted_from_its_share_of_the_table():
    evidence, _ = looked()
    found = closed_forms(evidence, fitted(), ranges(forward(), fitted()))
    drags = {fit.candidate.label: fit for fit in found if fit.candidate is not None}
    alone = drags["b(speed@b): square against motion"]
    ended = fit_law(evidence, alone.candidate, alone.fit, alone.numbers)  # as the leaders are
    assert ended.temper < 1.1
    assert ended.numbers[0] == pytest.approx(-DRAG, rel=1e-3)


def test_a_quiet_record_is_left_to_the_linear_screen():
    evidence, none = looked()
    quiet = Evidence(evidence.runs, none.fit.prediction, evidence.whitening)
    assert loud_screen(quiet, fit_law(quiet, None, none.fit), forward().law_places()) == []
