"""applied: an MJCF machine and a recording of it as an experiment file says."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.recording.stretch import compared_stretch
from ves_twin.core.units import to_si
from ves_twin.effects.element import Element
from ves_twin.effects.registry import attributes
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.recordings.experiment import MjcfExperiment
from ves_twin.machines.mjcf.rig.description import (
    Compared,
    Drive,
    Mode,
    RigDescription,
    Setting,
    Start,
)
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.scenario.experiment import StartState


def applied(
    name: str, recording: Recording, experiment: MjcfExperiment, rig: Rig
) -> tuple[Recording, Rig, float]:
    """Apply what an experiment says of one recording.

    Args:
        name: of the recording.
        recording: of the machine.
        experiment: how recordings were made.
        rig: the machine as its file has it.

    Returns:
        The stretch that is compared, the machine as it was, and where the stretch begins [s].

    Raises:
        UnknownNameError: a signal, joint, body or attribute that is not there.
        InvalidInputError: signals that no mode of the machine feeds in, or an empty window.
    """
    told = experiment.of(name)
    own = rig_of(told, rig)
    start = told.window.start
    if told.start.state is StartState.ESTIMATED:
        start = max(start, told.start.forget)
    drive = MjcfForward.of(own).drive
    return compared_stretch(recording, start, told.window.stop, drive, name), own, start


def rig_of(experiment: MjcfExperiment, rig: Rig) -> Rig:
    """The rig as it was in an experiment: mode, signals compared, numbers, payload, start."""
    told = rig.description
    settings = {(s.element, s.attribute): s for s in told.parameters}
    for key, value in experiment.parameters.items():
        new = _setting(key, value, rig)
        old = settings.get((new.element, new.attribute), new)
        change = {"value": value, "source": "experiment"}
        settings[new.element, new.attribute] = old.model_copy(update=change)
    compare = _compare(experiment, told)
    changed = told.model_copy(
        update={
            "drive": _drive(experiment, told),
            "compare": compare,
            "parameters": tuple(settings.values()),
            "start": _start(experiment, told, compare),
        }
    )
    load = experiment.payload
    payloads = rig.payloads if load is None else (*rig.payloads, (load.body, load.mass, load.at))
    made = replace(rig, description=changed, payloads=payloads)
    made.check()
    return made


def _drive(experiment: MjcfExperiment, told: RigDescription) -> Drive:
    """With the mode whose signals are those that were fed in."""
    if not experiment.drive:
        return told.drive
    imposed = told.drive.imposed_signals.values()
    fed = {
        Mode.MOTION: set(told.drive.joints.values()),
        Mode.CONTROL: {*told.drive.actuators.values(), *imposed},
        Mode.REFERENCE: {*(c.reference for c in told.controllers.values()), *imposed},
    }
    for name in experiment.drive:
        if name not in told.signals:
            raise UnknownNameError("signal in drive", name, told.signals)
    for mode, names in fed.items():
        if names == set(experiment.drive):
            return told.drive.model_copy(update={"mode": mode})
    known = "; ".join(f"{', '.join(sorted(n))} ({m.value})" for m, n in fed.items() if n)
    raise InvalidInputError("drive", list(experiment.drive), known)


def _compare(experiment: MjcfExperiment, told: RigDescription) -> dict[str, Compared]:
    for name in experiment.compare:
        if name not in told.compare:
            raise UnknownNameError("signal in compare", name, told.compare)
    return {n: c for n, c in told.compare.items() if n in experiment.compare} or told.compare


def _start(
    experiment: MjcfExperiment, told: RigDescription, compare: dict[str, Compared]
) -> dict[str, Start]:
    start = experiment.start
    if start.state is StartState.GIVEN:
        return {**told.start, **start.joints}
    if start.state is StartState.SETTLED:
        return told.start
    return {**told.start, **_estimated(told, compare)}


def _estimated(told: RigDescription, compare: dict[str, Compared]) -> dict[str, Start]:
    """From the first rows: position to its noise, speed to 2 pi times the low-pass's corner of it.

    A derivative behind a low-pass of corner f is at most 2 pi f times as noisy.
    """
    found = {}
    for name, compared in compare.items():
        if compared.joint and compared.of == "position":
            column = told.signals[name]
            noise = column.noise if not isinstance(column.noise, tuple) else column.noise[0]
            sd = to_si(noise, column.unit, f"noise of {name}")
            speed_sd = 2.0 * np.pi * told.drive.smoothing * sd
            found[compared.joint] = Start(position="measured", sd=sd, speed_sd=float(speed_sd))
    return found


def _setting(key: str, value: object, rig: Rig) -> Setting:
    """A key such as "load.mass" as an attribute of the element that has it: joint before tendon."""
    name, _, attribute = key.rpartition(".")
    owners = [element for element, found in attributes() if found == attribute]
    if not owners:
        raise UnknownNameError("attribute in parameters", attribute, {a for _, a in attributes()})
    element = next((one for one in owners if name in _names(rig.model, one)), owners[0])
    return Setting.model_validate({"attribute": attribute, str(element): name})


def _names(model: mujoco.MjModel, element: Element) -> set[str]:
    """Of all elements of a kind that a model has."""
    counts = {
        Element.BODY: (model.nbody, model.body),
        Element.JOINT: (model.njnt, model.joint),
        Element.ACTUATOR: (model.nu, model.actuator),
        Element.TENDON: (model.ntendon, model.tendon),
    }
    count, access = counts[element]
    return {access(i).name for i in range(count)}
