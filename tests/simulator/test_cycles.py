"""Compiled cycles do what the interpreter's do, to the last bit, and leave the rest to it."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.control.admittance import AdmittanceController
from ves_twin.control.gravity import GravityTask, ModelCompensation
from ves_twin.control.law_of import law_of
from ves_twin.control.played import PlayedWrench
from ves_twin.control.position import PositionController
from ves_twin.control.registry import GRAVITY_COMPENSATIONS, PLATFORM_CONTROLLERS
from ves_twin.control.scaled import ScaledCompensation
from ves_twin.core.errors import ControllerError, UnreachableError
from ves_twin.envs.commanded_legs import CommandedLegs
from ves_twin.envs.corrected_gravity import CorrectedGravity
from ves_twin.mechanics.gravity.learned import LearnedGravity, PlannedExperiment
from ves_twin.mechanics.joint_motion import Hold, PlatformMotion, Sine
from ves_twin.simulator.build import belief_of
from ves_twin.simulator.computers import Computers
from ves_twin.simulator.cycles import SAMPLE
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.truth_port import GravityTruth

CYCLES = 40
SCENARIO = {"run.duration": 1.0, "run.settle": 0.2, "gravity.age": 2}


def simulator(mode, **changes):
    name = "position_sine" if mode == "position" else "vibration_damping"
    scenario = vt.Scenario.load(name, {**SCENARIO, "plant": "ves2_fast", **changes})
    if mode == "admittance":
        scenario = scenario.model_copy(
            update={"platform": scenario.platform.model_copy(update={"mode": mode})}
        )
    return vt.Simulator(None, scenario, seed=2)


@pytest.fixture(scope="module", params=sorted(PLATFORM_CONTROLLERS))
def sim(request):
    return simulator(request.param)


def compensation(sim, name):
    """A built-in compensation, plain or around the Model Method."""
    planned = PlannedExperiment("sensor", "system", (0.0,) * 6, 1 / 80, np.zeros((30, 3)))
    wrenches = np.random.default_rng(3).normal(size=(30, 6))
    rig = sim.rig
    task = GravityTask(
        belief_of(sim.scenario),
        GravityTruth(rig.model, rig.data, rig.layout),
        LearnedGravity(wrenches, planned, "a test"),
    )
    if name in GRAVITY_COMPENSATIONS:
        return GRAVITY_COMPENSATIONS[name](task)
    model = ScaledCompensation(ModelCompensation(task.belief), 0.01, 0.2)
    if name == "scaled":
        return model
    corrected = CorrectedGravity(model)
    corrected.correction = np.linspace(-1.0, 1.0, 6)
    return corrected


def played(sim, snapshot, interpreted, samples):
    """Everything that a stretch of cycles leaves behind, by either way."""
    sim.restore(snapshot)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ves_twin.simulator.recorder.FLUSH_SECONDS", np.inf)
        if interpreted:
            patch.setattr(Computers, "compiled", lambda *_: None)
        else:
            cycle, asked = Computers.cycle, []
            patch.setattr(Computers, "cycle", lambda *a: asked.append(a) or cycle(*a))
        sim.run_to(sim.rig.tick + 37 * CYCLES + 11, samples)
    if not interpreted:
        assert len(asked) == (sim.outcome is Outcome.LEG_LIMIT)  # it says why the run ends
    after = sim.snapshot()
    parts = [after.rig.state, after.rig.board, sim.data.qpos, sim.data.qvel, after.recorder.log]
    parts += [after.recorder.ticks, after.recorder.first_rows, after.recorder.points]
    parts += [np.array([after.recorder.at.rows, after.recorder.at.cycles, sim.rig.tick])]
    parts += [after.computers.shared, samples]
    parts += [p for p in (after.computers.controller, after.computers.gravity) if p is not None]
    return [part.tobytes() if isinstance(part, np.ndarray) else repr(part) for part in parts]


@pytest.mark.parametrize("name", [*sorted(GRAVITY_COMPENSATIONS), "scaled", "corrected"])
def test_compiled_and_interpreted_cycles_give_the_same_bits(sim, name):
    """Over the registries; one of an installed package runs by the interpreter both times."""
    before = sim.computers.gravity
    sim.computers.gravity = compensation(sim, name)
    snapshot = sim.snapshot()
    try:
        ways = [played(sim, snapshot, way, np.zeros(CYCLES, SAMPLE)) for way in (False, True)]
    finally:
        sim.restore(snapshot)
        sim.computers.gravity = before
    assert ways[0] == ways[1]


def test_legs_that_an_environment_commands_are_the_same_too():
    sim = simulator("position")
    legs = CommandedLegs(belief_of(sim.scenario).geometry, np.zeros(6))
    legs.motion = Sine(np.zeros(6), np.full(6, 0.02), np.full(6, 0.4), np.arange(6.0), 1.0)
    legs.command(np.linspace(-0.01, 0.01, 6), 0.0, 0.3)
    sim.computers.controller = legs
    snapshot = sim.snapshot()
    ways = [played(sim, snapshot, way, np.zeros(CYCLES, SAMPLE)) for way in (False, True)]
    assert ways[0] == ways[1]


def test_samples_are_the_ends_of_cycles():
    sim = simulator("micro_gravity")
    snapshot, at_once, one_by_one = sim.snapshot(), np.zeros(6, SAMPLE), np.zeros(6, SAMPLE)
    assert sim.run_to(6 * sim.rig.clock.admittance, at_once) == 6
    sim.restore(snapshot)
    for k in range(6):
        sim.run_to((k + 1) * sim.rig.clock.admittance)
        sim.rig.sample(one_by_one[k:])
    assert at_once.tobytes() == one_by_one.tobytes()


class Jump(PlatformMotion):
    """Stands, and from a time on is asked for something else."""

    def __init__(self, then):
        self.then = then

    def pose(self, time):
        if time < 0.2:
            return np.zeros(6)
        if isinstance(self.then, Exception):
            raise self.then
        return self.then


@pytest.mark.parametrize("interpreted", [False, True])
def test_a_pose_out_of_reach_ends_the_run_in_its_own_cycle(interpreted, monkeypatch):
    if interpreted:
        monkeypatch.setattr(Computers, "compiled", lambda *_: None)
    sim = simulator("position")
    sim.computers.controller = PositionController(Jump(np.full(6, 0.4)))
    sim.advance(1.0)
    assert sim.outcome is Outcome.LEG_LIMIT
    assert sim.rig.tick == 16 * 37  # 0.2 s are 15.9 cycles
    assert "left the safety margin; not sent" in sim.events[-1].message


@pytest.mark.parametrize("interpreted", [False, True])
@pytest.mark.parametrize("then", [np.full(6, np.nan), np.zeros(5), ValueError("no root")])
def test_what_a_motion_cannot_say_is_named_in_its_own_cycle(then, interpreted, monkeypatch):
    if interpreted:
        monkeypatch.setattr(Computers, "compiled", lambda *_: None)
    sim = simulator("position")
    sim.computers.controller = PositionController(Jump(then))
    with pytest.raises(ControllerError, match=r"PositionController .* at t = 0\.2"):
        sim.advance(1.0)
    assert sim.rig.tick == 16 * 37


def test_an_estimate_that_is_no_number_is_named_in_its_own_cycle():
    sim = simulator("position")
    wrenches = np.zeros((30, 6))
    wrenches[9] = np.nan
    sim.computers.gravity = PlayedWrench(wrenches, 37 * sim.rig.clock.tick)
    with pytest.raises(ControllerError, match="compensation PlayedWrench returned"):
        sim.advance(1.0)
    assert sim.rig.tick == 9 * 37


def test_lengths_that_no_pose_has_are_named_by_the_interpreter():
    sim = simulator("micro_gravity")
    sim.rig.board["leg.length"][:] = [9.0, 1.0, 9.0, 1.0, 9.0, 1.0]
    before = sim.computers.snapshot()
    with pytest.raises(UnreachableError, match="no platform pose"):
        sim.advance(0.1)
    after = sim.computers.snapshot()
    assert np.array_equal(before.shared, after.shared)
    assert np.array_equal(before.controller, after.controller)


class Counting(ModelCompensation):
    """A compensation of one's own, derived from a built-in one."""

    calls = 0

    def wrench(self, time, readings):
        self.calls += 1
        return super().wrench(time, readings)


def test_a_class_derived_from_a_built_in_one_keeps_the_interpreter():
    sim = simulator("micro_gravity")
    own = sim.computers.gravity = Counting(belief_of(sim.scenario))
    sim.run_to(5 * sim.rig.clock.admittance)
    assert law_of(own) is None
    assert own.calls == 5


@pytest.mark.parametrize("kind", [AdmittanceController, PositionController, CommandedLegs])
def test_built_in_controllers_have_laws(kind):
    assert "law" in vars(kind)


def test_a_correction_of_a_correction_and_a_share_of_one_are_for_the_interpreter():
    belief = belief_of(vt.Scenario.load("vibration_damping"))
    for wrap in (CorrectedGravity, lambda inner: ScaledCompensation(inner, 0.1, None)):
        assert law_of(wrap(CorrectedGravity(ModelCompensation(belief)))) is None
    assert law_of(ScaledCompensation(PlayedWrench(np.ones((2, 6)), 0.1), 0.1, None)) is not None


def test_sines_at_several_times_are_those_at_each():
    rng = np.random.default_rng(0)
    motion = Sine(*rng.normal(size=(4, 6)), 2.0)
    for times in ([0.01, 0.5, 3.0], [-1.0, 0.0, 0.3], rng.uniform(0, 60, 50).tolist()):
        np.testing.assert_array_equal(motion.along(times), [motion.pose(t) for t in times])
    assert Hold(np.ones(6)).along([0.0, 1.0]).shape == (2, 6)
