"""The simulator repeats itself to the last bit, also from snapshots, and ends by name."""

import copy

import numpy as np
import pytest
from shipped import each_scenario, full_run

import ves_twin as vt
from ves_twin.core.errors import ControllerError, UnreachableError
from ves_twin.scenario.load import scenario_questions
from ves_twin.simulator.outcome import Outcome

SHORT = {"run.duration": 0.5, "run.settle": 0.5}


def same(one: vt.Recording, two: vt.Recording) -> bool:
    """Whether two recordings are equal to the last bit."""
    return np.array_equal(one.time, two.time) and all(
        np.array_equal(one[name], two[name]) for name in one.signals
    )


def test_same_seed_gives_the_same_recording_to_the_last_bit():
    scenario = vt.Scenario.load("beam_horizontal_truth", {"run.duration": 1.0})
    assert same(vt.simulate(scenario, seed=3), vt.simulate(scenario, seed=3))


def test_another_seed_gives_another_recording():
    scenario = vt.Scenario.load("beam_horizontal_truth", SHORT)
    one, two = vt.simulate(scenario, seed=3), vt.simulate(scenario, seed=4)
    assert not np.array_equal(one["sensor.wrench"], two["sensor.wrench"])


@pytest.mark.parametrize("log", ["admittance", "leg"])
def test_restored_snapshot_repeats_the_run_to_the_last_bit(log):
    scenario = vt.Scenario.load("beam_horizontal_truth", {"run.duration": 4.0, "run.log": log})
    sim = vt.Simulator(None, scenario, seed=1)
    sim.advance(3.0)
    snapshot = sim.snapshot()
    sim.advance(10.0)
    first = copy.deepcopy(sim.recorder.sink.collect())
    sim.restore(snapshot)
    assert sim.outcome is None
    sim.advance(10.0)
    second = sim.recorder.sink.collect()
    assert np.array_equal(first[0], second[0])
    for name, values in first[1].items():
        assert np.array_equal(values, second[1][name]), name
    assert sim.outcome is Outcome.COMPLETED


def test_snapshot_taken_between_two_interrupts_repeats_too():
    scenario = vt.Scenario.load("beam_horizontal_truth", {"run.duration": 1.0})
    sim = vt.Simulator(None, scenario, seed=1)
    sim.advance(0.5004)
    assert sim.rig.tick % sim.rig.clock.admittance != 0
    snapshot = sim.snapshot()
    sim.advance(0.3)
    first = sim.data.qpos.copy()
    sim.restore(snapshot)
    sim.advance(0.3)
    assert np.array_equal(first, sim.data.qpos)


def test_advancing_in_pieces_equals_advancing_at_once():
    scenario = vt.Scenario.load("beam_horizontal_truth", SHORT)
    whole, pieces = vt.Simulator(None, scenario), vt.Simulator(None, scenario)
    whole.advance(0.5)
    for _ in range(52):
        pieces.advance(0.01001)
    assert pieces.done
    assert np.array_equal(whole.data.qpos, pieces.data.qpos)


@pytest.mark.parametrize("name", list(scenario_questions()))
def test_every_scenario_starts_settled_and_records_every_signal(name):
    sim = vt.Simulator(None, vt.Scenario.load(name, {"run.duration": 0.2}))
    sim.advance(0.2)
    time, signals = sim.recorder.sink.collect()
    assert sim.events[0].kind == "settled"
    assert not any(event.kind == "not_still" for event in sim.events)
    assert time[0] == 0.0
    assert set(signals) == set(sim.recorder.names)
    assert all(np.all(np.isfinite(values)) for values in signals.values())


CLOSURE_LIMIT = 1e-5  # m, the figure asked of every scenario


@each_scenario(scenario_questions())
def test_legs_stay_closed_in_every_scenario(name, figure):
    _, gap = full_run(name)
    figure(f"loop closure in {name}", gap * 1e3, CLOSURE_LIMIT * 1e3, "mm")


def test_unstable_loop_ends_by_name_and_keeps_its_rows():
    recording, _ = full_run("beam_horizontal_corrected")
    assert recording.info.outcome in {Outcome.WRENCH_RANGE, Outcome.LEG_LIMIT}
    assert len(recording) > 5
    assert recording.info.events[-1].kind == recording.info.outcome


def test_command_beyond_the_margin_is_not_sent():
    changes = {"platform.motion.amplitude": [0.0, 0.0, 0.3, 0.0, 0.0, 0.0], "run.duration": 5.0}
    sim = vt.Simulator(None, vt.Scenario.load("position_sine", changes))
    sim.advance(5.0)
    travel = sim.plant.parameters.number("leg.stroke") / 2
    margin = sim.plant.parameters.number("leg.margin")
    home = sim.plant.geometry.lengths(np.zeros(6))
    sent = sim.recorder.sink.collect()[1]["leg.command"]
    assert sim.outcome is Outcome.LEG_LIMIT
    assert np.max(np.abs(sent - home)) <= travel - margin


def test_rate_faster_than_the_computer_is_an_overrun():
    changes = {"platform.rate": 95.0, "run.duration": 1.0}
    sim = vt.Simulator(None, vt.Scenario.load("beam_horizontal_truth", changes))
    assert sim.outcome is Outcome.OVERRUN


def test_wrench_beyond_the_sensor_range_ends_by_name():
    changes = {"parameters": {"sensor.range": [1500.0, 1500.0, 900.0, 600.0, 600.0, 600.0]}}
    sim = vt.Simulator(None, vt.Scenario.load("position_sine", {**SHORT, **changes}))
    assert sim.outcome is Outcome.WRENCH_RANGE


def test_a_run_that_fails_while_it_settles_has_every_signal_of_no_rows():
    changes = {"parameters": {"sensor.range": [500.0] * 6}}
    run = vt.simulate(vt.Scenario.load("position_sine", {**SHORT, **changes}))
    assert run.info.outcome == Outcome.WRENCH_RANGE
    assert len(run) == 0
    assert run["truth.pose"].shape == (0, 6)
    assert run["arm.q"].shape == (0, 3)


def test_state_that_is_not_finite_ends_as_diverged_and_is_logged(tmp_path, monkeypatch, caplog):
    monkeypatch.chdir(tmp_path)  # MuJoCo by itself writes MUJOCO_LOG.TXT where the program stands
    caplog.set_level("INFO", "ves_twin.mujoco")
    sim = vt.Simulator(None, vt.Scenario.load("position_sine", SHORT))
    sim.data.qvel[:] = np.nan
    sim.advance(0.1)
    assert sim.outcome is Outcome.DIVERGED
    assert list(tmp_path.iterdir()) == []
    assert any("QVEL" in record.getMessage() for record in caplog.records)


def test_start_pose_out_of_reach_is_refused_with_the_leg():
    scenario = vt.Scenario.load("position_sine", {"platform.start": [0.4, 0, 0.2, 0, 0, 0]})
    with pytest.raises(UnreachableError, match=r"needs leg \d"):
        vt.Simulator(None, scenario)


class _Plugin:
    """A controller and a compensation that gives an answer, or raises it."""

    def __init__(self, answer):
        self.answer = answer

    def update(self, time, readings):
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer

    wrench = update


@pytest.mark.parametrize(
    ("part", "named"),
    [("controller", "controller _Plugin"), ("gravity", "gravity compensation _Plugin")],
)
@pytest.mark.parametrize(
    "answer",
    [np.full(6, np.nan), np.zeros(5), np.zeros((6, 1)), None, [0.0] * 6, ValueError("no\nroot")],
)
def test_what_fails_in_the_computers_is_named_in_one_line(part, named, answer):
    sim = vt.Simulator(None, vt.Scenario.load("position_sine", SHORT))
    setattr(sim.computers, part, _Plugin(answer))
    with pytest.raises(ControllerError, match=named) as caught:
        sim.advance(0.1)
    assert "\n" not in str(caught.value)


def test_an_estimate_is_as_old_as_asked_though_its_array_is_used_again():
    sim = vt.Simulator(None, vt.Scenario.load("position_sine", {**SHORT, "gravity.age": 2}))
    reused = np.zeros(6)
    sim.computers.gravity = _Plugin(reused)
    seen = []
    for k in range(5):
        reused[:] = k
        sim.computers.estimate_gravity(0.0)
        seen.append(sim.computers.readings.gravity_in_sensor[0])
    assert seen[2:] == [0.0, 1.0, 2.0]


def test_readings_cannot_be_written_by_a_controller():
    sim = vt.Simulator(None, vt.Scenario.load("position_sine", SHORT))
    with pytest.raises(ValueError, match="read-only"):
        sim.computers.readings.leg_length[0] = 1.0


def test_real_admittance_rate_is_the_nearest_whole_period():
    sim = vt.Simulator(None, vt.Scenario.load("beam_horizontal_truth", SHORT))
    assert sim.rig.clock.admittance == 37
    assert sim.rig.clock.rate == pytest.approx(79.26, abs=0.01)


def test_events_tell_what_was_planned_in_the_order_of_time():
    run = vt.simulate(vt.Scenario.load("beam_horizontal_truth", {"run.duration": 3.0}))
    kinds = [event.kind for event in run.info.events]
    assert kinds == ["settled", "zeroed", "released", "arm_move", "arm_move", "completed"]
    times = [event.time for event in run.info.events]
    assert times == sorted(times)
    assert times[3:5] == [0.5, 2.5]


@pytest.mark.parametrize("log", ["admittance", "leg", "tick"])
def test_recording_does_not_depend_on_when_rows_are_flushed(log, monkeypatch):
    scenario = vt.Scenario.load("beam_horizontal_truth", {"run.duration": 1.0, "run.log": log})
    runs = []
    for pause in (0.0, 1e9):  # flush at every cycle, and only when the buffer is full
        monkeypatch.setattr("ves_twin.simulator.recorder.FLUSH_SECONDS", pause)
        runs.append(vt.simulate(scenario))
    for name in runs[0].signals:
        assert np.array_equal(runs[0][name], runs[1][name]), name


def test_flushing_in_the_middle_of_a_cycle_loses_and_repeats_nothing():
    scenario = vt.Scenario.load("beam_horizontal_truth", {"run.duration": 0.5, "run.log": "leg"})
    whole, pieces = vt.Simulator(None, scenario), vt.Simulator(None, scenario)
    whole.advance(1.0)
    while not pieces.done:
        pieces.advance(0.017)
        pieces.recorder.flush()
    time_whole, signals_whole = whole.recorder.sink.collect()
    time_pieces, signals_pieces = pieces.recorder.sink.collect()
    assert np.array_equal(time_whole, time_pieces)
    for name, values in signals_whole.items():
        assert np.array_equal(values, signals_pieces[name]), name


def test_plant_given_beside_a_scenario_takes_the_scenario_s_parameters():
    scenario = vt.Scenario.load("position_sine", {**SHORT, "parameters.leg.rod_mass": 9.0})
    sim = vt.Simulator(vt.Plant.load("ves2"), scenario)
    assert sim.plant.parameters.number("leg.rod_mass") == 9.0


def test_cycle_longer_than_a_block_of_noise_is_refused():
    from ves_twin.core.errors import InvalidInputError

    scenario = vt.Scenario.load("position_sine", {**SHORT, "parameters.clock.tick": 1e-6})
    with pytest.raises(InvalidInputError, match=r"platform\.rate"):
        vt.Simulator(None, scenario)
