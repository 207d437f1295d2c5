"""Every clock event of a run agrees with its schedule; a cycle that ends too late halts the run."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.files import load_recording
from ves_twin.simulator.codes import SLOW
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.simulate import record

SHORT = {"run.duration": 0.2, "run.settle": 0.5}
BEAM = "beam_horizontal_truth"
TICK = 341e-6
SPIKE = {"start": 0.1, "duration": 0.005, "extra": "3 ms"}


def changes_of(values):
    """Ticks at which rows differ from the row before."""
    return 1 + np.flatnonzero(np.any(np.diff(values, axis=0) != 0.0, axis=1))


def clock_of(name, fidelity="full"):
    """Ticks at which the state of each device changed, the simulator run tick by tick.

    Noise is on and the rig moves, so that a device that acts does change; the amplifiers' clock is
    seen where the leg loop has given them a new command.
    """
    plant = vt.Plant.load("ves2").with_fidelity(fidelity)
    changes = {**SHORT, "run.log": "tick", "arm.moves": [], "platform.start": [0.01] + [0.0] * 5}
    if name == "position_sine":
        changes["platform.motion.fade"] = 0.0
    sim = vt.Simulator(plant, vt.Scenario.load(name, changes))
    rows = {"valve": [], "current": [], "set-point": [], "wander": [], "cycle": []}
    while not sim.done:
        sim.run_to(sim.rig.tick + 1)
        state, board = sim.rig.state[0], sim.rig.board
        rows["valve"].append(board["valve.command"].copy())
        rows["current"].append(state["current"].copy())
        rows["set-point"].append(state["legs"]["command"].copy())
        rows["wander"].append(state["sensor"]["wander"].copy())
        rows["cycle"].append([state["cycle_start"]])
        if sim.rig.tick >= 500:
            break
    sim.recorder.flush()
    return sim, {name: changes_of(np.array(values)) for name, values in rows.items()}


@pytest.mark.parametrize("fidelity", ["full", "fast"])
@pytest.mark.parametrize("name", [BEAM, "release_table_5_2", "position_sine"])
def test_every_device_acts_at_the_ticks_of_its_clock_and_at_no_other(name, fidelity):
    sim, acted = clock_of(name, fidelity)
    ticks = np.arange(1, sim.rig.tick)
    period = sim.rig.clock.admittance
    # an amplifier has something new when the leg loop has run since its last tick
    legs_before = lambda k: any(j % 5 == 0 for j in range(k - 2, k + 1))  # noqa: E731
    np.testing.assert_array_equal(acted["valve"], ticks[ticks % 5 == 0])
    np.testing.assert_array_equal(
        acted["current"], [k for k in ticks if k % 3 == 0 and legs_before(k)]
    )
    np.testing.assert_array_equal(acted["cycle"], ticks[ticks % period == 0])
    np.testing.assert_array_equal(acted["set-point"], ticks[ticks % period == 0])
    np.testing.assert_array_equal(acted["wander"], ticks[ticks % SLOW == 0])


@pytest.mark.parametrize(("log", "ticks"), [("admittance", 37), ("leg", 5), ("tick", 1)])
def test_rows_are_of_whole_ticks_and_none_is_missing(log, ticks):
    run = vt.simulate(vt.Scenario.load(BEAM, {**SHORT, "run.log": log}))
    expected = np.arange(0, int(0.2 / TICK) + 1, ticks)
    np.testing.assert_array_equal(np.rint(run.time / TICK), expected[: len(run)])
    assert len(expected) - len(run) <= 1
    assert run.info.period == pytest.approx(ticks * TICK, rel=1e-12)


def test_a_cycle_that_takes_too_long_halts_the_run_at_the_next_interrupt(tmp_path):
    """The cycle begun at tick 296 (0.1009 s) needs 14.8 ms; the interrupt of tick 333 finds it."""
    scenario = vt.Scenario.load(BEAM, {**SHORT, "platform.busy": [SPIKE]})
    summary = record(scenario, tmp_path)
    kept = load_recording(tmp_path)
    undisturbed = vt.simulate(vt.Scenario.load(BEAM, SHORT))
    assert summary.outcome is Outcome.OVERRUN
    assert summary.duration == pytest.approx(9 * 37 * TICK, abs=1e-12)
    assert "begun at 0.101 s takes 14.8 ms" in summary.events[-1]["message"]
    assert [event["kind"] for event in summary.events[-2:]] == ["busy", "overrun"]
    assert len(kept) == 9
    for name in kept.signals:
        np.testing.assert_array_equal(kept[name], undisturbed[name][:9])


def test_a_computer_that_is_busy_within_the_period_changes_nothing():
    busy = {"platform.busy": [{**SPIKE, "extra": "0.8 ms"}]}
    one, two = (vt.simulate(vt.Scenario.load(BEAM, {**SHORT, **c})) for c in ({}, busy))
    assert two.info.outcome == "completed"
    np.testing.assert_array_equal(one["truth.pose"], two["truth.pose"])


def test_two_loads_at_a_time_add_up():
    half = {**SPIKE, "extra": "0.5 ms"}
    for count, outcome in ((1, "completed"), (2, "overrun")):
        changes = {**SHORT, "platform.busy": [half] * count}
        assert vt.simulate(vt.Scenario.load(BEAM, changes)).info.outcome == outcome


def test_going_back_before_an_overrun_repeats_it():
    sim = vt.Simulator(None, vt.Scenario.load(BEAM, {**SHORT, "platform.busy": [SPIKE]}))
    sim.advance(0.05)
    kept = sim.snapshot()
    ends = []
    for _ in range(2):
        sim.restore(kept)
        sim.advance(1.0)
        ends.append((sim.outcome, sim.rig.tick, len(sim.events)))
    assert ends[0] == ends[1] == (Outcome.OVERRUN, 333, ends[0][2])


@pytest.mark.parametrize(
    ("changes", "word"),
    [({"extra": -1e-3}, "extra"), ({"duration": 0.0}, "duration"), ({"start": "3 m"}, "start")],
)
def test_a_load_that_makes_no_sense_is_refused(changes, word):
    with pytest.raises(VesTwinError, match=rf"platform\.busy\.0\.{word}") as caught:
        vt.Scenario.load(BEAM, {"platform.busy": [{**SPIKE, **changes}]})
    assert "\n" not in str(caught.value)
