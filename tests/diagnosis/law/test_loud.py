"""A record far louder than its noise: inverse dynamics finds what a linear screen cannot."""

from __future__ import annotations

import numpy as np
import pytest
from dragged_arm import DRAG, drag, fitted, forward, looked

from ves_twin.diagnosis.law.candidate import Table
from ves_twin.diagnosis.law.closed import closed_forms
from ves_twin.diagnosis.law.fit_law import fit_law
from ves_twin.diagnosis.law.loud import LOUD, loud_screen
from ves_twin.diagnosis.law.screen import ranges
from ves_twin.diagnosis.record.evidence import Evidence


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
