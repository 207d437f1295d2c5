"""Tolerances as declared and as rigs in order show them: which verdict is said."""

from dataclasses import replace

import numpy as np
import pytest
from pendulum import MASS, PLANT, STEP

from ves_twin.diagnosis.build_up.result import Proved
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.model.widened import LEAST, Widened, widening
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.verdict.both_views import both_views
from ves_twin.diagnosis.verdict.cause import Cause
from ves_twin.diagnosis.verdict.refusal import refusal
from ves_twin.diagnosis.verdict.verdict import Basis, Kind, Statistics, Verdict
from ves_twin.machines.ves2.ves2_machine import Ves2Machine
from ves_twin.report.diagnosis.answer import headline

BASIS = Basis("declared", "measured", "none")
FIGURES = Statistics(1.0, 2.0, 1.0, 2.0)


def said(kind, *names, firm=True):
    causes = tuple(Cause(name, "x", {}, 1.0, firm, 9.0) for name in names)
    return Verdict(kind, BASIS, FIGURES, causes, tuple((n,) for n in range(len(causes))))


NOTHING, UNKNOWN = said(Kind.NOTHING), said(Kind.UNKNOWN)
FIRM, SOFT = said(Kind.NAMED, "a"), said(Kind.NAMED, "a", firm=False)


@pytest.mark.parametrize(
    ("declared", "measured", "expected"),
    [
        (UNKNOWN, NOTHING, "measured"),  # within the tolerances as they are
        (UNKNOWN, FIRM, "measured"),
        (FIRM, NOTHING, "declared"),  # only the tighter view is sharp enough, kappa is the same
        (SOFT, NOTHING, "declared"),  # so many declared sd off: fault or commissioning error
        (said(Kind.SEVERAL, "a", "b", firm=False), NOTHING, "measured"),
        (FIRM, said(Kind.NAMED, "b"), "measured"),
        (FIRM, said(Kind.NAMED, "b", firm=False), "measured"),
        (FIRM, said(Kind.AMBIGUOUS, "a", "b", firm=False), "declared"),
        (FIRM, said(Kind.AMBIGUOUS, "c", "b"), "measured"),
        (FIRM, UNKNOWN, "declared"),
        (SOFT, UNKNOWN, "measured"),
    ],
)
def test_which_of_two_views_is_said(declared, measured, expected):
    chosen = {"declared": declared, "measured": measured}[expected]
    assert both_views(declared, measured) is chosen


def test_a_plant_known_less_well_predicts_the_same():
    plant = PLANT
    wide = Widened(plant, 2.5)
    time = STEP * np.arange(50)
    programme = Excitation("", time, {"joint.torque": np.ones((50, 1))})
    values = {MASS: 1.1}
    assert np.array_equal(wide.simulate(programme, values), plant.simulate(programme, values))
    assert [p.sd for p in wide.parameters] == [2.5 * p.sd for p in plant.parameters]
    assert len({plant.identity, wide.identity, Widened(plant, 2.0).identity}) == 3


def test_tolerances_are_widened_on_a_ladder_and_only_where_five_rigs_can_tell():
    assert widening(None) == 1.0
    assert widening(LEAST - 0.01) == 1.0
    assert widening(2.5) == widening(2.6) == pytest.approx(2.5, rel=0.1)


def test_kinds_that_name_a_plant_are_those_that_name_causes_and_no_rivals():
    assert {kind for kind in Kind if kind.names_a_plant} == {
        Kind.NAMED,
        Kind.SEVERAL,
        Kind.PARTIAL,
    }
    assert {kind for kind in Kind if kind.names_causes and not kind.names_a_plant} == {
        Kind.AMBIGUOUS
    }


def test_an_extension_that_cannot_be_carried_on_is_a_candidate_on_every_rig():
    held = Gain(0.9, 0.8, 1.0, 2.0, 1.1)
    lost = Gain(-0.5, -0.9, -0.1, 2.0, 2.5)
    proven = replace(FIRM, gain=held)
    assert refusal(proven) == ""
    assert "not beyond their end" in refusal(replace(proven, forecast=lost))
    assert refusal(replace(proven, forecast=held)) == ""
    assert "held-out" in refusal(FIRM)
    assert "not beyond their end" in Ves2Machine().refusal(replace(proven, forecast=lost))


@pytest.mark.parametrize(
    ("errors", "grown"),
    [
        ({"q": (0.1, 0.14), "v": (0.3, 0.6)}, True),
        ({"motor.effort": (0.199, 0.263)}, True),  # the only one, by a third
        ({"motor.effort": (0.199, 0.21)}, False),  # by a twentieth
        ({"q": (0.1, 0.04), "v": (0.3, 0.6)}, False),  # made up for
        ({}, False),
    ],
)
def test_an_extension_whose_bare_errors_grow_is_a_candidate(errors, grown):
    gain = Gain(0.5, 0.4, 0.6, 4.0, 2.0, errors)
    told = "the rms errors on held-out recordings grow with it"
    assert refusal(replace(FIRM, gain=gain)) == grown * told


def test_a_size_that_may_be_none_is_named_as_such():
    cause = replace(said(Kind.NAMED, "a").causes[0], firm=False, sigmas=None)
    verdict = replace(said(Kind.NAMED, "a"), causes=(cause,))
    assert "it may be none" in verdict.words
    late = replace(verdict, causes=(replace(cause, below_row=True),))
    assert "its clock explains that as well" in late.words


def test_what_ranges_speak_against_is_a_candidate():
    sound = Gain(0.9, 0.8, 1.0, 2.0, 1.1)
    ended = Proved("body_place", "wrist.z", {}, 0.01, 8, {}, True, ended=True)
    only, beside = (replace(FIRM, gain=sound, proved=p) for p in ((ended,), (ended, PROVED)))
    assert refusal(only) == "what was fitted ends its range, and stands for something else"
    assert refusal(beside) == ""


@pytest.mark.parametrize(
    ("errors", "accepted"),
    [
        ({"a": (2.86, 2.02), "b": (5.17, 2.6)}, True),
        ({"a": (2.86, 2.9), "b": (5.17, 2.6)}, False),  # one grows
        ({"a": (2.86, 2.8), "b": (5.17, 5.0)}, False),  # next to nothing
    ],
)
def test_what_is_proved_is_accepted_where_every_bare_error_falls_whatever_z2_does(errors, accepted):
    """Of an arm every joint had 29 to 71 % less error, 16 % more of z^2, and no plant.toml."""
    gain = Gain(-0.16, -0.19, -0.13, 4.0, 4.6, errors)
    proven = replace(FIRM, gain=gain, proved=(PROVED,))
    assert (refusal(proven) == "") is accepted
    assert "not clear of zero" in refusal(replace(proven, proved=()))


PROVED = Proved("coulomb_friction", "elbow", {}, 0.001, 8, {}, True)


@pytest.mark.parametrize(
    ("kind", "begin"), [(Kind.PARTIAL, "Part of it is"), (Kind.SEVERAL, "three causes together:")]
)
def test_page_and_terminal_name_every_one_of_several_causes(kind, begin):
    verdict = said(kind, "a", "b", "c")
    assert f"{begin} a at x and b at x and c at x." in headline(verdict)
    terminal = verdict.words.lower()
    assert begin.lower() in terminal
    assert all(f"{name} at x" in terminal for name in "abc")
