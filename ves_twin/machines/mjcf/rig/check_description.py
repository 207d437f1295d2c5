"""check_description: whether a rig's file names what is there, and as wide as the model has it."""

from __future__ import annotations

import mujoco

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.units import to_si
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.description import Compared, Mode, RigDescription
from ves_twin.machines.mjcf.rig.places import SINGLE, driven_joint, typical_speed
from ves_twin.machines.mjcf.rig.tied import ties_of
from ves_twin.machines.mjcf.rig.transmission import Transmission

BALL = int(mujoco.mjtJoint.mjJNT_BALL)
FREE = int(mujoco.mjtJoint.mjJNT_FREE)


def check_description(told: RigDescription, model: mujoco.MjModel) -> None:
    """Hold a rig's file against its model.

    Raises:
        UnknownNameError: a signal, joint, actuator or sensor that is not there.
        InvalidInputError: no controller to follow set-points, a start that nothing measures,
            columns or noise of a signal that are not as many as the model has of it, a start in
            other units, a joint that neither moves as recorded nor is integrated or locked, or no
            typical speed of a joint with dry friction whose motion is given.
    """
    _signals(told)
    _parts(told, model)
    _units(told, model)
    _fed(told, model)
    _moved(told, model)
    _widths(told, model)
    _starts(told, model)
    _friction(told, model)
    _laws(told, model)


def _signals(told: RigDescription) -> None:
    for where, name in (
        *(("drive.joints", s) for s in told.drive.joints.values()),
        *(("drive.actuators", s) for s in told.drive.actuators.values()),
        *(("compare", s) for s in told.compare),
        *((f"controllers.{k}", c.reference) for k, c in told.controllers.items()),
    ):
        if name not in told.signals:
            raise UnknownNameError(f"signal in {where}", name, told.signals)
    for name, column in told.signals.items():
        if column.repeats > 1 and told.clock.poses:
            raise InvalidInputError(
                f"signals.{name}.repeats", column.repeats, "none of poses at rest"
            )
    if told.drive.mode is Mode.REFERENCE and not told.controllers:
        raise InvalidInputError("controllers", "none", "one where drive.mode is 'reference'")


def _parts(told: RigDescription, model: mujoco.MjModel) -> None:
    compared = told.compare.values()
    joints = [*told.drive.joints, *told.drive.locked, *told.start, *(c.joint for c in compared)]
    joints += [c.joint for c in told.controllers.values()]
    actuators = [*told.drive.actuators, *told.controllers, *(c.actuator for c in compared)]
    sensors = {model.sensor(i).name for i in range(model.nsensor)}
    for names, what, there in (
        (joints, "joint", {model.joint(i).name for i in range(model.njnt)}),
        (actuators, "actuator", {model.actuator(i).name for i in range(model.nu)}),
        ([c.sensor for c in compared], "sensor", sensors),
    ):
        for name in filter(None, names):
            if name not in there:
                raise UnknownNameError(f"{what} in {told.model}", name, there)


def _units(told: RigDescription, model: mujoco.MjModel) -> None:
    """Of signals that say their joint themselves."""
    for name, signal in told.signals.items():
        kind = int(model.jnt_type[model.joint(signal.joint).id]) if signal.joint else FREE
        if kind in (FREE, BALL):
            continue
        expected = joint_units(model, signal.joint)[signal.of == "speed"]
        if signal.unit != expected:
            what = f"signals.{name}.unit"
            raise InvalidInputError(
                what, signal.unit, f"{expected}, as joint {signal.joint} has it"
            )


def _fed(told: RigDescription, model: mujoco.MjModel) -> None:
    """Something is fed in, but of a model without actuators, which may be let go."""
    drive = told.drive
    if model.nu and drive.mode is Mode.CONTROL and not (drive.actuators or drive.imposed):
        expected = "drive.actuators or drive.imposed; none only of a model without actuators"
        raise InvalidInputError("drive, mode 'control'", "nothing that is fed in", expected)


def _moved(told: RigDescription, model: mujoco.MjModel) -> None:
    """Every joint moves as recorded, is integrated, or is locked: none of them by silence."""
    drive = told.drive
    for joint in drive.imposed:
        if joint not in drive.joints:
            raise UnknownNameError("joint in drive.imposed", joint, drive.joints)
        if joint in drive.locked or int(model.jnt_type[model.joint(joint).id]) not in SINGLE:
            expected = "a hinge or a slide that is not locked"
            raise InvalidInputError("drive.imposed", joint, expected)
    if drive.mode is Mode.MOTION:
        follow = {one.joint for one in ties_of(told, model).followers}
        for joint in (model.joint(i).name for i in range(model.njnt)):
            if joint not in {*drive.joints, *drive.locked, *follow}:
                expected = (
                    f"its signal in drive.joints, drive.locked with {joint} if it stands still,"
                    " or mode 'control' with the other joints in drive.imposed to integrate it"
                )
                raise InvalidInputError(f"joint {joint}, mode 'motion'", "no motion", expected)
        compared = [one.actuator for one in told.compare.values() if one.actuator]
        for actuator in compared:
            Transmission.of(model, actuator, compared)
        return
    for actuator in [*(told.controllers if drive.mode is Mode.REFERENCE else drive.actuators)]:
        name = driven_joint(model, actuator)
        if name in (*drive.imposed, *drive.locked):
            expected = f"joint {name} either moved by it, or imposed or locked"
            raise InvalidInputError(f"actuator {actuator}", "fed in", expected)


def _widths(told: RigDescription, model: mujoco.MjModel) -> None:
    """Columns and noise of each signal: what the model does not have would shift all behind it."""
    wanted = {}
    for joint, signal in told.drive.joints.items():
        kind = int(model.jnt_type[model.joint(joint).id])
        if kind == BALL:
            expected = (
                "a hinge, a slide or a free joint: three hinges (yaw, pitch, roll) turn as it"
            )
            raise InvalidInputError(f"drive.joints.{joint}", "a ball joint", expected)
        free = kind == FREE
        wanted[signal] = (7, f"free joint {joint}") if free else (1, f"joint {joint}")
    for actuator, signal in told.drive.actuators.items():
        wanted[signal] = 1, f"actuator {actuator}"
    for actuator, controller in told.controllers.items():
        wanted[controller.reference] = 1, f"controllers.{actuator}"
    for signal, compared in told.compare.items():
        wanted[signal] = _width(compared, model)
    for signal, column in told.signals.items():
        width = len(column.columns)
        count, what = wanted.get(signal, (width, ""))
        if width != count:
            expected = f"{count}, as {what} has it"
            if width == 1 and count == len("xyz"):
                expected += '; axis = "z" for one of them'
            raise InvalidInputError(f"signals.{signal}.columns", list(column.columns), expected)
        if isinstance(column.noise, tuple) and len(column.noise) not in (1, width):
            expected = f"one number, or {width} as it has columns"
            raise InvalidInputError(f"signals.{signal}.noise", column.noise, expected)


def _width(compared: Compared, model: mujoco.MjModel) -> tuple[int, str]:
    if compared.sensor:
        width = int(model.sensor(compared.sensor).dim[0])
        if compared.axis and width != len("xyz"):
            came = f"axis {compared.axis} of sensor {compared.sensor}, which has {width}"
            raise InvalidInputError("axis", came, "a sensor of three numbers")
        return (1 if compared.axis else width), f"sensor {compared.sensor}"
    if compared.actuator:
        return 1, f"actuator {compared.actuator}"
    return 1, f"joint {compared.joint}"


def _friction(told: RigDescription, model: mujoco.MjModel) -> None:
    """Dry friction of a given motion turns its sign round over a share of the typical speed."""
    given = told.drive.joints if told.drive.mode is Mode.MOTION else told.drive.imposed
    for compared in told.compare.values():
        name = driven_joint(model, compared.actuator) if compared.actuator else ""
        if name in given and model.dof_frictionloss[model.joint(name).dofadr[0]] > 0.0:
            typical_speed(name, told, model)


def _starts(told: RigDescription, model: mujoco.MjModel) -> None:
    measured = {*(c.joint for c in told.compare.values()), *told.drive.joints}
    for joint, start in told.start.items():
        if start.position == "measured" and joint not in measured:
            expected = "a signal of its position, or of its speed"
            raise InvalidInputError(f"start.{joint}", "measured", expected)
        place, speed = joint_units(model, joint)
        if start.position not in ("measured", "recorded"):
            to_si(start.position, place, f"start.{joint}.position")
        to_si(start.speed, speed, f"start.{joint}.speed")
        if (there := start.elsewhere) is not None:
            for value in (there.position, there.sd):
                to_si(value, place, f"start.{joint}.elsewhere")
            for value in (there.speed, there.speed_sd):
                to_si(value, speed, f"start.{joint}.elsewhere")


def _laws(told: RigDescription, model: mujoco.MjModel) -> None:
    """Places and variables of laws."""
    single = [model.joint(i).name for i in range(model.njnt) if int(model.jnt_type[i]) in SINGLE]
    columns = [
        name if len(told.signals[name].columns) == 1 else f"{name}.{i + 1}"
        for name in told.compare
        for i in range(len(told.signals[name].columns))
    ]
    moving = [f"{what}@{joint}" for what in ("position", "speed") for joint in single]
    fed = [*told.drive.actuators, *told.controllers]
    known = {"time", *moving, *(f"command@{name}" for name in fed)}
    for law in told.laws:
        law.check(single, columns, known)
