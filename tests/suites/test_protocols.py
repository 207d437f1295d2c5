"""Protocols of blind suites: rigs in order beside the cases, lacking physics, cuts, next steps."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from pendulum import (
    BIAS,
    BLIND,
    DELAYED,
    INERTIA,
    LATE,
    LATE_COMMAND,
    MACHINE,
    SDS,
    SPRING,
    TIME,
    TORQUE,
)

from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.runs import silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.started import start_signal, started
from ves_twin.suites.answer import answer_suite
from ves_twin.suites.answers import Answer, read_answers, write_answers
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.make import make_suite
from ves_twin.suites.material import Material, Use
from ves_twin.suites.play import play_next, played_file
from ves_twin.suites.recipe import Recipe
from ves_twin.suites.score import read_truths, score
from ves_twin.suites.score_gain import true_energy
from ves_twin.suites.score_next import score_next
from ves_twin.suites.suite import BASELINE, HELD_OUT, RECORDING, STANDSTILL, load_suite, next_file
from ves_twin.suites.truth import Hidden, HiddenCause, Truth

START = start_signal("joint")


def made(tmp_path, **asked):
    counts = asked.pop("counts", {Hidden.NONE: 1, Hidden.SINGLE: 1})
    folder = tmp_path / "suite"
    make_suite(Recipe("pendulum", counts, 5, **asked), folder, tmp_path / "key", silent)
    return folder, read_truths(folder, (tmp_path / "key").read_text().strip())


def angle(folder, name):
    return load_recording(folder / name)["joint.angle"][:, 0]


def test_commissioned_rigs_are_rigs_of_their_own_and_used_only_if_asked(tmp_path):
    folder, _ = made(tmp_path, commissioned=5, spread=2.5)
    suite = load_suite(folder)
    assert suite.commissioned == 5
    case = suite.cases[0]
    rigs = Material.of(folder, suite, case, Use()).commissioning
    assert len(rigs) == 5
    moved = [np.std(a["joint.angle"] - b["joint.angle"]) for a, b in pairwise(rigs)]
    assert min(moved) > 2.0 * SDS[0]  # another rig, not another noise
    assert Material.of(folder, suite, case, Use(commissioning=False)).commissioning == ()


def test_a_baseline_has_the_background_and_not_the_hidden_effect(tmp_path):
    folder, truths = made(tmp_path, background={"quadratic_drag": 0.02}, baseline=True)
    sick = next(t for t in truths if t.causes)
    assert sick.background == {"quadratic_drag": 0.02}
    before, after = (angle(folder / sick.case, name) for name in (BASELINE, RECORDING))
    well = next(t for t in truths if not t.causes)
    same = [angle(folder / well.case, name) for name in (BASELINE, RECORDING)]
    assert np.std(after - before) > 1.5 * np.std(same[1] - same[0])
    bare = BLIND.record(BlindRig(), "train", np.random.default_rng(0))
    drag = BlindRig(background={"quadratic_drag": 0.02})
    odd = BLIND.record(drag, "train", np.random.default_rng(0))
    assert np.std(odd["joint.angle"] - bare["joint.angle"]) > 5.0 * SDS[0]


def test_a_held_out_recording_after_the_repair_lacks_the_effect(tmp_path):
    folder, truths = made(tmp_path, repaired=True)
    sick = next(t for t in truths if t.causes)
    assert sick.repaired
    values = dict(sick.values)
    for name, departure in sick.causes[0].departures.items():
        values[name] -= departure
    held, still = load_recording(folder / sick.case / HELD_OUT), load_recording(folder / STANDSTILL)
    assert true_energy(BLIND, held, still, values) < 1.3
    assert true_energy(BLIND, held, still, sick.values) > 1.5


def test_a_cut_recording_says_nothing_of_it_and_its_start_is_read_off(tmp_path):
    folder, truths = made(tmp_path, cut=True, counts={Hidden.NONE: 3})
    assert "cut" not in (folder / "suite.json").read_text()
    rest = BLIND.record(BlindRig(), "train", np.random.default_rng(0))
    for truth in truths:
        recording = load_recording(folder / truth.case / RECORDING)
        assert len(recording) == len(rest)
        assert START not in recording.signals
        moved, groups = started(MACHINE, [recording], [rest])
        assert START in MjcfForward.of(moved).drive
        assert all(START in r.signals for group in groups for r in group)
        wide = {p.name: p.sd for p in MjcfForward.of(moved).parameters}
        assert wide["start@joint:speed"] > 10.0 * 0.005


def test_a_recording_from_rest_keeps_the_plant_as_it_is():
    values = BLIND.commissioned(np.random.default_rng(3), 2.5) | {BIAS: 0.05}
    rest = BLIND.record(BlindRig(values), "train", np.random.default_rng(0))
    assert started(MACHINE, [rest]) == (MACHINE, ((rest,),))


def test_the_start_that_is_read_is_that_of_the_motion():
    time = TIME
    begun = np.tile([0.4, -1.5], (len(time), 1))
    fed = {"joint.torque": TORQUE, START: begun}
    clean = DELAYED.simulate(Excitation("", time, fed), {})
    rows = clean + np.random.default_rng(0).standard_normal(clean.shape) * SDS
    signals = {
        "joint.torque": TORQUE,
        "joint.angle": rows[:, :1],
        "joint.rate": rows[:, 1:],
    }
    recording = Recording(time, signals, RecordingInfo("measured", own_signals=()))
    (found,) = started(MACHINE, [recording])[1][0]
    assert found[START][0] == pytest.approx([0.4, -1.5], abs=0.02)


def test_no_entry_of_the_menu_swings_beyond_a_right_angle():
    for programme in MjcfMachine(MACHINE).excitations():
        swing = np.abs(DELAYED.simulate(programme, {})[:, 0]).max()
        assert 0.02 < swing < np.pi / 2, programme.name


def test_only_a_release_parts_the_two_delays():
    apart = {}
    for programme in MjcfMachine(MACHINE).excitations():
        late = [DELAYED.simulate(programme, {late: 0.005}) for late in (LATE, LATE_COMMAND)]
        apart[programme.name] = np.std(late[0] - late[1], axis=0)[0] / SDS[0]
    assert apart["quick multisine"] < 0.1
    assert apart["let go from 0.6 of the travel"] > 3.0


def test_a_cause_left_out_has_its_alias(tmp_path):
    from ves_twin.diagnosis.record.preprocess import preprocess
    from ves_twin.suites.aliases import aliases

    nominal = BLIND.record(BlindRig(), "train", np.random.default_rng(0))
    runs = preprocess(DELAYED, [nominal]).runs

    def hidden(label, name, size):
        cause = HiddenCause(*label.split("@"), {name: size}, 20.0)
        return Truth("c", Hidden.OUTSIDE, (cause,))

    late, spring, rotor = aliases(
        runs,
        [
            hidden("sensor_delay@joint", LATE, 0.004),
            hidden("joint_spring@joint", SPRING, 0.1),
            hidden("rotor_inertia@joint", INERTIA, -0.00112),
        ],
    )
    assert ("actuator_delay@drive",) in late
    assert ("sensor_offset@joint.angle.1",) not in late
    assert all(len(labels) > 1 for labels in spring)
    # by the columns at nominal the pair leaves 16 of 17 sigma, fitted by the full forward 5.5
    assert {frozenset(labels) for labels in rotor} == {
        frozenset({"body_mass@link", "actuator_gain@drive"})
    }


def test_a_next_experiment_is_played_on_the_hidden_rig_and_counted(tmp_path):
    folder, truths = made(tmp_path, counts={Hidden.CONFUSABLE: 2})
    label = truths[0].causes[0].label
    other = dict(zip(BLIND.confusable, reversed(BLIND.confusable), strict=True))[label]
    offered = {"let go from 0.6 of the travel": 300.0, "slow multisine": 1.0}
    group = Answer("ambiguous", [other, label], [True, True], 0.5, programmes=offered)
    first = {truths[0].case: group}
    key = (tmp_path / "key").read_text().strip()
    played = play_next(folder, key, truths, first, "proposed", silent)
    assert played == {truths[0].case: "let go from 0.6 of the travel"}
    assert json.loads(played_file(folder, "proposed").read_text()) == played
    after = load_recording(folder / truths[0].case / next_file("proposed"))
    assert after[START][0] == pytest.approx([0.6, 0.0])
    assert after["joint.angle"][0, 0] == pytest.approx(0.6, abs=0.05)
    with pytest.raises(UnknownNameError, match="proposed"):
        play_next(folder, key, truths, first, "propsed", silent)
    said = {
        truths[0].case: Answer("named", [label], [True], 1.0, behind={label: 0.0, other: 280.0})
    }
    scores = score_next(truths, first, {"proposed": said}, {"proposed": played})
    assert scores.rows["next experiment, proposed: resolved"].hits == 1
    assert scores.points.tolist() == [[300.0, 280.0]]
    wrong = {truths[0].case: Answer("named", [other], [True], 1.0)}
    scores = score_next(truths, first, {"proposed": wrong}, {"proposed": played})
    assert scores.rows["next experiment, proposed: a wrong name"].hits == 1


def test_names_beyond_the_aliases_and_lost_firm_names_are_counted():
    causes = (HiddenCause("a", "x", {}, 15.0),)
    likes = (("b@x",), ("c@x", "d@x"))
    truths = [Truth("case-1", Hidden.OUTSIDE, causes, aliases=likes)]
    row = "a cause left out, detected: a name beyond its aliases"
    for names, hits in ((["b@x"], 0), (["d@x", "c@x"], 0), (["d@x"], 1), (["e@x"], 1)):
        said = Answer("named" if len(names) == 1 else "several", names, [True] * len(names))
        assert score(truths, {"case-1": said}).rows[row].hits == hits, names
    truths = [Truth("case-1", Hidden.SINGLE, causes)]
    firm, soft = (Answer("named", ["a@x"], [sure], 1.0) for sure in (True, False))
    row = "single: firm names of the other answers that stay"
    assert score(truths, {"case-1": soft}, {"case-1": firm}).rows[row].hits == 0
    assert score(truths, {"case-1": firm}, {"case-1": firm}).rows[row].hits == 1
    assert row not in score(truths, {"case-1": firm}, {"case-1": soft}).rows


def test_a_recipe_that_cannot_be_met_gets_one_line(tmp_path, capsys):
    for words, told in (
        (["--commissioned", "3"], "at least 5"),
        (["--background", "wind=3"], "wind"),
        (["--background", "line"], "KIND=SIZE"),
        (["--background", "line=9"], "0.02"),
        (["--cut", "--baseline"], "cut"),
        (["--bench", "ves2_fast", "--poor"], "poor"),  # the older name of --machine
        (["--machine", "ft_wrist"], "poses"),
    ):
        folder = tmp_path / words[0].strip("-")
        code = main(["blind", "make", "--cases", "1", "--seed", "1", "--out", str(folder), *words])
        error = capsys.readouterr().err.strip()
        assert code == 2, words
        assert told in error.splitlines()[-1], words
        assert "Traceback" not in error
    with pytest.raises(InvalidInputError):
        Recipe("pendulum", {}, 0, spread=0.0).check(BLIND)


@pytest.mark.slow
def test_a_rig_in_order_cut_out_of_its_motion_is_in_order(tmp_path):
    folder, _ = made(tmp_path, cut=True, counts={Hidden.NONE: 2})
    found = answer_suite(folder, tmp_path / "answers.json", Settings(nulls=30), silent)
    assert [answer.verdict for answer in found.values()] == ["nothing", "nothing"]
    write_answers({}, tmp_path / "answers.json")


@pytest.mark.nightly
def test_two_processes_answer_as_one_does_each_a_case_of_its_own(tmp_path):
    folder, _ = made(tmp_path, counts={Hidden.NONE: 2, Hidden.SINGLE: 1})
    told = []
    for workers in (1, 2):
        settings = Settings(nulls=30, workers=workers)
        answers = answer_suite(folder, tmp_path / f"{workers}.json", settings, silent)
        assert sorted(answers) == sorted(read_answers(tmp_path / f"{workers}.json"))
        told.append({case: replace(answer, seconds=0.0) for case, answer in answers.items()})
    assert told[0] == told[1]
    assert len(told[0]) == 3


@pytest.mark.parametrize(
    "changed",
    [{"machine": ...}, {"cases": 3}, {"excluded": []}, {"excluded": {"a": 1}}, {"commissioned": "x"},
     {"commissioned": float("inf")}],
    ids=str,
)  # fmt: skip
def test_a_suite_that_is_not_what_was_written_is_refused_in_one_line(changed, tmp_path):
    content = {"schema": 1, "machine": "pendulum", "cases": ["a"], "excluded": {}} | changed
    content = {name: value for name, value in content.items() if value is not ...}
    (tmp_path / "suite.json").write_text(json.dumps(content))
    with pytest.raises(InvalidInputError, match="expected machine, cases, excluded") as caught:
        load_suite(tmp_path)
    assert "\n" not in str(caught.value)


def test_a_truth_sealed_under_an_earlier_name_of_an_effect_is_read_by_todays():
    name = "link_mass@arm.link2:mass"
    earlier = HiddenCause("link_mass", "arm.link2", {name: 0.4}, 20.0)
    pendulum = HiddenCause("link_mass", "link", {"link.mass": 0.1}, 20.0)
    sealed = Truth("case-01", Hidden.PAIR, (earlier, pendulum), values={name: 0.4})
    read = Truth.from_json(sealed.to_json())
    today = "body_mass@arm.link2:mass"
    one, other = read.causes
    assert one == HiddenCause("body_mass", "arm.link2", {today: 0.4}, 20.0)
    assert other == HiddenCause("body_mass", "link", {"body_mass@link:mass": 0.1}, 20.0)
    assert read.values == {today: 0.4}
