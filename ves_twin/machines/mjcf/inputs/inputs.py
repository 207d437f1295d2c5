"""Input and strain: what is fed in at a joint, and how near a programme goes to the limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.core.units import to_si
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.started import start_signal
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.description import Mode, Span

BORNE = 1.5
"""Times typical speed and travel that a joint may reach: what is typical is not the most."""


@dataclass(frozen=True)
class Input:
    """What is fed in at a joint, an effort or a position: its typical sizes and its limits.

    Attributes:
        signal: that is fed in.
        joint: that it moves.
        commanded: whether it is an effort.
        effort: typical one, in the signal.
        speed, travel: typical ones of the joint.
        rest: value at rest.
        low, high: the model's own limits of the signal.
    """

    signal: str
    joint: str
    commanded: bool
    effort: float
    speed: float
    travel: float
    rest: float
    low: float
    high: float

    @property
    def corner(self) -> float:
        """Frequency [Hz] of the sine that has both typical travel and typical speed."""
        return self.speed / (np.pi * self.travel)

    def rows(self, shape: FloatArray, time: FloatArray) -> FloatArray:
        """A shape of peak 1 (n,) as large as typical sizes and the model's limits let it (n, 1).

        An effort takes all of the typical one, a position half the travel, at the typical speed.
        """
        size = self.effort
        if not self.commanded:
            fastest = float(np.max(np.abs(np.gradient(shape, time))))
            size = min(0.5 * self.travel, self.speed / fastest)
        return np.asarray(np.clip(self.rest + size * shape, self.low, self.high)[:, None])


def inputs_of(forward: MjcfForward, like: Recording | None = None) -> list[Input]:
    """One for each signal fed in; none at all where one of them cannot be bounded.

    Args:
        forward: in the mode in which it is fed.
        like: gives where positions rest; the model if None.
    """
    told, model = forward.rig.description, forward.rig.model
    places: dict[Mode, list[tuple[str, str, str]]] = {
        Mode.MOTION: [(s, j, "") for j, s in told.drive.joints.items()],
        Mode.CONTROL: [(s, forward.joint_of(a), a) for a, s in told.drive.actuators.items()],
        Mode.REFERENCE: [(c.reference, c.joint, "") for c in told.controllers.values()],
    }
    moved = told.drive.joints if forward.mode is Mode.MOTION else forward.imposed
    found = []
    for signal, joint, actuator in [
        *places[forward.mode],
        *((s, j, "") for j, s in forward.imposed.items()),
    ]:
        if not joint:
            return []
        effort, speed, travel = sizes_of(forward, joint)
        needed = (effort, speed, travel) if actuator else (speed, travel)
        watched = joint in moved or forward.position_of(joint) in forward.compared
        if min(needed) <= 0.0 or not watched or len(told.signals[signal].columns) != 1:
            return []
        rest = 0.0
        if actuator:
            part = model.actuator(actuator)
            gain = abs(float(part.gear[0] * part.gainprm[0]))
            effort, (low, high) = effort / (gain or 1.0), _commands(forward, actuator)
        else:
            low, high = range_of(forward, joint)
            rest = float(model.qpos0[model.jnt_qposadr[model.joint(joint).id]])
            known = forward.position_of(joint)
            if like is not None and known in like.signals:
                rest = float(like[known][0, 0])
        found.append(Input(signal, joint, bool(actuator), effort, speed, travel, rest, low, high))
    return found


def sizes_of(forward: MjcfForward, joint: str) -> tuple[float, float, float]:
    """Typical effort, speed and travel of a joint, SI; zero where the file says none."""
    span = forward.rig.description.typical.joint.get(joint, Span())
    place, speed = joint_units(forward.rig.model, joint)
    units = ("N*m" if place == "rad" else "N", speed, place)
    given = (span.effort, span.speed, span.travel)
    pairs = zip(given, units, strict=True)
    effort, fastest, travel = (
        to_si(value, unit, f"typical.joint.{joint}") for value, unit in pairs
    )
    return effort, fastest, travel


def range_of(forward: MjcfForward, joint: str) -> tuple[float, float]:
    """Lowest and highest position of a joint by its model; infinite where it has no range."""
    number = forward.rig.model.joint(joint).id
    if not forward.rig.model.jnt_limited[number]:
        return -np.inf, np.inf
    low, high = forward.rig.model.jnt_range[number]
    return float(low), float(high)


def strain(forward: MjcfForward, excitation: Excitation) -> float:
    """The largest share that the nominal machine takes of what it bears: 1 is all of it.

    Of BORNE times typical travel and speed, from the start on, and of the model's joint ranges.
    The speed of a joint that is let go is what the machine makes of its travel, and not counted.
    """
    names = [channel.name for channel in forward.channels]
    moved = forward.simulate(excitation, {})
    if not np.all(np.isfinite(moved)):
        return np.inf
    worst = 0.0
    for joint in forward.rig.description.typical.joint:
        known = forward.position_of(joint)
        _, speed, travel = sizes_of(forward, joint)
        if known not in names or not (speed > 0.0 and travel > 0.0):
            continue
        path = moved[:, names.index(known)]
        released = bool(np.any(excitation.drive.get(start_signal(joint), np.zeros(1))[0]))
        rest = 0.0 if released else path[0]
        worst = max(worst, float(np.max(np.abs(path - rest))) / (BORNE * travel))
        if not released:
            fastest = float(np.max(np.abs(np.gradient(path, excitation.time))))
            worst = max(worst, fastest / (BORNE * speed))
        low, high = range_of(forward, joint)
        sign = forward.compared[known].sign
        if np.any((sign * path < low) | (sign * path > high)):
            worst = max(worst, _beyond(sign * path, low, high))
    return worst


def _beyond(path: FloatArray, low: float, high: float) -> float:
    """Share of the room between start and stop that a path takes beyond it: more than 1."""
    room = np.array([path[0] - low, high - path[0]])
    taken = np.array([path[0] - np.min(path), np.max(path) - path[0]])
    return float(np.max(taken / np.maximum(room, 1e-9)))


def _commands(forward: MjcfForward, actuator: str) -> tuple[float, float]:
    """Lowest and highest command of an actuator by its model, and by the force that it may give."""
    model = forward.rig.model
    number = model.actuator(actuator).id
    low, high = -np.inf, np.inf
    if model.actuator_ctrllimited[number]:
        low, high = (float(value) for value in model.actuator_ctrlrange[number])
    gain = float(model.actuator_gainprm[number, 0])
    if model.actuator_forcelimited[number] and gain != 0.0:
        ends = sorted(model.actuator_forcerange[number] / gain)
        low, high = max(low, float(ends[0])), min(high, float(ends[1]))
    return low, high
