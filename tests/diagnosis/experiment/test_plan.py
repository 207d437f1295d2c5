"""Plans: what they promise is what diagnoses then find, and confuse."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from toy import CAUSES, Toy, programme, record

from ves_twin.cli.plan_text import plan_text
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.experiment.aliases import _end
from ves_twin.diagnosis.experiment.plan import plan_recording
from ves_twin.diagnosis.fit.null import cached_thresholds
from ves_twin.diagnosis.model.forward import Excitation, Hypothesis
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind


@pytest.fixture(scope="module")
def settings(tmp_path_factory):
    return Settings(nulls=60, cache=tmp_path_factory.mktemp("banks"))


class Alike(Toy):
    """Late is lag with a little ripple: only large ones can be told apart."""

    def __init__(self):
        super().__init__(causes=("lag", "late", "friction"))

    @property
    def identity(self):
        return "alike"

    def simulate(self, programme, values, refined=False):
        rows = super().simulate(programme, values, refined)
        ripple = np.sin(2 * np.pi * 3.7 * programme.time)
        return rows + 0.08 * dict(values).get("late.size", 0.0) * ripple[:, None] * [1.0, 1.0]


def test_a_plan_finds_what_the_verdict_of_its_recording_says_it_found(settings):
    plan = plan_recording(Toy(), programme(), settings=settings)
    banks = list(settings.cache.glob("bank-*"))
    v = diagnose(Toy(), [record(np.random.default_rng(1))], settings=settings)
    assert list(settings.cache.glob("bank-*")) == banks  # the plan has built the diagnosis's bank
    assert plan.threshold == v.statistics.effect_threshold
    for prospect in plan.prospects:
        told = v.smallest_findable[f"{prospect.effect}@{prospect.target}"].value
        assert prospect.smallest == pytest.approx(told, rel=0.25)  # the record's own noise level
    gain = next(p for p in plan.prospects if p.effect == "gain")
    assert gain.sd == 0.02
    assert gain.firm == pytest.approx(plan.naming_limit * 0.02)


def test_what_commissioning_errors_may_leave_counts_in_the_threshold_and_in_every_size(
    settings, monkeypatch
):
    """A score of 25 stood once above a threshold of 19 beside the word *nothing*."""
    toy = Toy()

    def told():
        seen = diagnose(toy, [record(np.random.default_rng(1))], settings=settings)
        return plan_recording(toy, programme(), settings=settings), seen

    plan, verdict = told()

    def bent(*given):
        return replace(cached_thresholds(*given), bends=0.1)

    for module in ("fit.looked", "experiment.plan"):
        monkeypatch.setattr(f"ves_twin.diagnosis.{module}.cached_thresholds", bent)
    other_plan, other = told()
    assert other.statistics.effect_threshold > 1.5 * verdict.statistics.effect_threshold
    assert other_plan.threshold > 1.5 * plan.threshold
    for label, before in verdict.smallest_findable.items():
        after = other.smallest_findable[label].value  # None: at no size any more
        assert after is None or after > before.value


def test_fewer_channels_find_less_and_a_shorter_time_too(settings):
    whole = plan_recording(Toy(), programme(), settings=settings)
    one = plan_recording(Toy(), programme(), channels=["out.0"], settings=settings)
    short = plan_recording(Toy(), programme(), seconds=3.0, quick=True, settings=settings)
    quick = plan_recording(Toy(), programme(), quick=True, settings=settings)
    sizes = {name: [p.smallest for p in plan.prospects] for name, plan in vars_of(one, whole)}
    assert one.channels == ("out.0",)
    assert next(p.smallest for p in one.prospects if p.effect == "bump") is None
    for less, more in zip(sizes["one"], sizes["whole"], strict=True):
        assert less is None or less > 0.9 * more
    assert short.seconds == pytest.approx(3.0)
    for less, more in zip(short.prospects, quick.prospects, strict=True):
        assert less.smallest is None or less.smallest > more.smallest
    assert quick.threshold <= whole.threshold


def test_a_shorter_time_of_another_rate_is_planned_on_that_rate(settings):
    fed = replace(programme(), rate=50.0)
    short = plan_recording(Toy(), fed, seconds=5.0, quick=True, settings=settings)
    assert short.seconds == pytest.approx(5.0)
    assert next(p.smallest for p in short.prospects if p.effect == "friction") is not None


def vars_of(one, whole):
    return (("one", one), ("whole", whole))


@pytest.mark.slow
def test_the_size_from_which_two_causes_are_told_apart_is_honest(settings):
    plan = plan_recording(Alike(), programme(), settings=settings)
    pair = {(p.cause, p.other): p.beyond for p in plan.lookalikes}
    beyond = pair["lag@plant", "late@plant"]
    assert beyond is not None

    def kinds(size):
        return [
            diagnose(
                Alike(),
                [record(np.random.default_rng([s, 4]), {"lag.size": size}, plant=Alike())],
                settings=settings,
            ).verdict
            for s in range(8)
        ]

    assert sum(kind is Kind.AMBIGUOUS for kind in kinds(0.5 * beyond)) >= 6
    assert sum(kind is Kind.NAMED for kind in kinds(1.6 * beyond)) >= 6


def test_same_shapes_are_told_apart_at_no_size(settings):
    plan = plan_recording(Toy(causes=("lag", "late", "friction")), programme(), settings=settings)
    assert {(p.cause, p.other, p.beyond) for p in plan.lookalikes} == {
        ("lag@plant", "late@plant", None),
        ("late@plant", "lag@plant", None),
    }
    assert "lag at plant for late at plant, at any size" in plan_text(plan)


def test_below_the_banks_smallest_size_the_models_doubt_falls_too():
    """Left and doubt are both squares of the size: the size where left overtakes the rest, by bisection."""
    rest, doubt, odds = 1e6, 4e2, 9.2  # of a size of one

    def clear(size):
        return np.sqrt(rest) * size - 0.5 - np.sqrt(0.25 + odds + doubt * size**2)

    found = _end(
        np.array([1.0, 1.5]), rest * np.array([1.0, 2.25]), doubt * np.array([1.0, 2.25]), odds
    )
    assert found == pytest.approx(brentq(clear, 1e-4, 1.0), rel=1e-6)


class Loud(Toy):
    """Friction comes in sizes of hundreds of sigma alone."""

    identity = "loud"

    @property
    def hypotheses(self):
        rest = [h for h in super().hypotheses if h.effect != "friction"]
        return (*rest, Hypothesis("friction", "plant", ("friction.size",), (0.4,), (1.0,)))


def test_a_cause_that_is_always_loud_looks_like_no_other(settings):
    plan = plan_recording(Loud(), programme(), quick=True, settings=settings)
    assert not [pair for pair in plan.lookalikes if pair.cause == "friction@plant"]


def test_standing_still_says_nothing_about_what_moves(settings):
    still = Excitation("still", programme().time, {"drive.u": 0 * programme().drive["drive.u"]})
    plan = plan_recording(Toy(), still, quick=True, settings=settings)
    lost = {p.effect for p in plan.prospects if p.smallest is None}
    assert lost == {"gain", "friction", "lag"}
    text = plan_text(plan)
    assert f"{len(CAUSES) + 1 - 3} of {len(CAUSES) + 1} causes would be found" in text
    assert "friction at plant" in text[text.index("could say nothing about") :]


def test_a_plan_is_plain_json(settings):
    plan = plan_recording(Toy(), programme(), quick=True, settings=settings)
    content = json.loads(plan.to_json())
    assert content["schema"] == 1
    assert set(content["prospects"][0]) == {
        *("effect", "target", "unit", "smallest", "sd", "firm"),
    }


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"channels": ["out.9"]}, "did you mean 'out"),
        ({"seconds": 0.2}, "seconds: got 0.2"),
        ({"seconds": 80.0}, "seconds: got 80"),
    ],
)
def test_what_cannot_be_planned_is_refused_before_anything_is_simulated(options, words):
    with pytest.raises((UnknownNameError, InvalidInputError), match=words):
        plan_recording(Toy(), programme(), quick=True, **options)
