"""started: a rig and recordings of it that do not begin where its file says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.polynomial import polyfit

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.quantity import percent
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import Role, Signal
from ves_twin.core.types import FloatArray
from ves_twin.core.units import to_si
from ves_twin.diagnosis.record.preprocess import MOST_SETTLING
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.column import Number
from ves_twin.machines.mjcf.rig.description import Mode, RigDescription, Start
from ves_twin.machines.mjcf.rig.machine import Rig

FEWEST = 5
"""Rows that tell a start at least: a parabola has three numbers."""

Groups = tuple[tuple[Recording, ...], ...]


def start_signal(joint: str) -> str:
    """Signal (position, speed) of a recording that says where a joint begins."""
    return f"{joint}.start"


def start_of(rig: Rig, joint: str) -> Signal:
    """What that signal is."""
    axes, units = ("position", "speed"), joint_units(rig.model, joint)
    where = "where the motion begins"
    return Signal(start_signal(joint), axes, units, Role.COMMAND, "joint", where)


def started(rig: Rig, *groups: Sequence[Recording]) -> tuple[Rig, Groups]:
    """The rig as these recordings need it, and the recordings with the starts that it asks for.

    A recording may say its start itself (JOINT.start). Where it does not, and its first rows are
    not where the rig's file has the start, the start is read off them and no better known than
    the file's `elsewhere` says. Where all recordings begin as the file says, nothing changes.

    Args:
        rig: the two files.
        *groups: recordings: measured, held out, and so on.

    Raises:
        InvalidInputError: a lead that leaves too little of a recording.
    """
    found = tuple(tuple(group) for group in groups)
    for one in (one for group in found for one in group):
        lead_rows(rig, one.time)
    for joint, start in rig.description.start.items():
        if start.elsewhere is None:
            continue
        begins = [[_begin(rig, joint, recording) for recording in group] for group in found]
        every = [begin for group in begins for begin in group]
        if not any(begin.moves for begin in every):
            continue
        rig = _with_start(rig, joint, _recorded(start, any(begin.read for begin in every)))
        found = tuple(
            tuple(_told(rig, joint, r, begin) for r, begin in zip(group, those, strict=True))
            for group, those in zip(found, begins, strict=True)
        )
    return rig, found


def lead_rows(rig: Rig, time: FloatArray) -> int:
    """Rows before the first one that is simulated under recorded commands at times (n,).

    Raises:
        InvalidInputError: a lead that leaves too little of them.
    """
    lead, length = rig.description.drive.lead, float(np.ptp(time))
    if not lead or rig.description.drive.mode is not Mode.CONTROL:
        return 0
    if lead > MOST_SETTLING * length:
        expected = f"{percent(MOST_SETTLING)} of each recording at most"
        raise InvalidInputError("drive.lead", f"{lead:g} s of {length:.4g} s", expected)
    return round(lead * (len(time) - 1) / length)


def first_state(column: FloatArray, period: float, corner: float) -> tuple[float, float]:
    """Position and speed at the first row, of a cubic through the first rows.

    As many rows as tell the speed to 2 pi corner times the noise of one row, which is what a
    derivative behind a low-pass of that corner is known to at best, and what is declared for it.
    The low-pass itself has no rows before the first one: behind it, what starts at rest under an
    acceleration a seems to move already, by about a / (2 pi corner).

    Args:
        column: positions (n,).
        period: between rows [s].
        corner: of the low-pass that positions are differentiated behind [Hz].

    Source: sd of the end slope of a cubic through n rows of noise s over a time T, from the
    Legendre polynomials: s sqrt(1200 / n) / T.
    """
    told = np.sqrt(1200.0) / (2.0 * np.pi * corner * period)
    count = min(len(column), max(FEWEST, int(np.ceil(told ** (2.0 / 3.0)))))
    time = period * np.arange(count)
    position, speed = polyfit(time, column[:count], min(3, count - 1))[:2]
    return float(position), float(speed)


def signal_of(told: RigDescription, joint: str, of: str) -> str:
    """The signal that tells a joint's position, or its speed; empty if there is none."""
    compared = (name for name, c in told.compare.items() if (c.joint, c.of) == (joint, of))
    return next(compared, told.drive.joints.get(joint, "") if of == "position" else "")


def read_from(told: RigDescription, joint: str) -> tuple[str, bool]:
    """The signal that a measured start is read from, and whether it is a speed.

    Of a joint whose speed alone is measured, as of a wheel, the position is the model's.
    """
    place = signal_of(told, joint, "position")
    return (place, False) if place else (signal_of(told, joint, "speed"), True)


@dataclass(frozen=True)
class _Begin:
    """Position and speed at the start, whether not as the file says, whether it was read off."""

    state: FloatArray
    moves: bool
    read: bool


def _recorded(start: Start, read: bool) -> Start:
    """A start that recordings say; known no better than first rows tell it if it was read."""
    changes: dict[str, object] = {"position": "recorded", "elsewhere": None}
    there = start.elsewhere
    if read and there is not None:
        changes |= {"sd": there.sd, "speed_sd": there.speed_sd, "settling": there.within}
    return start.model_copy(update=changes)


def _with_start(rig: Rig, joint: str, start: Start) -> Rig:
    told = {**rig.description.start, joint: start}
    return replace(rig, description=rig.description.model_copy(update={"start": told}))


def _begin(rig: Rig, joint: str, recording: Recording) -> _Begin:
    if start_signal(joint) in recording.signals:
        return _Begin(recording[start_signal(joint)][0], True, False)
    start = rig.description.start[joint]
    given, there = _si(rig, joint, start.position, start.speed), start.elsewhere
    state = None if there is None else _first_state(rig, joint, recording, there.within)
    if there is None or state is None:
        return _Begin(given, False, False)
    moves = bool(np.any(np.abs(state - given) > _si(rig, joint, there.position, there.speed)))
    return _Begin(state if moves else given, moves, moves)


def _si(rig: Rig, joint: str, position: Number, speed: Number) -> FloatArray:
    place, rate = joint_units(rig.model, joint)
    what = f"start.{joint}"
    return np.array([to_si(position, place, what), to_si(speed, rate, what)])


def _first_state(rig: Rig, joint: str, recording: Recording, within: float) -> FloatArray | None:
    """Position and speed behind the lead, of a parabola through the first rows; None if few."""
    measured = {
        name: compared
        for name, compared in rig.description.compare.items()
        if compared.joint == joint and name in recording.signals
    }
    if all(compared.of != "position" for compared in measured.values()):
        return None
    first = lead_rows(rig, recording.time)
    time = recording.time[first:] - recording.time[first]
    time = time[: max(FEWEST, int(np.searchsorted(time, within)))]
    one, none = np.ones(len(time)), np.zeros(len(time))
    shapes = {"position": (one, time, time**2 / 2.0), "speed": (none, one, time)}
    rows, read = [], []
    for name, compared in measured.items():
        signal = rig.description.signals[name]
        noise = signal.noise[0] if isinstance(signal.noise, tuple) else signal.noise
        sd = to_si(noise, signal.unit, f"noise of {name}") or 1.0
        rows.append(np.stack(shapes[compared.of], axis=1) / sd)
        read.append(compared.sign * recording[name][first : first + len(time), 0] / sd)
    values = np.concatenate(read)
    kept = np.isfinite(values)
    if np.count_nonzero(kept) < FEWEST:
        return None
    return np.asarray(np.linalg.lstsq(np.concatenate(rows)[kept], values[kept], rcond=None)[0][:2])


def _told(rig: Rig, joint: str, recording: Recording, begin: _Begin) -> Recording:
    """The recording with its start, where it does not say it itself."""
    name = start_signal(joint)
    if name in recording.signals:
        return recording
    own = (*recording.info.own_signals, start_of(rig, joint))
    info = replace(recording.info, own_signals=own)
    rows = np.tile(begin.state, (len(recording.time), 1))
    return replace(recording, signals={**recording.signals, name: rows}, info=info)
