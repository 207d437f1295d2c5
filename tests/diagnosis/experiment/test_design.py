"""Designed programmes: the measure by its closed form, the search against a menu."""

import json
from dataclasses import replace

import numpy as np
import pytest
from toy import SD, Toy, programme, shape

from ves_twin.cli.design_text import design_text
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.experiment import design as module
from ves_twin.diagnosis.experiment.design import design_excitation, score
from ves_twin.diagnosis.experiment.separation import Question, separation, size_of
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.settings import Settings

TIME = programme().time


class Box:
    """One sine of at most unit amplitude: how fast, how large."""

    size = 2

    def excitation(self, point, name):
        low, high = 0.2, 4.0
        tone = low * (high / low) ** (0.5 * (point[0] + 1.0))
        u = 0.5 * (point[1] + 1.0) * np.sin(2.0 * np.pi * tone * TIME)
        return Excitation(name, TIME, {"drive.u": u[:, None]})


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(module, "SCATTERED", 4)
    monkeypatch.setattr(module, "EACH", 6)


def test_a_separation_is_what_the_rival_and_the_tolerances_leave_of_a_cause():
    """By least squares over the rival's size, free, and the tolerances with their priors."""
    toy = Toy(causes=("lag", "friction"), with_gain=False)
    question = Question.of(toy, ["lag", "friction"])
    fed = programme()
    runs = Runs(toy, (fed,), (0, 1))
    apart = separation(linearise(runs, runs.origin), question)
    u = fed.drive["drive.u"][:, 0]
    sd = np.array(SD)
    lag, friction = (
        (float(size_of(c)[0]) * shape(c.effect, u, TIME) / sd).ravel() for c in question.causes
    )
    slope = np.gradient(u, TIME)[:, None]
    ones = np.ones((len(u), 1))
    known = [
        0.02 * u[:, None] * [0.3, 1.0],
        0.05 * slope * [0.05, 0.2],
        0.05 * ones * [1.0, 0.3],
    ]
    priors = np.column_stack([(column / sd).ravel() for column in known])
    rows = np.column_stack([friction, priors])
    rows = np.vstack([rows, np.column_stack([np.zeros(3), np.eye(3)])])
    aim = np.concatenate([lag, np.zeros(3)])
    rest = aim - rows @ np.linalg.lstsq(rows, aim, rcond=None)[0]
    # the whitening needs the first few of 800 rows
    assert apart[0, 1] == pytest.approx(rest @ rest, rel=0.03)


def test_a_design_tells_more_than_the_menu_and_says_after_which_time(few):
    toy = Toy(causes=("lag", "friction"))
    question = Question.of(toy, ["lag", "friction"])
    menu = [Box().excitation(np.array([-0.5, -0.5]), "slow"), programme(amplitude=0.1)]
    found = design_excitation(toy, question, menu, Box(), settings=Settings())
    assert found.designed.score > 2.0 * found.best.score
    assert 0.0 < found.after < TIME[-1]
    begin = Excitation("begin", TIME[: int(found.after / 0.01) + 1], {})
    cut = {"drive.u": found.excitation.drive["drive.u"][: len(begin.time)]}
    runs = Runs(toy, (Excitation("begin", begin.time, cut),), (0, 1))
    there = question.least(separation(linearise(runs, runs.origin), question))
    assert score(there) == pytest.approx(found.best.score, rel=0.4)
    content = json.loads(found.to_json())
    assert content["pairs"] == [["lag@plant", "friction@plant"]]
    assert content["designed"]["sigma"][0] > content["best"]["sigma"][0]


def test_the_menu_is_kept_where_nothing_tells_more(few):
    toy = Toy(causes=("lag", "friction"))
    question = Question.of(toy, ["lag", "friction"])
    loud = programme(amplitude=20.0)
    found = design_excitation(toy, question, [loud], Box(), settings=Settings())
    assert found.after is None
    assert found.designed.score < found.best.score
    assert found.begin == pytest.approx(found.best.sigma)  # both are as long
    assert "The menu's best tells more" in design_text(found)


class Half(Box):
    """The same, half as long as the menu's."""

    def excitation(self, point, name):
        whole, rows = super().excitation(point, name), len(TIME) // 2
        drive = {"drive.u": whole.drive["drive.u"][:rows]}
        return Excitation(name, TIME[:rows], drive)


def test_a_shorter_design_is_held_against_the_menu_s_best_of_its_own_length_too(few):
    toy = Toy(causes=("lag", "friction"))
    question = Question.of(toy, ["lag", "friction"])
    fed = programme(amplitude=2.0)
    found = design_excitation(toy, question, [fed], Half(), settings=Settings())
    cut = Half().excitation(np.zeros(2), "cut")
    begin = Excitation("cut", cut.time, {"drive.u": fed.drive["drive.u"][: len(cut.time)]})
    runs = Runs(toy, (begin,), (0, 1))
    alone = np.sqrt(question.least(separation(linearise(runs, runs.origin), question)))
    assert found.begin == pytest.approx(alone, rel=0.02)
    assert found.begin[0] < found.best.sigma[0]
    assert found.times == pytest.approx((found.designed.sigma[0] / found.begin[0]) ** 2)
    assert json.loads(found.to_json())["times"] == found.times
    words = design_text(replace(found, after=None))
    told = found.times > 1.0
    assert ("times as much (chi^2) as the menu's best in the same time" in words) == told


def test_what_no_programme_parts_is_refused(few):
    toy = Toy(causes=("drift", "bump"))  # of a fixed shape, whatever is fed in

    class Nothing(Box):
        def excitation(self, point, name):
            return None

    question = Question.of(toy, ["drift", "bump"])
    with pytest.raises(InvalidInputError, match="keeps the machine's limits"):
        design_excitation(toy, question, [programme()], Nothing(), settings=Settings())


def test_of_many_pairs_one_that_nothing_parts_does_not_hide_the_others():
    assert score(np.array([9.0])) == pytest.approx(9.0)
    assert score(np.array([0.0, 9.0])) > 2.0
    assert score(np.array([4.0, 4.0])) > score(np.array([1.0, 7.0]))


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (["lag", "frction"], "did you mean 'friction'"),
        (["lag"], "two different ones"),
        (["lag", "lag@plant"], "two different ones"),
    ],
)
def test_a_question_needs_two_causes_that_there_are(names, words):
    with pytest.raises((UnknownNameError, InvalidInputError), match=words):
        Question.of(Toy(), names)
