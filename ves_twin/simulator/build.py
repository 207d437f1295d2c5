"""build_computers and build_references: what a scenario names, made into objects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.control.belief import Belief
from ves_twin.control.controller import ControlTask, PlatformController
from ves_twin.control.gravity import GravityCompensation, GravityTask
from ves_twin.control.gravity_feedforward import GravityFeedforward
from ves_twin.control.operation.state import State
from ves_twin.control.played import Script
from ves_twin.control.registry import GRAVITY_COMPENSATIONS, PLATFORM_CONTROLLERS
from ves_twin.control.scaled import ScaledCompensation
from ves_twin.core.recording.recording import Event
from ves_twin.core.types import Block, FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.gravity.calibration import GravityCalibration
from ves_twin.mechanics.gravity.learned import LearnedGravity
from ves_twin.mechanics.joint_motion import JointMotion, PlatformMotion
from ves_twin.plant.plant import Plant
from ves_twin.plant.statics import check_reach
from ves_twin.scenario.motions import SetpointMotion
from ves_twin.scenario.schema import Platform, Scenario
from ves_twin.simulator.arm_commands import arm_motion
from ves_twin.simulator.computers import Computers
from ves_twin.simulator.operator import Operator
from ves_twin.simulator.planned import planned_experiment
from ves_twin.simulator.recorder import IDEAL, LEG_LAG
from ves_twin.simulator.reference import ZeroGravityReference
from ves_twin.simulator.rig import Rig
from ves_twin.simulator.setpoint_motion import setpoint_motion
from ves_twin.simulator.truth_port import GravityTruth


def build_operator(
    scenario: Scenario, belief: Belief, rig: Rig, computers: Computers, played: bool
) -> Operator | None:
    """The operators of a scenario, if it has any."""
    if scenario.operation is None:
        return None
    start = np.array(scenario.platform.start)
    return Operator(scenario.operation, rig, computers, belief, start, played)


def belief_of(scenario: Scenario) -> Belief:
    """What the controllers take the rig to be, from the scenario's belief file."""
    plant = Plant.load(scenario.belief)
    number = plant.parameters.number
    return Belief(
        geometry=plant.geometry,
        arm=plant.arm,
        sensor_position=plant.parameters.array("sensor.position"),
        leg_travel=number("leg.stroke") / 2.0 - number("leg.margin"),
        full_speed=number("hydraulics.full_speed"),
        gravity=plant.gravity_model,
    )


def build_computers(
    scenario: Scenario,
    belief: Belief,
    rig: Rig,
    script: Script | None = None,
    controller: type[PlatformController] | None = None,
    arm: JointMotion | None = None,
) -> Computers:
    """Controllers of a scenario, or a script that is played back, connected to the rig's board.

    `controller` and `arm` take the place of the scenario's platform controller and arm motion.

    Raises:
        UnreachableError: the start pose is outside the legs' travel.
        InvalidInputError: a gravity calibration of another sensor or arm, W_g of another
            experiment, or an effect on an emulated system where there is none.
    """
    start = np.array(scenario.platform.start)
    check_reach(belief.geometry, start, belief.leg_travel, "platform.start")
    belief = _calibrated(scenario, belief, rig)
    gravity = script.gravity if script else _gravity(scenario, belief, rig)
    period = rig.clock.admittance * rig.clock.tick
    emulated, age = emulated_of(scenario), scenario.gravity.age
    if not script:  # what is played back was decided by computers long ago
        emulated, age = _deployed(emulated, age, rig.plant)
    task = ControlTask(
        belief=belief,
        period=period,
        start=start,
        home=np.array(scenario.platform.home),
        emulated=emulated,
        motion=script.poses if script else _motion(scenario.platform, belief),
        subtract_gravity=scenario.platform.mode != "admittance" and gravity.subtracts,
    )
    chosen = controller or PLATFORM_CONTROLLERS[scenario.platform.mode]
    return Computers(
        belief=belief,
        controller=chosen.build(task),
        gravity=gravity,
        gravity_age=age,
        arm=arm or (script.joints if script else arm_motion(scenario)),
        feedforward=GravityFeedforward(belief) if scenario.arm.gravity_feedforward else None,
        period=period,
        board=rig.board,
        state=rig.state,
    )


def _deployed(
    emulated: EmulatedSystem | None, age: int, plant: Plant
) -> tuple[EmulatedSystem | None, int]:
    """Model and age of the estimate as the program has them, which effects may have changed."""
    numbers: dict[str, FloatArray] = {"gravity.age": np.array(float(age))}
    if emulated is not None:
        numbers["emulated.mass"] = emulated.mass.copy()
    for effect in plant.effects:
        effect.edit_computers(numbers)
    if emulated is not None:
        emulated = replace(emulated, mass=numbers["emulated.mass"])
    return emulated, round(float(numbers["gravity.age"]))


def _gravity(scenario: Scenario, belief: Belief, rig: Rig) -> GravityCompensation:
    task = GravityTask(
        belief=belief,
        truth=GravityTruth(rig.model, rig.data, rig.layout),
        learned=_learned(scenario, rig),
    )
    gravity = scenario.gravity
    compensation = GRAVITY_COMPENSATIONS[gravity.method](task)
    if gravity.error == 0.0:
        return compensation
    return ScaledCompensation(compensation, gravity.error, gravity.error_since)


def _learned(scenario: Scenario, rig: Rig) -> LearnedGravity | None:
    """W_g of the Learning Method, where the scenario plays it, checked against the scenario."""
    if scenario.gravity.method != "learned" or scenario.gravity.file is None:
        return None
    learned = LearnedGravity.load(scenario.gravity.file)
    learned.check(planned_experiment(scenario, rig.plant))
    return learned


def _calibrated(scenario: Scenario, belief: Belief, rig: Rig) -> Belief:
    """Load calibration matrix and P vector (Appendix E, step 8), where the scenario names them."""
    # a replay has method "none", and the calibration that the sensor was read with
    if scenario.gravity.method not in {"model", "none"} or scenario.gravity.file is None:
        return belief
    calibration = GravityCalibration.load(scenario.gravity.file)
    calibration.check(rig.plant.sensor_identity, belief.gravity.basis)
    rig.parameters["sensor"]["calibration"] = calibration.matrix
    rig.state["sensor"]["zero"] = calibration.zero
    return replace(belief, gravity=calibration.model(belief.gravity.basis))


def build_references(
    scenario: Scenario, plant: Plant, servo: Block
) -> dict[str, ZeroGravityReference]:
    """The zero-g references of a micro-gravity run: the ideal one, and one with the legs' lag.

    They have the servo as it is now; no button of the laboratory takes its torque.
    """
    emulated = emulated_of(scenario)
    if emulated is None or not scenario.has_reference:
        return {}
    lag = float(np.median(plant.actual.array("hydraulics.valve_lag")))  # legs may differ
    legs = (scenario.legs.gain, lag)
    return {
        name: ZeroGravityReference(
            plant=plant,
            emulated=emulated,
            servo=servo.copy(),
            start=np.array(scenario.platform.start),
            home=np.array(scenario.platform.home),
            arm_start=np.array(scenario.arm.start),
            legs=law,
        )
        for name, law in ((IDEAL, None), (LEG_LAG, legs))
    }


def emulated_of(scenario: Scenario) -> EmulatedSystem | None:
    """The system that the scenario emulates, if any."""
    name = scenario.platform.emulated
    return None if name is None else EmulatedSystem.load(name)


def agenda_of(scenario: Scenario) -> list[Event]:
    """What the scenario plans, as events in the order of time."""
    events = []
    operation = scenario.operation
    runs = operation is None or operation.begin is State.RUN
    if scenario.platform.emulated is not None and runs:
        events.append(Event(0.0, "released", "the platform moves as the emulated base"))
    for busy in scenario.platform.busy:
        message = f"cycles take {busy.extra * 1e3:.3g} ms longer for {busy.duration:.3g} s"
        events.append(Event(busy.start, "busy", message))
    if scenario.arm.operator is not None:
        events.append(Event(0.0, "operator", f"an operator commands: {scenario.arm.operator}"))
    if isinstance(scenario.platform.motion, SetpointMotion):
        file = scenario.platform.motion.file
        events.append(Event(0.0, "setpoints", f"set-points of {file} are played"))
    for number, move in enumerate(scenario.arm.moves, 1):
        angles = ", ".join(f"{angle:.4g}" for angle in move.to)
        events.append(Event(move.start, "arm_move", f"move {number} to {angles} rad begins"))
        events.append(Event(move.start + move.duration, "arm_move", f"move {number} ends"))
    path = scenario.arm.path
    if path is not None:
        events.append(Event(path.start, "arm_path", f"path of {len(path.through)} places begins"))
        events.append(Event(path.start + path.duration, "arm_path", "path ends"))
    return sorted(events, key=lambda event: event.time)


def _motion(platform: Platform, belief: Belief) -> PlatformMotion | None:
    start = np.array(platform.start)
    match platform.motion:
        case None:
            return None
        case SetpointMotion(file=file):
            return setpoint_motion(file, start, belief.geometry)
        case motion:
            return motion.build(start)
