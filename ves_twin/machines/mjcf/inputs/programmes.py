"""multisine and releases: what blind suites feed in, and what is let go from a start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects.joints import ForceOffset
from ves_twin.effects.place import Place
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.started import start_signal
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import place_of
from ves_twin.machines.mjcf.rig.transmission import arms_of

TONES = 5
"""Of a multisine."""

FADE = 0.25
"""Time in which a command fades in [s]: from rest it begins with none."""

BAND = (1.25, 16.0)
"""Band of a file that says none, as multiples of the typical speed over 2 pi times the travel."""

FARTHEST = 1.6
"""Typical travels beyond which no programme may take a joint: a right angle, where travel is 1."""


@dataclass(frozen=True)
class Multisine:
    """One programme, in shares of what is typical.

    Attributes:
        name: for people.
        amplitude: of a tone, as a share of the typical effort, or of the travel for set-points.
        band: lowest and highest tone, as multiples of the machine's band.
        held: position that joints are let go from, as a share of the typical travel.
    """

    name: str
    amplitude: float
    band: tuple[float, float] = (1.0, 1.0)
    held: float = 0.0


RELEASES = (
    Multisine("let go from 0.1 of the travel", 0.0, held=0.1),
    Multisine("let go from 0.6 of the travel", 0.0, held=0.6),
    Multisine("let go from 1.2 of the travel", 0.0, held=1.2),
    Multisine("let go from 0.6 of the travel into a multisine", 0.3, held=0.6),
)
"""From a start that the recording says: they part a delay of the sensors from one of commands.
None goes beyond `FARTHEST`: near the top a pendulum tells rounding errors, and no cause."""


def releases(rig: Rig) -> tuple[Excitation, ...]:
    """Commands and starts of every release that is safe; the same each time.

    None where the file has no start that recordings may change (`start.JOINT.elsewhere`).
    """
    joints = [j for j, s in rig.description.start.items() if s.position != "measured" and s.told]
    if not joints or rig.description.drive.mode is not Mode.CONTROL:
        return ()
    forward, found = MjcfForward.of(rig), []
    for number, one in enumerate(RELEASES):
        duration = rig.description.excitation.duration
        fed = multisine(rig, np.random.default_rng([7, number]), duration, one)
        fade = np.minimum(fed.time / FADE, 1.0)[:, None]
        drive = {name: fade * rows for name, rows in fed.drive.items()}
        for joint in joints:
            start = np.array([one.held * joint_of(rig, joint).travel, 0.0])
            drive[start_signal(joint)] = np.tile(start, (len(fed.time), 1))
        programme = Excitation(one.name, fed.time, drive, rate=fed.rate)
        if _stays(forward, programme):
            found.append(programme)
    return tuple(found)


def multisine(
    rig: Rig, rng: np.random.Generator, duration: float, one: Multisine | None = None
) -> Excitation:
    """Tones drawn for every command, set-point or position that is fed in.

    Args:
        rig: the two files.
        rng: of frequencies and phases.
        duration: length [s].
        one: band and amplitude; those of the rig's file if None.
    """
    told = rig.description
    chosen = one or Multisine("multisine", told.excitation.amplitude)
    period = told.excitation.period or float(rig.model.opt.timestep)
    time = np.asarray(period * np.arange(round(duration / period)), float)
    drive = {}
    for signal, at, size in driven(rig):
        natural = at.speed / (2.0 * np.pi * at.travel)
        low, high = told.excitation.band or (BAND[0] * natural, BAND[1] * natural)
        band = chosen.band[0] * low, chosen.band[1] * high
        frequencies = rng.uniform(*band, TONES)
        tones = zip(frequencies, rng.uniform(0.0, 2.0 * np.pi, TONES), strict=True)
        sines = sum(np.sin(2.0 * np.pi * f * time + phase) for f, phase in tones)
        drive[signal] = np.asarray(chosen.amplitude * size * sines)[:, None]
    return Excitation(chosen.name, time, drive, rate=told.rate)


def driven(rig: Rig) -> list[tuple[str, Place, float]]:
    """Signals that are fed in, the joint that each moves, and its typical size in that signal.

    Of a command, what gives the typical effort; of a position, a share of the typical travel such
    that all tones together stay within it.
    """
    told, model = rig.description, rig.model
    imposed = [(signal, joint_of(rig, j)) for j, signal in MjcfForward.of(rig).imposed.items()]
    moved = [(signal, at, at.travel / TONES) for signal, at in imposed]
    if told.drive.mode is not Mode.CONTROL:
        fed = [(c.reference, c.joint) for c in told.controllers.values()]
        if told.drive.mode is Mode.MOTION:
            fed = [(signal, joint) for joint, signal in told.drive.joints.items()]
        places = [(signal, joint_of(rig, joint)) for signal, joint in fed]
        return [*((signal, at, at.travel / TONES) for signal, at in places), *moved]
    found = []
    for name, signal in told.drive.actuators.items():
        arms = arms_of(model, name)
        if not arms:
            came = "on a site or body, of which no joint has a typical effort"
            raise InvalidInputError(f"actuator {name}", came, "one on a joint or a fixed tendon")
        joint = max(arms, key=lambda one: abs(arms[one]))
        at = joint_of(rig, joint)
        found.append((signal, at, at.effort / abs(arms[joint])))
    return [*found, *moved]


def joint_of(rig: Rig, joint: str) -> Place:
    """A joint with its typical sizes.

    Raises:
        InvalidInputError: the file says none.
    """
    return place_of(ForceOffset(joint), rig.description, rig.model)


def _stays(forward: MjcfForward, programme: Excitation) -> bool:
    """Whether every measured position is predicted to stay near its typical travel."""
    rows, column = forward.simulate(programme, {}), 0
    for name, compared in forward.compared.items():
        if compared.joint and compared.of == "position":
            reach = FARTHEST * joint_of(forward.rig, compared.joint).travel
            if not np.all(np.abs(rows[:, column]) <= reach):
                return False
        column += len(forward.rig.description.signals[name].columns)
    return True
