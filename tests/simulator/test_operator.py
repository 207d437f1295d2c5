"""Operation in the plant: each rule of Appendix E, and the scenario that breaks it."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.control.controller import ControlTask, PlatformController
from ves_twin.control.operation.state import State
from ves_twin.control.readings import Readings
from ves_twin.mechanics.joint_motion import ArmMotion, Move
from ves_twin.plant.laboratory import Laboratory

BRAKED_CREEP = 1e-3
"""How far a braked joint may move [rad]: the engine's dry friction is slightly soft."""

HELD = 2e-5
"""How far a frozen platform may move by the spring of its oil after it has come to rest [m, rad]."""


def run(name: str, changes: dict[str, object] | None = None) -> vt.Recording:
    return vt.simulate(vt.Scenario.load(name, changes))


def events(recording: vt.Recording, kind: str = "operation") -> list[str]:
    return [event.message for event in recording.info.events if event.kind == kind]


def at(recording: vt.Recording, time: float) -> int:
    return int(np.searchsorted(recording.time, time))


def test_an_operation_without_an_action_is_nothing_to_the_last_bit():
    changes = {"run.duration": 1.0}
    plain = run("beam_horizontal_truth", changes)
    operated = run("beam_horizontal_truth", {**changes, "operation.begin": "run"})
    assert plain.signals.keys() == operated.signals.keys()
    for name in plain.signals:
        assert np.array_equal(plain[name], operated[name]), name


def test_power_cut_before_the_arms_panic_button_lets_the_arm_fall_until_the_brakes_grip():
    fallen = run("operation_crate_power")
    q = fallen["truth.arm_q"]
    drop = q[at(fallen, 0.5), 1] - q[at(fallen, 0.8), 1]
    assert drop > np.radians(10)
    torque = np.abs(fallen["arm.torque"][at(fallen, 0.55) :])
    assert np.max(torque) < 5.0  # noise of the drive currents alone
    assert np.ptp(q[at(fallen, 1.8) :], axis=0).max() < BRAKED_CREEP
    assert events(fallen, "arm_falls")
    # and the platform holds: its valves have no current
    assert np.max(np.abs(fallen["truth.pose"][at(fallen, 1.0) :, :3])) < 1e-4


def test_the_falling_arm_falls_as_gravity_says():
    """Joint 2 alone at first: q'' = -(gravity torque - friction) / inertia, from the engine."""
    scenario = vt.Scenario.load("operation_crate_power", {"run.duration": 0.7})
    sim = vt.Simulator(None, scenario)
    sim.advance(0.5)
    sim.advance(0.02)
    dof = sim.rig.layout.arm_dof
    before, time = sim.data.qvel[dof].copy(), sim.time
    mass = np.zeros((sim.model.nv, sim.model.nv))
    import mujoco

    mujoco.mj_fullM(sim.model, sim.data, mass)
    passive = sim.data.qfrc_passive[dof] + sim.data.qfrc_constraint[dof]
    expected = np.linalg.solve(mass[np.ix_(dof, dof)], passive - sim.data.qfrc_bias[dof])
    sim.advance(0.005)
    found = (sim.data.qvel[dof] - before) / (sim.time - time)
    # the base moves a little under the arm, and 5 ms turn it: 3 %
    np.testing.assert_allclose(found[1:], expected[1:], rtol=0.03)


def test_power_cut_after_the_arms_panic_button_leaves_the_arm_where_it_is():
    actions = [
        {"at": 0.5, "action": "press_arm_panic"},
        {"at": 0.7, "action": "crate_off"},
    ]
    held = run("operation_crate_power", {"operation.actions": actions})
    q = held["truth.arm_q"]
    assert np.ptp(q[at(held, 0.4) :], axis=0).max() < BRAKED_CREEP
    assert not events(held, "arm_falls")
    # it was turning about its drive; the brake carries the weight and the drive nothing
    assert np.max(np.abs(held["arm.torque"][at(held, 1.0) :])) < 5.0


def test_the_panic_button_freezes_a_moving_platform_and_it_holds():
    frozen = run("operation_panic")
    assert "run -> freeze: panic button pressed" in events(frozen)
    late = frozen["truth.pose"][at(frozen, 2.5) :]
    assert np.ptp(late, axis=0).max() < HELD
    moving = frozen["truth.pose"][at(frozen, 1.0) : at(frozen, 2.0)]
    assert np.ptp(moving, axis=0).max() > 0.02
    assert np.all(np.abs(frozen["valve.command"][at(frozen, 2.1) :]) == 0.0)
    assert any("home: the platform's program does not run" in m for m in events(frozen, "refused"))


def test_a_frozen_platform_on_chambers_creeps_as_its_leakage_says_and_does_not_fall():
    """Null leakage of 20 l/min lets it sink; see gravity_model and `plant/droop.py`."""
    changes = {"plant": "ves2_pressure", "run.duration": 4.0}
    frozen = run("operation_panic", changes)
    late = frozen["truth.pose"][at(frozen, 2.6) :]
    assert np.ptp(late[:, :3], axis=0).max() < 1.5e-3  # m in 1.4 s


def test_a_command_beyond_the_margin_is_not_sent_and_freezes_the_platform():
    margin = run("operation_leg_margin")
    assert any("leg 1 left the safety margin" in message for message in events(margin))
    assert margin.info.outcome == "completed"
    travel = np.abs(margin["leg.command"] - margin["leg.command"][0])
    assert np.max(travel) <= 0.25 - 0.008
    alone = run("operation_leg_margin", {"operation": None})
    assert alone.info.outcome == "leg_limit"


def test_an_overrun_freezes_the_platform():
    late = run("operation_overrun")
    assert any("overrun" in message for message in events(late))
    assert late.info.outcome == "completed"
    assert np.ptp(late["truth.pose"][at(late, 1.3) :], axis=0).max() < HELD


def test_low_manifold_pressure_freezes_the_platform():
    low = run("operation_low_pressure")
    freezes = [e for e in low.info.events if "manifold pressure" in e.message]
    limit, tau = Laboratory.load().low_pressure, Laboratory.load().run_down
    expected = 0.5 + tau * np.log(1e7 / limit)
    # a cycle of 12.6 ms to see the action, one to see the pressure; noise of the gauge, 0.2 bar
    assert freezes[0].time == pytest.approx(expected, abs=0.03)
    assert np.ptp(low["truth.pose"][at(low, 1.0) :], axis=0).max() < HELD


def test_two_readers_of_the_board_lock_up_the_computers_and_the_platform_stands_unwatched():
    locked = run("operation_two_readers")
    assert events(locked, "lock_up")
    commands = locked["platform.command"][at(locked, 1.05) :]
    assert np.ptp(commands, axis=0).max() == 0.0
    assert np.any(locked["valve.command"][at(locked, 1.2)])  # the leg controllers go on
    assert any("do not answer" in message for message in events(locked, "refused"))
    assert "run -> freeze: panic button pressed" in events(locked)
    through_memory = run("operation_two_readers", {"operation.actions": [
        {"at": 1.0, "action": "read_sensor"}
    ]})  # fmt: skip
    assert not events(through_memory, "lock_up")


def test_going_home_with_the_arm_upright_hits_the_ceiling_and_with_the_arm_level_it_does_not():
    hit = run("operation_ceiling")
    assert hit.info.outcome == "ceiling"
    # 1.765 m from the top plate to the end of the upright arm, the ceiling 1.6 m above it at home
    assert hit["truth.pose"][-1, 2] == pytest.approx(1.60 - 1.765, abs=0.005)
    clear = run("operation_ceiling", {"arm.start": ["180 deg", "180 deg", 0.0]})
    assert clear.info.outcome == "completed"
    assert "at home" in events(clear)


def test_a_frozen_platform_is_brought_back_to_sleep():
    back = run("operation_recovery")
    said = events(back)
    states = [message.split(":")[0] for message in said if "->" in message]
    assert states == [
        "run -> freeze", "freeze -> start", "start -> idle", "idle -> home", "home -> sleep"
    ]  # fmt: skip
    refused = events(back, "refused")
    assert any("the panic button is pressed" in message for message in refused)
    started = slice(at(back, 4.0), at(back, 5.0))
    # "the platform should not move AT ALL"
    assert np.ptp(back["truth.pose"][started], axis=0).max() < 1e-4
    asleep = back["leg.length"][-1] - 1.05179318
    np.testing.assert_allclose(asleep, -0.235, atol=1e-3)


def test_a_whole_session_goes_by_the_handbook():
    session = run("operation_session")
    assert session.info.outcome == "completed"
    states = [m.split(":")[0].split(" -> ")[1] for m in events(session) if "->" in m]
    assert states == ["sleep", "start", "idle", "home", "run", "home", "sleep", "off"]
    assert len(events(session, "refused")) == 1  # the self-test, with the button pressed
    assert np.ptp(session["truth.arm_q"], axis=0).max() < 5e-3
    running = session["truth.pose"][at(session, 9.0) : at(session, 11.9), 2]
    assert np.ptp(running) == pytest.approx(0.1, abs=0.01)


def test_a_snapshot_in_the_middle_of_an_operation_repeats_to_the_last_bit():
    scenario = vt.Scenario.load("operation_recovery")
    sim = vt.Simulator(None, scenario)
    sim.advance(5.55)  # on the ramp, after a freeze
    snapshot = sim.snapshot()
    ends = []
    for _ in range(2):
        sim.advance(8.0)
        ends.append((sim.data.qpos.copy(), sim.operator.machine.state, len(sim.events)))
        sim.restore(snapshot)
    assert np.array_equal(ends[0][0], ends[1][0])
    assert ends[0][1:] == ends[1][1:]
    assert ends[0][1] is State.SLEEP


@pytest.mark.parametrize("plant", ["ves2_pressure", "ves2_fast"])
def test_a_session_runs_on_every_form_of_the_rig(plant):
    session = run("operation_session", {"plant": plant, "run.duration": 6.5})
    assert session.info.outcome == "completed", session.info.events[-1]
    assert "at home" in events(session)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"operation.begin": "slep"}, "did you mean 'sleep'"),
        ({"operation.begin": "start"}, "known"),
        (
            {"operation.actions": [{"at": 1.0, "action": "pres_panic"}]},
            "did you mean 'press_panic'",
        ),
        ({"operation.actions": [{"at": -1.0, "action": "idle"}]}, "greater than or equal to 0"),
        (
            {"operation.actions": [{"at": 2, "action": "idle"}, {"at": 1, "action": "home"}]},
            "'home' at 1.0 s stands after",
        ),
        ({"operation.action": []}, "did you mean 'operation.actions'"),
    ],
)
def test_a_script_that_cannot_be_is_refused_in_one_line(changes, says):
    with pytest.raises(Exception, match=says) as caught:
        vt.Scenario.load("operation_panic", changes)
    assert isinstance(caught.value, vt.VesTwinError)
    assert "\n" not in str(caught.value)


def test_a_snapshot_of_an_operated_emulation_repeats_to_the_last_bit():
    """Admittance and the queue of gravity estimates are those of the computers that run."""
    changes = {"run.duration": 1.0, "operation.begin": "run"}
    sim = vt.Simulator(None, vt.Scenario.load("beam_horizontal_truth", changes))
    sim.advance(0.7)  # the arm moves, so that base and estimate do
    snapshot = sim.snapshot()
    ends = []
    for _ in range(2):
        sim.advance(0.2)
        ends.append((sim.data.qpos.copy(), sim.rig.board["gravity.estimate"].copy()))
        sim.restore(snapshot)
    assert np.array_equal(ends[0][0], ends[1][0])
    assert np.array_equal(ends[0][1], ends[1][1])


def test_the_zero_g_reference_does_not_depend_on_when_rows_are_flushed(monkeypatch):
    """Its arm has its drive, whatever the laboratory's buttons do after the row."""
    changes = {"run.duration": 1.2, "operation.begin": "run"}
    pressed = {"operation.actions": [{"at": 0.9, "action": "press_arm_panic"}]}
    runs = []
    for pause in (0.0, 1e9):  # flush at every cycle, and only at the end
        monkeypatch.setattr("ves_twin.simulator.recorder.FLUSH_SECONDS", pause)
        runs.append(run("beam_horizontal_truth", {**changes, **pressed}))
    for name in ("reference.pose", "reference.pose_leg_lag"):
        assert np.array_equal(runs[0][name], runs[1][name]), name
    calm = run("beam_horizontal_truth", changes)
    assert np.array_equal(runs[0]["reference.pose"], calm["reference.pose"])


class Stays(PlatformController):
    """Commands the pose of home, whatever the mode's own would do."""

    @classmethod
    def build(cls, task: ControlTask) -> "Stays":
        return cls()

    def update(self, time: float, readings: Readings) -> np.ndarray:
        return np.zeros(6)

    def snapshot(self) -> None:
        return None

    def restore(self, snapshot: object) -> None:
        pass


def test_a_controller_and_an_arm_of_ones_own_run_under_an_operation_too():
    changes = {"run.duration": 1.0, "operation.actions": []}
    q = np.array([0.1, 0.0, 0.0])
    scenario = vt.Scenario.load("operation_panic", {**changes, "arm.start": q.tolist()})
    moves = ArmMotion(q, (Move(0.0, 1.0, q + np.array([0.2, 0.0, 0.0])),))
    sim = vt.Simulator(None, scenario, controller=Stays, arm=moves)
    sim.advance(1.0)
    signals = sim.recorder.sink.collect()[1]
    assert not np.any(signals["platform.command"])  # the mode's own sine moves by centimetres
    assert np.ptp(signals["arm.command"][:, 0]) > 0.15
