"""Blind suites: what is sealed, what is kept from a diagnosis, and how answers are marked."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from once import once
from sizes import nightly_but

from ves_twin.cli.main import main
from ves_twin.core.errors import FileAccessError, InvalidInputError, UnknownNameError
from ves_twin.core.recording.files import load_recording
from ves_twin.diagnosis.record.runs import silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.suites.answer import answer_suite
from ves_twin.suites.answers import Answer, write_answers
from ves_twin.suites.draw import DETECTABILITY, PAIR_DETECTABILITY
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.machines import machine_of
from ves_twin.suites.make import make_suite
from ves_twin.suites.rate import Rate
from ves_twin.suites.recipe import Recipe
from ves_twin.suites.score import read_truths, score
from ves_twin.suites.seal import new_key, seal, unseal
from ves_twin.suites.suite import RECORDING, load_suite
from ves_twin.suites.truth import Hidden, HiddenCause, Truth

COUNTS = {Hidden.NONE: 1, Hidden.SINGLE: 2, Hidden.OUTSIDE: 2, Hidden.PAIR: 1, Hidden.CONFUSABLE: 1}
RECIPE = Recipe("pendulum", COUNTS, 3)


@pytest.fixture(scope="module")
def told():
    """Stages of the making, as its progress tells them."""
    return []


@pytest.fixture(scope="module")
def suite(tmp_path_factory, told):
    folder = tmp_path_factory.mktemp("blind") / "suite"
    make_suite(RECIPE, folder, folder.with_name("key"), lambda share, what: told.append(what))
    return folder


def test_a_seal_opens_with_its_key_alone_and_shows_tampering():
    key = new_key()
    sealed = seal("friction at leg 3", key)
    assert unseal(sealed, key, "truth") == "friction at leg 3"
    assert b"friction" not in sealed
    for broken in (sealed[:-1] + bytes([sealed[-1] ^ 1]), sealed[:20]):
        with pytest.raises(InvalidInputError):
            unseal(broken, key, "truth")
    with pytest.raises(InvalidInputError):
        unseal(sealed, new_key(), "truth")


def test_the_recordings_tell_nothing_of_the_truth(suite):
    truths = read_truths(suite, suite.with_name("key").read_text().strip())
    assert sorted(t.hidden for t in truths) == sorted(
        sort for sort, n in COUNTS.items() for _ in range(n)
    )
    for truth in truths:
        recording = load_recording(suite / truth.case / RECORDING)
        told = json.dumps(recording.info.to_dict())
        assert recording.info.seed == 0
        assert recording.info.plant_hash == ""
        assert not any(name.startswith("truth.") for name in recording.signals)
        assert not any(cause.effect in told for cause in truth.causes)


def test_no_hidden_cause_is_fainter_than_its_sort_may_be(suite):
    truths = read_truths(suite, suite.with_name("key").read_text().strip())
    pairs = [cause.d for t in truths if t.hidden is Hidden.PAIR for cause in t.causes]
    assert len(pairs) == 2 * COUNTS[Hidden.PAIR]
    assert all(d >= PAIR_DETECTABILITY[0] for d in pairs)
    assert all(c.d >= DETECTABILITY[0] for t in truths for c in t.causes)


def test_every_stage_of_the_making_is_told(suite, told):
    assert list(dict.fromkeys(told)) == [
        "commissioning tolerances",
        "sizes in sigma",
        "how far tolerances bend",
        "signatures",
        "what each cause left out could be taken for",
        "recordings",
    ]


def test_a_suite_that_was_interrupted_goes_on_with_the_same_cases(suite):
    before = {p: p.read_bytes() for p in suite.rglob("*.parquet")}
    lost = suite / "case-0003"
    for path in lost.iterdir():
        path.unlink()
    make_suite(RECIPE, suite, suite.with_name("key"), silent)
    again = load_recording(lost / RECORDING)
    assert {p.parent.name for p in suite.rglob(RECORDING)} == set(load_suite(suite).cases)
    assert all(p.read_bytes() == old for p, old in before.items() if p.parent != lost)
    assert len(again) == len(load_recording(suite / "case-0001" / RECORDING))


def test_a_suite_goes_on_by_the_recipe_that_it_was_begun_with(suite):
    public = (suite / "suite.json").read_text()
    key = suite.with_name("key")
    make_suite(replace(RECIPE, seed=None), suite, key, silent)  # any seed: its own
    assert (suite / "suite.json").read_text() == public
    for other, told in ((replace(RECIPE, seed=4), "seed"), (replace(RECIPE, spread=2.0), "spread")):
        with pytest.raises(InvalidInputError, match=told):
            make_suite(other, suite, key, silent)
    assert (suite / "suite.json").read_text() == public
    (suite / "recipe.sealed").rename(suite / "away")
    with pytest.raises(InvalidInputError, match="recipe"):
        make_suite(RECIPE, suite, key, silent)
    (suite / "away").rename(suite / "recipe.sealed")


def test_a_folder_whose_key_is_gone_is_refused(suite, tmp_path):
    with pytest.raises(InvalidInputError, match="key"):
        make_suite(RECIPE, suite, tmp_path / "other", silent)


@pytest.mark.parametrize("hidden", nightly_but(1, [Hidden.SINGLE, Hidden.NONE]))
def test_answering_imports_no_generator_and_reads_no_key(tmp_path, hidden):
    """A fresh process, in which opening the key or importing a generator ends in an error."""
    suite, recipe = tmp_path / "suite", Recipe("pendulum", {hidden: 1}, 3)
    make_suite(recipe, suite, suite.with_name("key"), silent)
    code = f"""
import builtins, sys
from pathlib import Path
real, opened = builtins.open, []
sys.addaudithook(lambda event, args: opened.append(str(args[0])) if event == "open" else None)
from ves_twin.suites.answer import answer_suite
from ves_twin.diagnosis.settings import Settings
folder = Path({str(suite)!r})
answer_suite(folder, folder.with_name("answers.json"), Settings(nulls=12), lambda *a: None)
for name in ("make", "pinned", "draw", "machine", "machines", "play", "mjcf", "ves2", "seal", "truth"):
    assert f"ves_twin.suites.{{name}}" not in sys.modules, name
assert not any("sealed" in path or path.endswith("key") for path in opened), "looked at the truth"
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-600:]
    answers = json.loads(suite.with_name("answers.json").read_text())
    assert set(answers) == set(load_suite(suite).cases)


def test_what_was_answered_before_counts_for_no_share_of_the_work(suite, tmp_path, monkeypatch):
    """Time left is told from the share: two of seven cases left are half done after one."""

    def failing(*_):
        raise UnknownNameError("cause", "none", [])

    monkeypatch.setattr("ves_twin.suites.answer.diagnosed", failing)
    path, told = tmp_path / "answers.json", []
    cases = load_suite(suite).cases
    write_answers({case: Answer("nothing") for case in cases[:-2]}, path)
    found = answer_suite(suite, path, Settings(), lambda share, what: told.append((share, what)))
    assert told == [(0.0, "cases without an answer"), (0.5, "cases without an answer")]
    assert [found[case].verdict for case in cases] == [*["nothing"] * 5, "error", "error"]


def test_every_outside_kind_changes_what_is_measured():
    machine = machine_of("pendulum")
    rng = np.random.default_rng
    plain = machine.record(BlindRig(), "train", rng(0)).signals["joint.angle"]
    for kind, (_, largest) in machine.outside.items():
        odd = machine.record(BlindRig({}, kind, largest), "train", rng(0)).signals["joint.angle"]
        assert np.sqrt(np.mean((odd - plain) ** 2)) > 1e-3, kind  # the encoder's noise


NOISE = {"leg.length": 2e-5, "sensor.wrench": 0.4, "arm.q": 1e-3, "arm.torque": 0.1}
OUTSIDE = [
    "sensor_hysteresis", "gear_ripple", "arm_stop", "clock_skew", "encoder_slip",
    "sensor_offset_step", "sensor_line", "sensor_square", "platform_drag", "clipped_channel",
]  # fmt: skip
EDITS = [
    "payload_off_centre", "late_length", "friction_loss", "crossed_wires",
    "leaning_gravity", "late_sensor_clock", "logged_length", "logged_angle",
]  # fmt: skip


def recorded(rig):
    return machine_of("ves2_fast").record(rig, "train", np.random.default_rng(0)).signals


def test_every_kind_of_the_rig_is_tried_here():
    machine = machine_of("ves2_fast")
    assert (set(OUTSIDE), set(EDITS)) == (set(machine.outside), set(machine.edits))


@pytest.mark.slow
@pytest.mark.parametrize("kind", nightly_but(5, OUTSIDE))
def test_every_outside_kind_of_the_rig_changes_what_is_measured(kind):
    largest = machine_of("ves2_fast").outside[kind][1]
    odd, plain = recorded(BlindRig({}, kind, largest)), once(recorded, BlindRig())
    assert max(np.abs(odd[n] - plain[n]).max() / sd for n, sd in NOISE.items()) > 1.0


@pytest.mark.slow
@pytest.mark.parametrize("kind", nightly_but(4, EDITS))
def test_an_edit_of_the_rig_is_the_cause_of_the_library_that_it_stands_for(kind):
    """But for the noise of what is edited after it was recorded: a late signal's is smoothed."""
    edit, plain = machine_of("ves2_fast").edits[kind], once(recorded, BlindRig())
    odd = recorded(BlindRig({}, kind, edit.high))
    same = recorded(BlindRig({edit.parameter: edit.high}))
    effect = [np.square((same[n] - plain[n]) / sd).sum() for n, sd in NOISE.items()]
    apart = [np.square((odd[n] - same[n]) / sd).sum() for n, sd in NOISE.items()]
    assert sum(effect) > 100.0
    assert sum(apart) < 0.02 * sum(effect)


def truth(n, hidden, *labels, d=15.0):
    causes = tuple(HiddenCause(*label.split("@"), {"size": 1.0}, d) for label in labels)
    return Truth(f"case-{n:04d}", hidden, causes, "line" if hidden is Hidden.OUTSIDE else "")


TRUTHS = [
    truth(1, Hidden.NONE),
    truth(2, Hidden.SINGLE, "a@x"),
    truth(3, Hidden.SINGLE, "b@x", d=7.0),
    truth(4, Hidden.OUTSIDE),
    truth(5, Hidden.PAIR, "a@x", "b@x"),
    truth(6, Hidden.CONFUSABLE, "a@x"),
    truth(7, Hidden.EDITED, "a@x"),
]


def test_perfect_answers_get_full_marks():
    answers = {
        "case-0001": Answer("nothing"),
        "case-0002": Answer("named", ["a@x"], [True], 0.99),
        "case-0003": Answer("named", ["b@x"], [True], 0.99),
        "case-0004": Answer("unknown"),
        "case-0005": Answer("several", ["b@x", "a@x"], [True, True], 0.9),
        "case-0006": Answer("ambiguous", ["c@x", "a@x"], [True, True], 0.5),
        "case-0007": Answer("named", ["a@x"], [True], 0.99, sizes={"size": (1.1, 0.9, 1.3, 0.0)}),
    }
    for name, rate in score(TRUTHS, answers).rows.items():
        bad = any(word in name for word in ("false", "wrong", "beyond"))
        assert rate.hits == (0 if bad else rate.of), name


def test_always_nothing_names_nothing_and_a_guesser_is_wrong():
    silence = score(TRUTHS, {t.case: Answer("nothing") for t in TRUTHS}).rows
    assert silence["nothing hidden: nothing said"].hits == 1
    assert silence["single, d 10 to 20: exact"].hits == 0
    guess = score(TRUTHS, {t.case: Answer("named", ["z@x"], [True], 0.9) for t in TRUTHS})
    assert guess.rows["nothing hidden: firm false name"].hits == 1
    assert guess.rows["single: right if named"].hits == 0
    assert guess.rows["a kind that the library lacks, detected: abstains"].hits == 0
    assert guess.rows["pairs, both d >= 10: a wrong name"].hits == 1
    assert guess.rows["a cause by an edit, detected: a wrong name"].hits == 1
    assert guess.confusions["a@x", "named: z@x"] == 1


def test_wilson_intervals_are_those_of_the_books():
    low, high = Rate(8, 10).interval  # Newcombe 1998, Stat. Med. 17: by the closed form
    assert (low, high) == pytest.approx((0.490, 0.943), abs=1e-3)


def test_bad_input_gets_one_line(tmp_path, suite, capsys):
    with pytest.raises(UnknownNameError, match="pendulum"):
        make_suite(Recipe("pendulm", COUNTS, 0), tmp_path / "s", tmp_path / "k", silent)
    with pytest.raises(FileAccessError):
        load_suite(tmp_path)
    (tmp_path / "answers.json").write_text("[1, 2]")
    key = str(suite.with_name("key"))
    code = main(
        ["blind", "score", "--out", str(suite), "--key", key,
         "--answers", str(tmp_path / "answers.json")]
    )  # fmt: skip
    assert code == 2
    assert capsys.readouterr().err.count("\n") == 1
