"""tell: a rig and its recordings made ready as an experiment file says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.recording.stretch import compared_stretch
from ves_twin.core.units import to_si
from ves_twin.machines.mjcf.description import Compared, Drive, Mode, RigDescription, Setting, Start
from ves_twin.machines.mjcf.element import Element
from ves_twin.machines.mjcf.experiment import RigExperiment
from ves_twin.machines.mjcf.forward import MjcfForward
from ves_twin.machines.mjcf.machine import Rig
from ves_twin.machines.mjcf.registry import RIG_EFFECTS
from ves_twin.scenario.experiment import StartState

DECLARED = ("declared", "auto")
"""Noise as the rig's file has it; nothing is learnt from a part that stands still."""


@dataclass(frozen=True)
class Told:
    """What a comparison or diagnosis needs.

    Attributes:
        recordings: in the order in which they were given.
        rigs: of each of them.
        standstill: file of the recording that tells the noise; empty if none.
    """

    recordings: tuple[Recording, ...]
    rigs: tuple[Rig, ...]
    standstill: str

    @property
    def rig(self) -> Rig:
        """The one rig of all recordings.

        Raises:
            InvalidInputError: recordings of rigs that differ.
        """
        first = self.rigs[0]
        for recording, rig in zip(self.recordings, self.rigs, strict=True):
            if rig.identity != first.identity:
                came = "another payload, start or other parameters than the first recording"
                name = recording.info.scenario
                raise InvalidInputError(name, came, "one rig in all recordings of a diagnosis")
        return first


def tell(recordings: Mapping[str, Recording], experiment: RigExperiment, rig: Rig) -> Told:
    """Apply an experiment to recordings of a rig.

    Args:
        recordings: by name.
        experiment: how they were made.
        rig: the two files.

    Raises:
        UnknownNameError: a recording, signal, joint, body or attribute that is not there.
        InvalidInputError: signals that no mode of the rig feeds in, an empty window, or noise
            sources that differ.
    """
    experiment.check_names(list(recordings))
    ready, rigs, noises = [], [], set()
    for name, recording in recordings.items():
        told = experiment.of(name)
        own = rig_of(told, rig)
        start = told.window.start
        if told.start.state is StartState.ESTIMATED:
            start = max(start, told.start.forget)
        drive = MjcfForward.of(own).drive
        ready.append(compared_stretch(recording, start, told.window.stop, drive, name))
        rigs.append(own)
        noises.add("" if told.noise in DECLARED else told.noise)
    if len(noises) > 1:
        raise InvalidInputError("noise", sorted(noises), "one noise source in all recordings")
    return Told(tuple(ready), tuple(rigs), noises.pop() if noises else "")


def rig_of(experiment: RigExperiment, rig: Rig) -> Rig:
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


def _drive(experiment: RigExperiment, told: RigDescription) -> Drive:
    """With the mode whose signals are those that were fed in."""
    if not experiment.drive:
        return told.drive
    fed = {
        Mode.MOTION: set(told.drive.joints.values()),
        Mode.CONTROL: set(told.drive.actuators.values()),
        Mode.REFERENCE: {c.reference for c in told.controllers.values()},
    }
    for name in experiment.drive:
        if name not in told.signals:
            raise UnknownNameError("signal in drive", name, told.signals)
    for mode, names in fed.items():
        if names == set(experiment.drive):
            return told.drive.model_copy(update={"mode": mode})
    known = "; ".join(f"{', '.join(sorted(n))} ({m.value})" for m, n in fed.items() if n)
    raise InvalidInputError("drive", list(experiment.drive), known)


def _compare(experiment: RigExperiment, told: RigDescription) -> dict[str, Compared]:
    for name in experiment.compare:
        if name not in told.compare:
            raise UnknownNameError("signal in compare", name, told.compare)
    return {n: c for n, c in told.compare.items() if n in experiment.compare} or told.compare


def _start(
    experiment: RigExperiment, told: RigDescription, compare: dict[str, Compared]
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
    """A key such as "load.mass" as an attribute of the element that has it."""
    name, _, attribute = key.rpartition(".")
    known: dict[str, Element] = {
        kind.attribute: kind.element
        for kind in map(RIG_EFFECTS.__getitem__, RIG_EFFECTS.built_in)
        if kind.attribute and kind.attribute != "centre"
    } | {f"centre_{axis}": Element.BODY for axis in "xyz"}
    if attribute not in known:
        raise UnknownNameError("attribute in parameters", attribute, known)
    return Setting.model_validate({"attribute": attribute, str(known[attribute]): name})
