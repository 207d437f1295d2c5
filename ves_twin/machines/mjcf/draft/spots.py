"""Spot: a number of a model that a column of a log may hold."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import mujoco
import numpy as np

from ves_twin.core.types import BoolArray
from ves_twin.machines.mjcf.parts.servo import is_servo

HINGE, SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
ON_JOINT = int(mujoco.mjtTrn.mjTRN_JOINT)

SENSOR_UNITS = {
    "ACCELEROMETER": "m/s^2",
    "VELOCIMETER": "m/s",
    "GYRO": "rad/s",
    "FORCE": "N",
    "TORQUE": "N*m",
    "FRAMEPOS": "m",
    "FRAMELINVEL": "m/s",
    "FRAMEANGVEL": "rad/s",
    "FRAMELINACC": "m/s^2",
}
"""Kinds of MuJoCo sensors that no joint or actuator stands for -> unit."""

TURNING, TURNS = ("GYRO", "FRAMEANGVEL"), (("roll",), ("pitch",), ("yaw",))
"""Kinds of sensors of three rates, and what else these are called."""

STANDS_FOR = {"JOINTPOS", "JOINTVEL", "ACTUATORFRC", "JOINTACTFRC"}
"""Sensors whose number a joint or an actuator has, too; their names count as names of that."""

POSES, NUDGE = 4, 0.1
"""States at which sensors are read to see which numbers change, and how far they are off [s]."""

STILL = 1e-6
"""Share of a sensor's largest change below which a number of it stands still: rounding."""


class Quantity(StrEnum):
    """What a column may measure."""

    POSITION = "position"
    SPEED = "speed"
    EFFORT = "effort"
    SENSOR = "sensor"


@dataclass(frozen=True)
class Spot:
    """A place of a model with a number.

    Attributes:
        quantity: what it is.
        name: of the joint, actuator or sensor.
        unit: SI; of an actuator that of its command, "1" where that is neither an effort nor a
            position.
        words: that a column's name may share with it, lower case.
        number: its place among those of its quantity from 1, or that of its name.
        joint: that an actuator drives; empty where it drives none.
        axis: of a sensor with several numbers, from 0.
        width: numbers of that sensor.
        moves: whether any motion of the model changes that number.
        exerts: unit of what an actuator exerts; empty where that is both, or on a tendon.
    """

    quantity: Quantity
    name: str
    unit: str
    words: frozenset[str]
    number: int
    joint: str = ""
    axis: int = 0
    width: int = 1
    moves: bool = True
    exerts: str = ""

    @property
    def label(self) -> str:
        """For people: "joint rail", "sensor imu, 2 of 3"."""
        if self.quantity is Quantity.EFFORT:
            return f"actuator {self.name}"
        if self.quantity is Quantity.SENSOR:
            return f"sensor {self.name}" + (
                f", {self.axis + 1} of {self.width}" if self.width > 1 else ""
            )
        return f"{self.quantity.value} of joint {self.name}"


def spots_of(model: mujoco.MjModel) -> tuple[Spot, ...]:
    """Every spot of the named joints, actuators and sensors of a model."""
    extra, moving = _stand_ins(model), _moving(model)
    found = _joints(model, extra) + _actuators(model, extra)
    for i in range(model.nsensor):
        sensor = model.sensor(i)
        kind = mujoco.mjtSensor(int(model.sensor_type[i])).name.removeprefix("mjSENS_")
        if kind in STANDS_FOR or not sensor.name:
            continue
        width = int(model.sensor_dim[i])
        turns = TURNS if kind in TURNING else ((), (), ())
        found += [
            Spot(
                Quantity.SENSOR,
                sensor.name,
                SENSOR_UNITS.get(kind, "1"),
                frozenset(
                    {
                        *words_of(sensor.name),
                        *(("xyz"[axis], *turns[axis]) if width == 3 else ()),
                    }
                ),
                axis + 1,
                axis=axis,
                width=width,
                moves=bool(moving[int(model.sensor_adr[i]) + axis]),
            )
            for axis in range(width)
        ]
    return tuple(found)


def single_joints(model: mujoco.MjModel) -> list[int]:
    """Numbers of the named joints that turn or slide."""
    kinds = (HINGE, SLIDE)
    return [i for i in range(model.njnt) if int(model.jnt_type[i]) in kinds and model.joint(i).name]


def is_motor(model: mujoco.MjModel, actuator: int) -> bool:
    """Whether a command times a constant is the effort at one joint."""
    plain = int(mujoco.mjtBias.mjBIAS_NONE), int(mujoco.mjtDyn.mjDYN_NONE)
    kinds = int(model.actuator_biastype[actuator]), int(model.actuator_dyntype[actuator])
    return kinds == plain and int(model.actuator_trntype[actuator]) == ON_JOINT


def is_damped_motor(model: mujoco.MjModel, actuator: int) -> bool:
    """Whether a command times a constant is the effort at one joint at rest: a voltage, too.

    With the speed's share of an affine bias, which is a motor's back-EMF.
    """
    own = model.actuator_biasprm[actuator]
    braked = int(model.actuator_biastype[actuator]) == int(mujoco.mjtBias.mjBIAS_AFFINE)
    plain = int(model.actuator_dyntype[actuator]) == int(mujoco.mjtDyn.mjDYN_NONE)
    on_joint = int(model.actuator_trntype[actuator]) == ON_JOINT
    damps = braked and plain and on_joint and not np.any(own[:2]) and float(own[2]) <= 0.0
    return damps or is_motor(model, actuator)


def servo_limit(model: mujoco.MjModel, name: str) -> float:
    """Largest effort of a servo [N or N m]; 0 where the model has no limit, or no such servo."""
    number = model.actuator(name).id
    if not is_servo(model, number) or not model.actuator_forcelimited[number]:
        return 0.0
    return float(np.max(np.abs(model.actuator_forcerange[number])))


def _moving(model: mujoco.MjModel) -> BoolArray:
    """Which numbers of all sensors change where every joint moves (n,)."""
    data, rng, rows = mujoco.MjData(model), np.random.default_rng(0), []
    for _ in range(POSES):
        mujoco.mj_resetData(model, data)
        mujoco.mj_integratePos(model, data.qpos, rng.normal(size=model.nv), NUDGE)
        data.qvel[:] = rng.normal(size=model.nv)
        mujoco.mj_forward(model, data)
        rows.append(data.sensordata.copy())
    change, found = np.ptp(np.array(rows), axis=0), np.ones(model.nsensordata, bool)
    for i in range(model.nsensor):
        first, width = int(model.sensor_adr[i]), int(model.sensor_dim[i])
        own = change[first : first + width]
        found[first : first + width] = own > STILL * max(own, default=0.0)
    return found


def words_of(name: str) -> tuple[str, ...]:
    """Words and numbers of a name: "rightElbow_2" has right, elbow, 2."""
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name)
    return tuple(part.lower() for part in parts)


def own_number(name: str) -> int | None:
    """The last number in a name; None if it has none."""
    numbers = re.findall(r"\d+", name)
    return int(numbers[-1]) if numbers else None


def _joints(model: mujoco.MjModel, extra: dict[tuple[str, int], set[str]]) -> list[Spot]:
    joints = single_joints(model)
    numbers = _numbers([model.joint(i).name for i in joints])
    found = []
    for quantity in (Quantity.POSITION, Quantity.SPEED):
        for i, number in zip(joints, numbers, strict=True):
            unit = "rad" if int(model.jnt_type[i]) == HINGE else "m"
            unit += "/s" if quantity is Quantity.SPEED else ""
            body = model.body(int(model.jnt_bodyid[i])).name
            words = {*words_of(model.joint(i).name), *words_of(body)}
            words |= extra.get((quantity, i), set())
            found.append(Spot(quantity, model.joint(i).name, unit, frozenset(words), number))
    return found


def _actuators(model: mujoco.MjModel, extra: dict[tuple[str, int], set[str]]) -> list[Spot]:
    named = [i for i in range(model.nu) if model.actuator(i).name]
    numbers = _numbers([model.actuator(i).name for i in named])
    found = []
    for i, number in zip(named, numbers, strict=True):
        joint, unit = "", "1"
        if int(model.actuator_trntype[i]) == ON_JOINT:
            at = int(model.actuator_trnid[i, 0])
            joint = model.joint(at).name
            gain = model.actuator_gear[i, 0] * model.actuator_gainprm[i, 0]
            hinge = int(model.jnt_type[at]) == HINGE
            if is_motor(model, i) and gain == 1.0:
                unit = "N*m" if hinge else "N"
            elif is_servo(model, i):
                unit = "rad" if hinge else "m"
        words = {*words_of(model.actuator(i).name), *words_of(joint)}
        words |= extra.get((Quantity.EFFORT, i), set())
        name = model.actuator(i).name
        exerts = _exerted(model, i)
        found.append(
            Spot(Quantity.EFFORT, name, unit, frozenset(words), number, joint, exerts=exerts)
        )
    return found


def _exerted(model: mujoco.MjModel, actuator: int) -> str:
    """Unit of what an actuator exerts: at a joint by its kind, at a site by its gear."""
    kind, at = int(model.actuator_trntype[actuator]), int(model.actuator_trnid[actuator, 0])
    if kind == ON_JOINT:
        return {HINGE: "N*m", SLIDE: "N"}.get(int(model.jnt_type[at]), "")
    pushes, turns = np.any(model.actuator_gear[actuator].reshape(2, 3) != 0.0, axis=1)
    if kind != int(mujoco.mjtTrn.mjTRN_SITE) or pushes == turns:
        return ""
    return "N" if pushes else "N*m"


def _stand_ins(model: mujoco.MjModel) -> dict[tuple[str, int], set[str]]:
    """Words of the sensors that read a joint or an actuator: (quantity, number) -> words."""
    of = {"JOINTPOS": Quantity.POSITION, "JOINTVEL": Quantity.SPEED, "ACTUATORFRC": Quantity.EFFORT}
    found: dict[tuple[str, int], set[str]] = {}
    for i in range(model.nsensor):
        kind = mujoco.mjtSensor(int(model.sensor_type[i])).name.removeprefix("mjSENS_")
        if kind in of:
            at = of[kind], int(model.sensor_objid[i])
            found.setdefault(at, set()).update(words_of(model.sensor(i).name))
    return found


def _numbers(names: Sequence[str]) -> list[int]:
    """The number at the end of each name where none of its kind has the same, else its place.

    Names are of a kind that are the same but for numbers: slide1 and slide2, not cardan1a.
    """
    told = [(re.sub(r"\d+", "#", name), own_number(name)) for name in names]
    return [
        own if own is not None and told.count((kind, own)) == 1 else place
        for place, (kind, own) in enumerate(told, 1)
    ]
