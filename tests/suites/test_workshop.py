"""Blind suites of many causes at once: what model error is, what is hidden, how names are counted."""

from pathlib import Path

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.files import load_recording
from ves_twin.diagnosis.record.runs import silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.suites.answer import answer_suite
from ves_twin.suites.answers import Answer
from ves_twin.suites.draw import MANY, MANY_DETECTABILITY
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.machines import machine_of
from ves_twin.suites.make import make_suite
from ves_twin.suites.model_error import OUTSIDE, Family, ModelError, everywhere
from ves_twin.suites.recipe import Recipe
from ves_twin.suites.score import read_truths, score
from ves_twin.suites.score_gain import score_gain
from ves_twin.suites.suite import RECORDING
from ves_twin.suites.truth import Hidden, HiddenCause, Truth

FILES = Path(__file__).parents[2] / "benchmarks" / "workshop"
MACHINES = ("arm", "drive_train")

SMALL = """
[[effects]]
kind = "{}"
on = ["joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6"]
"""


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """The arm with three kinds of causes, excited half as long."""
    folder = tmp_path_factory.mktemp("arm")
    text = (FILES / "arm.toml").read_text().replace('duration = "12 s"', 'duration = "6 s"')
    kinds = ("viscous_friction", "coulomb_friction", "joint_spring")
    text = text[: text.index("[[effects]]")] + "".join(map(SMALL.format, kinds))
    (folder / "arm.xml").write_text((FILES / "arm.xml").read_text())
    (folder / "arm.toml").write_text(text)
    return str(folder / "arm.toml")


@pytest.fixture(scope="module")
def suite(arm, tmp_path_factory):
    folder = tmp_path_factory.mktemp("workshop") / "suite"
    recipe = Recipe(arm, {Hidden.MANY: 1, Hidden.NONE: 1}, 7, model_error=0.03)
    make_suite(recipe, folder, folder.with_name("key"), silent)
    return folder, read_truths(folder, folder.with_name("key").read_text().strip())


def test_coloured_error_has_its_size_and_memory_and_is_new_in_each_recording():
    error, rng = ModelError(Family.COLOURED, 0, 0.5, memory=0.2), np.random.default_rng(1)
    one, two = (error.rows(np.zeros((200_000, 1)), 0.01, rng) for _ in range(2))
    assert np.std(one) == pytest.approx(0.5, rel=0.03)
    assert np.mean(one[20:] * one[:-20]) / np.var(one) == pytest.approx(np.exp(-1.0), abs=0.03)
    assert abs(np.mean(one * two)) < 0.03 * np.var(one)


def test_a_law_is_the_same_function_in_each_recording_and_another_one_for_each_seed():
    motion = 1.5 * np.random.default_rng(2).standard_normal((50_000, 4))
    laws = [ModelError(Family.LAW, 0, 0.5, seed=seed) for seed in range(12)]
    rows = [law.rows(motion, 0.01, np.random.default_rng(k)) for k, law in enumerate(laws)]
    again = laws[3].rows(motion[:100], 0.01, np.random.default_rng(99))
    assert np.array_equal(again, rows[3][:100])
    assert np.sqrt(np.mean(np.square(rows))) == pytest.approx(0.5, rel=0.1)
    assert np.max(np.abs(np.corrcoef(rows) - np.eye(12))) < 0.5


@pytest.mark.parametrize("name", MACHINES)
def test_model_error_of_a_machine_is_a_share_of_each_column(name):
    machine = machine_of(str(FILES / f"{name}.toml"))
    plain = machine.record(BlindRig(), "train", np.random.default_rng(0))
    columns = [plain[c.signal][:, c.column] for c in machine.forward.channels]
    levels = np.array([np.sqrt(np.mean(np.square(column))) for column in columns])
    rig = BlindRig(errors=everywhere(0.1, levels, np.random.default_rng(1)))
    odd = machine.record(rig, "train", np.random.default_rng(0))
    for channel, level in zip(machine.forward.channels, levels, strict=True):
        off = odd[channel.signal] - plain[channel.signal]
        assert 0.05 < np.sqrt(np.mean(np.square(off))) / level < 0.2, channel.name
    fed = [s for s in plain.signals if s not in {c.signal for c in machine.forward.channels}]
    assert all(np.array_equal(plain[s], odd[s]) for s in fed)


def test_a_case_hides_many_causes_and_some_outside_the_library(suite):
    truths = {t.hidden: t for t in suite[1]}
    many, none = truths[Hidden.MANY], truths[Hidden.NONE]
    assert MANY[0] <= len(many.labels) == len(many.causes) <= MANY[1]
    assert all(c.d >= MANY_DETECTABILITY[0] and c.share > 0.0 for c in many.causes)
    assert {many.values[name] for c in many.causes for name in c.departures}
    assert len(none.errors) == 6
    assert none.family is None
    outside = many.errors[6:]
    assert len(outside) in (1, 2)
    assert {e.family for e in outside} == {many.family}
    sizes = {e.column: e.size / 0.03 for e in many.errors[:6]}
    assert all(OUTSIDE[0] <= 0.999 * e.size / (sizes[e.column]) * 1.002 for e in outside)
    assert Truth.from_json(many.to_json()) == many


def test_the_files_tell_nothing_of_it(suite):
    folder, truths = suite
    text = (folder / "suite.json").read_text()
    for truth in truths:
        told = str(load_recording(folder / truth.case / RECORDING).info.to_dict()) + text
        assert not any(cause.effect in told for cause in truth.causes)
        assert not any(family in told for family in Family)


@pytest.mark.nightly
def test_a_case_is_answered_and_scored(suite):
    folder, truths = suite
    path = folder.with_name("answers.json")
    answers = answer_suite(folder, path, Settings(nulls=12, simulated_nulls=False), silent)
    rows = score(truths, answers).rows
    family = next(t.family for t in truths if t.family)
    found = rows[f"many, {family}: causes of 10% or more found"]
    assert found.hits >= found.of - 1
    assert rows["nothing hidden: firm false name"].hits == 0
    assert score_gain(folder, truths, answers)["many: 90% of the gain that could be had"].of == 1


def test_sizes_of_two_hidden_causes_with_the_same_columns_are_known_as_a_sum_alone():
    """Both intervals are off, and neither is counted: no record could tell them apart."""
    causes = (
        HiddenCause("offset", "x", {"offset@x:size": 1.0}, 30.0, 0.2, ("asymmetry@x",)),
        HiddenCause("asymmetry", "x", {"asymmetry@x:size": 1.0}, 30.0, 0.2),
        HiddenCause("spring", "x", {"spring@x:size": 1.0}, 30.0, 0.2),
    )
    law = (ModelError(Family.LAW, 0, 1.0, seed=1),)
    truth = Truth("case-0001", Hidden.MANY, causes, errors=law)
    sizes = {"offset@x:size": (2.0, 1.9, 2.1, 0.0), "spring@x:size": (1.0, 0.9, 1.1, 0.0)}
    answer = Answer("partial", ["offset@x", "spring@x"], [False, True], sizes=sizes)
    rows = score([truth], {"case-0001": answer}).rows
    assert str(rows["many: 90 % intervals that hold the hidden size"]).startswith("1 of 1")
    assert str(rows["many: sizes of which only a sum can be known"]).startswith("1 of 2")


def test_a_name_is_false_if_it_is_not_hidden_and_no_hidden_cause_has_its_columns():
    causes = (
        HiddenCause("a", "x", {"a@x:size": 1.0}, 30.0, 0.2, ("twin@x",)),
        HiddenCause("b", "x", {"b@x:size": 1.0}, 30.0, 0.2),
    )
    law = (ModelError(Family.LAW, 0, 1.0, seed=1),)
    truth = Truth("case-0001", Hidden.MANY, causes, errors=law, values={"a@x:size": 1.05})

    def rows(names, firm, like=None, sizes=None):
        answer = Answer("partial", names, firm, sizes=sizes, acts_like=like)
        return score([truth], {"case-0001": answer}).rows

    right = rows(["a@x", "b@x"], [True, True], sizes={"a@x:size": (1.0, 0.9, 1.1, 0.0)})
    assert right["many, law: names that are false"].hits == 0
    assert right["many, law: causes of 10% or more found"].hits == 2
    assert right["many: 90 % intervals that hold the hidden size"].hits == 1
    twin = rows(["twin@x"], [True])
    assert twin["many, law: names that are false"].hits == 0
    assert twin["many, law: causes of 10% or more found"].hits == 1
    assert twin["many, law: those by their own name"].hits == 0
    wrong = rows(["z@x", "y@x"], [True, False], {"y@x": ["q@x", "b@x + c@x"]})
    assert wrong["many, law: names that are false"].hits == 2
    assert wrong["many, law: names that are false by all that is said"].hits == 1
    assert str(wrong["many, law: firm names that are false"]).startswith("1 of 1")


def test_a_recipe_without_model_error_or_with_a_machine_that_is_fed_no_motion_is_refused(arm):
    with pytest.raises(InvalidInputError, match="model error"):
        Recipe(arm, {Hidden.MANY: 1}, 1).check(machine_of(arm))
    with pytest.raises(InvalidInputError, match="fed motion"):
        Recipe("pendulum", {Hidden.NONE: 1}, 1, model_error=0.1).check(machine_of("pendulum"))
