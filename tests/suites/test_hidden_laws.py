"""Laws that are in no dictionary, hidden in pendulums by other code, found from recordings alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.suites.hidden_law import LAW_KINDS, Acts, draw_law
from ves_twin.suites.law_suite import (
    FILES,
    IN_ORDER,
    MACHINE,
    STANDSTILL,
    LawScore,
    LawTruth,
    answer_laws,
    hidden_in,
    make_laws,
    read_law_truths,
    score_law,
    truth_file,
)
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.mjcf import BlindMjcf

HIDDEN = ["random_of_speed", "one_sided_spring", "rate_square"]
"""A curve that chance draws, a power of 3/2, and a sensor that bends: a column."""

GAIN = 0.9
"""Of the held-out excess: what is left of it is the table's own error."""


@pytest.fixture(scope="module")
def scores(tmp_path_factory: pytest.TempPathFactory) -> list[LawScore]:
    folder = tmp_path_factory.mktemp("laws") / "suite"
    truths = make_laws([*HIDDEN, IN_ORDER, IN_ORDER], folder, 3)
    settings = Settings(laws=True, nulls=30, cache=folder.parent / "banks")
    answers = answer_laws(folder, settings, lambda case, answer: None)
    return [score_law(truth, answers[truth.case]) for truth in truths]


@pytest.mark.nightly
@pytest.mark.timeout(1800)  # five whole diagnoses, three of them with a search
@pytest.mark.parametrize("kind", HIDDEN)
def test_a_law_in_no_dictionary_is_found_with_place_variable_and_gain(
    scores: list[LawScore], kind: str
) -> None:
    (found,) = [score for score in scores if score.kind == kind]
    assert found.verdict == "unknown"
    assert found.claimed
    assert found.place
    assert found.gain is not None
    assert found.gain > GAIN
    assert found.rms is not None
    assert found.rms < 0.2


@pytest.mark.nightly
@pytest.mark.timeout(1800)
def test_a_machine_in_order_gets_no_law(scores: list[LawScore]) -> None:
    assert not any(score.claimed for score in scores if score.kind == IN_ORDER)


def test_recordings_tell_nothing_of_what_is_hidden(tmp_path: Path) -> None:
    folder = tmp_path / "suite"
    make_laws(["sinh_drag"], folder, 1)
    inside = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    assert inside == {STANDSTILL, *(f"case-0001/{name}" for name in FILES)}
    assert folder.resolve() not in truth_file(folder).resolve().parents
    for path in folder.rglob("*.parquet"):
        assert b"sinh" not in path.read_bytes()
    assert [truth.kind for truth in read_law_truths(folder)] == ["sinh_drag"]


@pytest.mark.parametrize("kind", list(LAW_KINDS))
def test_a_hidden_law_changes_what_is_recorded(kind: str) -> None:
    machine = BlindMjcf(Rig.load(MACHINE))
    law = draw_law(kind, np.random.default_rng(1))
    rows = [
        machine.record(BlindRig({}, law=one), "train", np.random.default_rng(0))
        for one in (law, None)
    ]
    column = "joint.rate" if law.place == "joint.rate" else "joint.angle"
    sd = {"joint.rate": 0.01, "joint.angle": 0.001}[column]
    assert np.std(rows[0][column] - rows[1][column]) > 0.2 * sd
    assert (law.acts is Acts.READING) == (law.place != "joint")


def test_a_case_is_the_same_whenever_it_is_drawn() -> None:
    machine = BlindMjcf(Rig.load(MACHINE))
    truth = LawTruth("case-0001", "cogging", (5, 1))
    first, second = (hidden_in(machine, truth) for _ in range(2))
    assert first[0].values == second[0].values
    x = np.linspace(-1.0, 1.0, 9)
    assert first[1] is not None
    assert second[1] is not None
    assert np.array_equal(first[1].function(x), second[1].function(x))
