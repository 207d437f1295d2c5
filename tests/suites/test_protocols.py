"""Protocols of blind suites: rigs in order beside the cases, lacking physics, cuts, next steps."""

import json
from itertools import pairwise

import numpy as np
import pytest

from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.forward import Excitation
from ves_twin.diagnosis.runs import silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.pendulum.excitations import pendulum_menu
from ves_twin.machines.pendulum.forward import CHANNELS, START, STEP, Pendulum
from ves_twin.machines.pendulum.inputs import prepare_pendulum
from ves_twin.suites.achievable import true_energy
from ves_twin.suites.answer import answer_suite
from ves_twin.suites.answers import Answer, write_answers
from ves_twin.suites.bench import BlindRig
from ves_twin.suites.make import make_suite
from ves_twin.suites.material import Material, Use
from ves_twin.suites.pendulum import BlindPendulum, asked_torque
from ves_twin.suites.play import play_next, played_file
from ves_twin.suites.recipe import Recipe
from ves_twin.suites.score import mark, read_truths
from ves_twin.suites.score_next import mark_next
from ves_twin.suites.suite import BASELINE, HELD_OUT, RECORDING, STANDSTILL, load_suite, next_file
from ves_twin.suites.truth import Hidden, HiddenCause, Truth

BENCH = BlindPendulum()
DELAYED = Pendulum.with_command_delay()


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
    assert min(moved) > 2.0 * CHANNELS[0].sd  # another rig, not another noise
    assert Material.of(folder, suite, case, Use(commissioning=False)).commissioning == ()


def test_a_baseline_has_the_background_and_not_the_hidden_effect(tmp_path):
    folder, truths = made(tmp_path, background={"quadratic_drag": 0.02}, baseline=True)
    sick = next(t for t in truths if t.causes)
    assert sick.background == {"quadratic_drag": 0.02}
    before, after = (angle(folder / sick.case, name) for name in (BASELINE, RECORDING))
    well = next(t for t in truths if not t.causes)
    same = [angle(folder / well.case, name) for name in (BASELINE, RECORDING)]
    assert np.std(after - before) > 1.5 * np.std(same[1] - same[0])
    bare = BENCH.record(BlindRig(), "train", np.random.default_rng(0))
    drag = BlindRig(background={"quadratic_drag": 0.02})
    odd = BENCH.record(drag, "train", np.random.default_rng(0))
    assert np.std(odd["joint.angle"] - bare["joint.angle"]) > 5.0 * CHANNELS[0].sd


def test_a_held_out_recording_after_the_repair_lacks_the_effect(tmp_path):
    folder, truths = made(tmp_path, repaired=True)
    sick = next(t for t in truths if t.causes)
    assert sick.repaired
    values = dict(sick.values)
    for name, departure in sick.causes[0].departures.items():
        values[name] -= departure
    held, still = load_recording(folder / sick.case / HELD_OUT), load_recording(folder / STANDSTILL)
    assert true_energy(DELAYED, held, still, values) < 1.3
    assert true_energy(DELAYED, held, still, sick.values) > 1.5


def test_a_cut_recording_says_nothing_of_it_and_its_start_is_read_off(tmp_path):
    folder, truths = made(tmp_path, cut=True, counts={Hidden.NONE: 3})
    assert "cut" not in (folder / "suite.json").read_text()
    rest = BENCH.record(BlindRig(), "train", np.random.default_rng(0))
    for truth in truths:
        recording = load_recording(folder / truth.case / RECORDING)
        assert len(recording) == len(rest)
        assert START.name not in recording.signals
        given = prepare_pendulum(DELAYED, [recording], [rest])
        assert given.plant.started
        assert all(START.name in r.signals for group in given.groups for r in group)
        wide = {p.name: p.sd for p in given.plant.parameters}
        assert wide["start.rate"] > 10.0 * 0.005


def test_a_recording_from_rest_keeps_the_plant_as_it_is():
    values = BENCH.commissioned(np.random.default_rng(3), 2.5) | {"encoder.bias": 0.05}
    rest = BENCH.record(BlindRig(values), "train", np.random.default_rng(0))
    given = prepare_pendulum(DELAYED, [rest])
    assert given.plant is DELAYED
    assert given.groups == ((rest,),)


def test_the_start_that_is_read_is_that_of_the_motion():
    torque = asked_torque(1)
    time = STEP * np.arange(len(torque))
    begun = np.tile([0.4, -1.5], (len(time), 1))
    fed = {"joint.torque": torque[:, None], START.name: begun}
    clean = DELAYED.simulate(Excitation("", time, fed), {})
    rows = clean + np.random.default_rng(0).standard_normal(clean.shape) * [c.sd for c in CHANNELS]
    signals = {
        "joint.torque": torque[:, None],
        "joint.angle": rows[:, :1],
        "joint.rate": rows[:, 1:],
    }
    recording = Recording(time, signals, RecordingInfo("measured", own_signals=()))
    (found,) = prepare_pendulum(DELAYED, [recording]).groups[0]
    assert found[START.name][0] == pytest.approx([0.4, -1.5], abs=0.02)


def test_no_entry_of_the_menu_swings_beyond_a_right_angle():
    for programme in pendulum_menu():
        swing = np.abs(DELAYED.simulate(programme, {})[:, 0]).max()
        assert 0.02 < swing < np.pi / 2, programme.name


def test_only_a_release_parts_the_two_delays():
    apart = {}
    for programme in pendulum_menu():
        late = [DELAYED.simulate(programme, {f"{w}.delay": 0.005}) for w in ("sensor", "command")]
        apart[programme.name] = np.std(late[0] - late[1], axis=0)[0] / CHANNELS[0].sd
    assert apart["quick multisine"] < 0.1
    assert apart["let go from 0.6 rad"] > 3.0


def test_a_cause_left_out_has_its_twin_for_a_stand_in(tmp_path):
    from ves_twin.diagnosis.preprocess import preprocess
    from ves_twin.suites.aliases import stand_ins

    nominal = BENCH.record(BlindRig(), "train", np.random.default_rng(0))
    runs = preprocess(DELAYED, [nominal]).runs

    def hidden(label, **departures):
        parameters = {k.replace("_", "."): v for k, v in departures.items()}
        return Truth("c", Hidden.OUTSIDE, (HiddenCause(*label.split("@"), parameters, 20.0),))

    late, spring, rotor = stand_ins(
        runs,
        [
            hidden("delay@sensor", sensor_delay=0.004),
            hidden("joint_stiffness@joint", joint_stiffness=0.1),
            hidden("rotor_inertia@joint", joint_armature=-0.00112),
        ],
    )
    assert ("delay@command",) in late
    assert ("encoder_offset@sensor",) not in late
    assert all(len(labels) > 1 for labels in spring)
    # by the columns at nominal the pair leaves 16 of 17 sigma, fitted by the full forward 5.5
    assert rotor == (("link_mass@link", "torque_gain@drive"),)


def test_a_next_experiment_is_played_on_the_hidden_rig_and_counted(tmp_path):
    folder, truths = made(tmp_path, counts={Hidden.CONFUSABLE: 2})
    label = truths[0].causes[0].label
    other = {"delay@sensor": "delay@command", "delay@command": "delay@sensor"}[label]
    offered = {"let go from 0.6 rad": 300.0, "slow multisine": 1.0}
    group = Answer("ambiguous", [other, label], [True, True], 0.5, programmes=offered)
    first = {truths[0].case: group}
    key = (tmp_path / "key").read_text().strip()
    played = play_next(folder, key, truths, first, "proposed", silent)
    assert played == {truths[0].case: "let go from 0.6 rad"}
    assert json.loads(played_file(folder, "proposed").read_text()) == played
    after = load_recording(folder / truths[0].case / next_file("proposed"))
    assert after[START.name][0] == pytest.approx([0.6, 0.0])
    assert after["joint.angle"][0, 0] == pytest.approx(0.6, abs=0.05)
    with pytest.raises(UnknownNameError, match="proposed"):
        play_next(folder, key, truths, first, "propsed", silent)
    said = {
        truths[0].case: Answer("named", [label], [True], 1.0, behind={label: 0.0, other: 280.0})
    }
    marks = mark_next(truths, first, {"proposed": said}, {"proposed": played})
    assert marks.rows["next experiment, proposed: resolved"].hits == 1
    assert marks.points.tolist() == [[300.0, 280.0]]
    wrong = {truths[0].case: Answer("named", [other], [True], 1.0)}
    marks = mark_next(truths, first, {"proposed": wrong}, {"proposed": played})
    assert marks.rows["next experiment, proposed: a wrong name"].hits == 1


def test_names_beyond_the_stand_ins_and_lost_firm_names_are_counted():
    causes = (HiddenCause("a", "x", {}, 15.0),)
    likes = (("b@x",), ("c@x", "d@x"))
    truths = [Truth("case-1", Hidden.OUTSIDE, causes, stand_ins=likes)]
    row = "a cause left out, detected: a name beyond its stand-ins"
    for names, hits in ((["b@x"], 0), (["d@x", "c@x"], 0), (["d@x"], 1), (["e@x"], 1)):
        said = Answer("named" if len(names) == 1 else "several", names, [True] * len(names))
        assert mark(truths, {"case-1": said}).rows[row].hits == hits, names
    truths = [Truth("case-1", Hidden.SINGLE, causes)]
    firm, soft = (Answer("named", ["a@x"], [sure], 1.0) for sure in (True, False))
    row = "single: firm names of the other answers that stay"
    assert mark(truths, {"case-1": soft}, {"case-1": firm}).rows[row].hits == 0
    assert mark(truths, {"case-1": firm}, {"case-1": firm}).rows[row].hits == 1
    assert row not in mark(truths, {"case-1": firm}, {"case-1": soft}).rows


def test_a_recipe_that_cannot_be_met_gets_one_line(tmp_path, capsys):
    for words, told in (
        (["--commissioned", "3"], "at least 5"),
        (["--background", "wind=3"], "wind"),
        (["--background", "line"], "KIND=SIZE"),
        (["--background", "line=9"], "0.02"),
        (["--cut", "--baseline"], "cut"),
        (["--bench", "ves2_fast", "--poor"], "poor"),
    ):
        folder = tmp_path / words[0].strip("-")
        code = main(["blind", "make", "--cases", "1", "--seed", "1", "--out", str(folder), *words])
        error = capsys.readouterr().err.strip()
        assert code == 2, words
        assert told in error.splitlines()[-1], words
        assert "Traceback" not in error
    with pytest.raises(InvalidInputError):
        Recipe("pendulum", {}, 0, spread=0.0).check(BENCH)


@pytest.mark.slow
def test_a_rig_in_order_cut_out_of_its_motion_is_in_order(tmp_path):
    folder, _ = made(tmp_path, cut=True, counts={Hidden.NONE: 2})
    found = answer_suite(folder, tmp_path / "answers.json", Settings(nulls=30), silent)
    assert [answer.verdict for answer in found.values()] == ["nothing", "nothing"]
    write_answers({}, tmp_path / "answers.json")


@pytest.mark.parametrize(
    "changed",
    [{"bench": ...}, {"cases": 3}, {"excluded": []}, {"excluded": {"a": 1}}, {"commissioned": "x"},
     {"commissioned": float("inf")}],
    ids=str,
)  # fmt: skip
def test_a_suite_that_is_not_what_was_written_is_refused_in_one_line(changed, tmp_path):
    content = {"schema": 1, "bench": "pendulum", "cases": ["a"], "excluded": {}} | changed
    content = {name: value for name, value in content.items() if value is not ...}
    (tmp_path / "suite.json").write_text(json.dumps(content))
    with pytest.raises(InvalidInputError, match="expected bench, cases, excluded") as caught:
        load_suite(tmp_path)
    assert "\n" not in str(caught.value)
