"""predicted: what a drafted machine, simulated, explains of a log, and what its step spoils."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from ves_twin.core.quantity import quantity
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.diagnosis.model.forward import Channel, Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.pieces import pieces
from ves_twin.machines.mjcf.rig.machine import Rig

AWAY = -1.0
"""Share of a channel's power below which a simulation runs away: it is off by more than moves."""

COARSE = 3.0
"""Error of the model's step, in noise of one row, that is told: a rotary pendulum with 13 had
intervals far too narrow about sizes that were off."""

FEWEST = 30
"""Rows from which on a prediction of them tells anything."""


def predicted(rig: Rig, recording: Recording) -> tuple[dict[str, float], list[str]]:
    """Of the model, fed with the log's commands: what it explains, and what its step spoils.

    Args:
        rig: a drafted machine.
        recording: of its log.

    Returns:
        Signal -> share of its power, below zero where it runs away; a sentence for channels that
        do, or that the step puts far off.
    """
    channels = MjcfForward.of(rig).channels
    if len(recording.time) < FEWEST:  # a clock in another unit, which is told
        return dict.fromkeys((channel.signal for channel in channels), 0.0), []
    parts = pieces(rig, recording)
    found, finer = _simulated(rig, parts), np.concatenate(_simulated(rig, parts, True))
    shares: dict[str, list[float]] = {}
    coarse: dict[str, tuple[float, str]] = {}
    lost: list[str] = []
    each = zip(channels, _explained(parts, found, channels), strict=True)
    for n, (channel, share) in enumerate(each):
        column, y = np.concatenate(found)[:, n], _measured(parts, channel)
        off = 2.0 * float(np.sqrt(np.mean((finer[:, n] - column) ** 2)))  # to first order
        shares.setdefault(channel.signal, []).append(share)
        if share < AWAY:
            ends = (np.sqrt(np.mean(x * x)) for x in (y - column, y - y.mean()))
            far, moves = (quantity(float(x), channel.unit, 2) for x in ends)
            runs = f"runs {far} away (rms) and moves by {moves}" if share > -np.inf else "diverges"
            lost.append(f"simulated, {channel.name} {runs}")
        elif off > COARSE * channel.sd > 0.0:
            coarse[channel.name] = off / channel.sd, quantity(off, channel.unit, 2)
    step = float(rig.model.opt.timestep)
    why = "signs, units, zeros?"
    if any(_undamped(rig, name) for name, low in shares.items() if min(low) < AWAY):
        why = "has a joint no damping or friction in the model?"
    words = [f"{'; '.join(lost)}: {why}"] if lost else []
    return {name: min(low) for name, low in shares.items()}, [*words, *_coarse(coarse, step)]


def least_explained(
    rig: Rig, recording: Recording, values: Mapping[str, float] | None = None
) -> float:
    """Share of its power that the model explains of the signal that it explains least of.

    Args:
        rig: a drafted machine.
        recording: of its log.
        values: parameter -> value; as the file has it if None.
    """
    parts = pieces(rig, recording)
    found = _simulated(rig, parts, values=values or {})
    return min(_explained(parts, found, MjcfForward.of(rig).channels))


def _simulated(
    rig: Rig,
    parts: Sequence[Recording],
    finer: bool = False,
    values: Mapping[str, float] = MappingProxyType({}),
) -> list[FloatArray]:
    """Each piece (rows, c) as the model predicts it; at half its step where finer."""
    forward = MjcfForward.of(rig)
    return [forward.simulate(Excitation.of(p, forward.drive), values, finer) for p in parts]


def _measured(parts: Sequence[Recording], channel: Channel) -> FloatArray:
    return np.concatenate([part[channel.signal][:, channel.column] for part in parts])


def _explained(
    parts: Sequence[Recording], found: Sequence[FloatArray], channels: Sequence[Channel]
) -> list[float]:
    """Share of each channel's power that pieces explain.

    Short pieces begin where the log is, and hardly leave it: a share counts against what the first
    rows of each, gone on with straight on, leave as well as against the spread.
    """
    speeds = np.array([channel.unit.endswith("/s") for channel in channels])
    straight = np.concatenate([_coasting(part, speeds) for part in found])
    shares = []
    for channel, column, ahead in zip(channels, np.concatenate(found).T, straight.T, strict=True):
        y = _measured(parts, channel)
        left, power = float(np.nansum((y - column) ** 2)), np.nansum((y - np.nanmean(y)) ** 2)
        power = min(float(power) or 1.0, float(np.nansum((y - ahead) ** 2)) or float(power))
        shares.append(1.0 - left / power if np.all(np.isfinite(column)) else -np.inf)
    return shares


def _undamped(rig: Rig, signal: str) -> bool:
    """Whether the joint that a signal tells of has neither damping nor friction in the model."""
    joint = rig.description.compare[signal].joint if signal in rig.description.compare else ""
    if not joint:
        return False
    at = rig.model.joint(joint).dofadr[0]
    return not (rig.model.dof_damping[at] or rig.model.dof_frictionloss[at])


def _coasting(rows: FloatArray, speeds: BoolArray) -> FloatArray:
    """First rows of a simulation (n, c) gone on with straight on; of a speed the first row."""
    rate = np.where(speeds, 0.0, rows[1] - rows[0])
    return np.asarray(rows[0] + np.arange(len(rows))[:, None] * rate)


def _coarse(found: dict[str, tuple[float, str]], step: float) -> list[str]:
    """That a step [s] is coarse for channels, which it puts off by so many noises; the worst."""
    if not found:
        return []
    worst = max(found, key=lambda name: found[name][0])
    times, off = found[worst]
    more = f", {len(found) - 1} more by more than {COARSE:g}" if len(found) > 1 else ""
    return [
        f"the model's step of {step:.3g} s puts {worst} {off} off (rms), {times:.2g} times its"
        f" noise{more}: give the model a smaller timestep, or integrator RK4"
    ]
