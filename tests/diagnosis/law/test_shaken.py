"""Tests of names that a law at their place shakes."""

from dataclasses import replace

import pytest

from ves_twin.diagnosis.build_up.result import Proved
from ves_twin.diagnosis.law.result import LawFinding
from ves_twin.diagnosis.law.shaken import none_beside, shaken
from ves_twin.diagnosis.unseen.gain import Gain

CLEAR = Gain(0.04, 0.02, 0.07, 160.0, 154.0)

LAW = LawFinding(
    claimed=False,
    reason="it takes only 4 % of the held-out excess away",
    place="slide",
    kind="effort",
    of=("position@slide within 0.0014",),
    units=("m", "N"),
    shape="table",
    form="",
    numbers=(),
    knots=((-1.0, 1.0),),
    values=(1.0, -1.0),
    band=(),
    seen=((-1.0, 1.0),),
    points=(),
    transient=False,
    nats=26.0,
    misfit=9.0,
    misfit_limit=5.0,
    further=0.0,
    also=(),
    gain=CLEAR,
    part=True,
)


def spring(before: float, after: float) -> Proved:
    takes = {"force": (before, after)}
    return Proved("cubic_spring", "slide", {}, 1e-6, 20, takes, True)


@pytest.mark.parametrize(
    ("law", "one", "firm"),
    [
        (LAW, spring(9.0, 8.7), False),  # hysteresis, of which the spring takes a little
        (LAW, spring(90.0, 8.7), True),  # a spring that is there, beside a small law
        (replace(LAW, place="swing"), spring(9.0, 8.7), True),
        (replace(LAW, place="swing + slide"), spring(9.0, 8.7), False),
        (replace(LAW, gain=replace(CLEAR, low=-0.01)), spring(9.0, 8.7), True),
        (replace(LAW, gain=None), spring(9.0, 8.7), True),
        (replace(LAW, part=False), spring(9.0, 8.7), True),
        (None, spring(9.0, 8.7), True),
    ],
)
def test_a_law_at_its_place_shakes_a_name_that_takes_little_more(law, one, firm):
    (told,) = shaken((one,), law)
    assert told == replace(one, firm=firm)


@pytest.mark.parametrize("law", [LAW, replace(LAW, place="swing")])
def test_a_name_that_may_be_none_beside_a_law_is_not_firm(law):
    """Drag of a measured arm was -6 to 34 N m s^2/rad^2 beside a law of that joint's speed."""
    one = spring(90.0, 8.7)
    assert shaken((one,), law, ["viscous_friction@slide"]) == (one,)
    assert shaken((one,), law, [one.label]) == (replace(one, firm=False),)


@pytest.mark.parametrize(
    ("ends", "given", "none"),
    [((-6.3, 33.7), 0.0, True), ((9.0, 12.0), 0.0, False), ((9.0, 12.0), 10.0, True)],
)
def test_what_may_be_none_is_what_holds_the_number_of_the_model_as_given(ends, given, none):
    """Not the size that was fitted without the law, which every interval about it holds."""
    one = spring(90.0, 8.7)
    name = f"{one.label}:stiffness"
    found = none_beside((one,), {name: ends, "body_mass@x:mass": (0.0, 1.0)}, {name: given})
    assert found == ([one.label] if none else [])
