"""assemble: the MJCF parts joined into one MjSpec, with every number from the parameter table."""

from __future__ import annotations

import mujoco
import numpy as np

from ves_twin.core.errors import InvalidInputError, one_line
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.gravity_model import gravity_in_top
from ves_twin.mechanics.kinematics.stewart import StewartGeometry
from ves_twin.plant.arm_part import arm_part
from ves_twin.plant.fidelity import Fidelity
from ves_twin.plant.leg_part import leg_part
from ves_twin.plant.parameters import LEGS, ParameterTable
from ves_twin.plant.plant import Plant, mjcf_part
from ves_twin.plant.tendon_legs import add_tendon_legs

JOINTS = ("q1", "q2", "q3")

CLOSURE_SOLIMP = (0.9999, 0.99999, 0.001, 0.5, 2.0)
"""Impedance of the leg closure, nearly rigid: keeps the loop closed to micrometres."""

FRICTION_SOLIMP = (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""Impedance of dry friction, the engine's highest: its default lets a leg that should stick creep
by centimetres a second (docs/decisions/0008-dry-friction.md)."""


def assemble(plant: Plant, timestep: float) -> mujoco.MjSpec:
    """The whole rig as an MjSpec: frame, six legs, platform, force sensor, arm.

    In `full` the chain closes through `connect` constraints between rod ends and platform joints,
    with a time constant of two steps; in `fast` the legs are tendons without bodies. The hydraulic
    and joint forces enter through plain motors.

    Args:
        plant: the rig.
        timestep: physics step [s].

    Returns:
        A specification that compiles; names are prefixed leg1/ ... leg6/, platform/, sensor/, arm/.
    """
    parameters, geometry = plant.actual, plant.geometry
    spec = _part("frame.xml")
    spec.modelname = plant.name
    spec.option.timestep = timestep
    spec.option.gravity = _gravity(parameters)
    if plant.fidelity is Fidelity.FULL:
        _attach_legs(spec, parameters, geometry)
    platform = _platform(_part("platform.xml"), parameters, geometry.top)
    home = spec.worldbody.add_frame(pos=geometry.home)
    spec.attach(platform, prefix="platform/", frame=home)
    sensor = _part("sensor.xml")
    sensor.site("wrench").pos = parameters.array("sensor.position")
    spec.attach(sensor, prefix="sensor/", site=spec.site("platform/top"))
    spec.attach(_arm(plant), prefix="arm/", site=spec.site("sensor/mount"))
    if plant.fidelity is Fidelity.FULL:
        _close_legs(spec, timestep)
    else:
        number = parameters.number
        add_tendon_legs(spec, geometry, number("leg.rod_mass"), number("leg.rod_radius"))
    _stick(spec, plant.fidelity, parameters, timestep)
    _actuators_and_sensors(spec, plant.fidelity)
    for effect in plant.effects:
        effect.edit_rig(spec)
    return spec


def compile_model(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Compile a specification.

    Raises:
        InvalidInputError: numbers that no rigid body can have, in MuJoCo's words.
    """
    try:
        return spec.compile()
    except ValueError as error:
        raise InvalidInputError(
            f"plant {spec.modelname}", one_line(error), "a rig that MuJoCo can compile"
        ) from None


def assemble_free_arm(plant: Plant) -> mujoco.MjSpec:
    """The arm on a base with six free coordinates and without gravity, for the zero-g reference.

    The base moves by three slides along X, Y, Z and three hinges about Z, Y, X, so that its
    coordinates are those of a platform pose, R = Rz Ry Rx. Joints: x y z rz ry rx q1 q2 q3.
    """
    spec = mujoco.MjSpec()
    spec.modelname = f"{plant.name} zero-g"
    spec.compiler.degree = False
    spec.compiler.fusestatic = False
    spec.option.gravity = [0.0, 0.0, 0.0]
    spec.option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    base = spec.worldbody.add_body(name="base")
    slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
    for name, kind, axis in (
        ("x", slide, (1, 0, 0)),
        ("y", slide, (0, 1, 0)),
        ("z", slide, (0, 0, 1)),
        ("rz", hinge, (0, 0, 1)),
        ("ry", hinge, (0, 1, 0)),
        ("rx", hinge, (1, 0, 0)),
    ):
        base.add_joint(name=name, type=kind, axis=axis)
    mount = base.add_site(name="mount")
    spec.attach(_arm(plant), prefix="arm/", site=mount)
    return spec


def assemble_fixed_arm(plant: Plant) -> mujoco.MjSpec:
    """The arm alone on a fixed base, gravity on, rotors in `armature`."""
    spec = _arm(plant)
    spec.option.gravity = [0.0, 0.0, -plant.parameters.number("gravity")]
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return spec


def _gravity(parameters: ParameterTable) -> FloatArray:
    """Acceleration of gravity in the rig's axes, which a base that is not level turns (3,)."""
    level = np.array([[*parameters.array("platform.level"), 0.0]])
    return np.asarray(gravity_in_top(level, parameters.number("gravity"))[0])


def _part(file: str) -> mujoco.MjSpec:
    return mujoco.MjSpec.from_file(str(mjcf_part(file)))


def _arm(plant: Plant) -> mujoco.MjSpec:
    arm = arm_part(_part("puma560.xml"), plant.actual)
    for effect in plant.effects:
        effect.edit_arm(arm)
    return arm


def _platform(spec: mujoco.MjSpec, parameters: ParameterTable, joints: FloatArray) -> mujoco.MjSpec:
    top = spec.body("top")
    top.mass = parameters.number("platform.mass")
    top.inertia = parameters.array("platform.inertia")
    top.ipos = [0.0, 0.0, parameters.number("platform.com_height")]
    for i in range(LEGS):
        top.add_site(name=f"joint{i + 1}", pos=joints[i])
    return spec


def _attach_legs(
    spec: mujoco.MjSpec, parameters: ParameterTable, geometry: StewartGeometry
) -> None:
    for i in range(LEGS):
        leg, frame_quat = leg_part(_part("leg.xml"), parameters, geometry, i)
        base = spec.worldbody.add_frame(pos=geometry.base[i], quat=frame_quat)
        spec.attach(leg, prefix=f"leg{i + 1}/", frame=base)


def _close_legs(spec: mujoco.MjSpec, timestep: float) -> None:
    for i in range(1, LEGS + 1):
        closure = spec.add_equality(
            name=f"closure{i}",
            type=mujoco.mjtEq.mjEQ_CONNECT,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            name1=f"leg{i}/rod_end",
            name2=f"platform/joint{i}",
        )
        closure.solref = np.array([2.0 * timestep, 1.0])
        closure.solimp = np.array(CLOSURE_SOLIMP)


def _stick(
    spec: mujoco.MjSpec, fidelity: Fidelity, parameters: ParameterTable, timestep: float
) -> None:
    """Stiff dry friction in cylinders and arm joints; without friction it makes no constraint."""
    friction = parameters.array("leg.dry_friction")
    rubbing = [spec.joint(f"arm/{joint}") for joint in JOINTS]
    for i in range(LEGS):
        full = fidelity is Fidelity.FULL
        rod = spec.joint(f"leg{i + 1}/slide") if full else spec.tendon(f"leg{i + 1}")
        rod.frictionloss = friction[i]
        rubbing.append(rod)
    for part in rubbing:
        part.solref_friction = np.array([2.0 * timestep, 1.0])
        part.solimp_friction = np.array(FRICTION_SOLIMP)


def _actuators_and_sensors(spec: mujoco.MjSpec, fidelity: Fidelity) -> None:
    joint, tendon = mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_TENDON
    for i in range(1, LEGS + 1):
        rod = (f"leg{i}/slide", joint) if fidelity is Fidelity.FULL else (f"leg{i}", tendon)
        spec.add_actuator(name=f"leg{i}", target=rod[0], trntype=rod[1]).set_to_motor()
    for name in JOINTS:
        spec.add_actuator(name=name, target=f"arm/{name}", trntype=joint).set_to_motor()
    for name, kind in (
        ("force", mujoco.mjtSensor.mjSENS_FORCE),
        ("torque", mujoco.mjtSensor.mjSENS_TORQUE),
    ):
        spec.add_sensor(
            name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="sensor/wrench"
        )
