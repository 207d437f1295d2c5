"""offered: multisines that an MJCF machine could be fed next, within its typical sizes."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from pathlib import Path

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import write_whole
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.machine import SETPOINTS
from ves_twin.machines.mjcf.inputs.inputs import Input, inputs_of, strain
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.column import Column
from ves_twin.machines.mjcf.rig.description import Mode

SECONDS = 10.0
"""Length of an excitation [s]."""

TONES = 5
"""Of a multisine."""

FADE = 0.1
"""Share of the length in which it fades in: machines begin at rest."""

ROWS = 5.0
"""Rows for each of the analysis grid, where no recording gives a clock."""

BANDS: Mapping[str, tuple[float, float]] = {
    "multisine": (1.0, 3.0),
    "slow multisine": (0.3, 1.0),
    "quick multisine": (3.0, 10.0),
}
"""Name -> band, in units of the frequency at which typical travel needs typical speed."""

HIGHEST = 0.4
"""No tone is above this share of the analysis rate."""

HALVINGS = 6
"""Times that an effort is halved until its motion keeps within travel and speed."""


def offered(
    forward: MjcfForward, like: Recording | None = None, seconds: float = SECONDS
) -> tuple[Excitation, ...]:
    """Multisines of every band, at all inputs and at each alone, that the nominal machine bears.

    Set-points and motions keep half the typical travel and the typical speed, efforts the typical
    effort; they are halved until every joint stays within BORNE of its travel and speed.

    Args:
        forward: in the mode in which it is fed.
        like: gives clock and start; typical sizes and the model's if None.
        seconds: length.

    Returns:
        None where a joint has no typical sizes, cannot be watched, or is neither hinge nor slide.
    """
    inputs = inputs_of(forward, like)
    rate = forward.rig.description.rate
    if not inputs or forward.rig.description.clock.poses:
        return ()
    period = 1.0 / (ROWS * rate)
    if like is not None and len(like) > 1:
        period = float(like.time[-1] - like.time[0]) / (len(like) - 1)
    time = np.asarray(period * np.arange(round(seconds / period)), float)
    made = (
        _borne(forward, Excitation(name, time, drive_of(forward, rows, like), rate=rate), inputs)
        for name, rows in _menu(inputs, time, rate)
    )
    return tuple(one for one in made if one is not None)


def write_inputs(forward: MjcfForward, excitation: Excitation, folder: Path) -> None:
    """Write what is fed in as SETPOINTS, by the names and in the units of the machine's log.

    Raises:
        FileAccessError: not writable.
    """
    told = forward.rig.description
    names, columns = [told.clock.column], [excitation.time / told.clock.scale]
    for signal in forward.fed:
        column = told.signals[signal]
        names += column.columns
        columns += list(_as_logged(column, excitation.drive[signal], excitation.time).T)
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([f"{value:.12g}" for value in row] for row in np.column_stack(columns))
    write_whole(folder / SETPOINTS, text.getvalue())


def _as_logged(column: Column, rows: FloatArray, time: FloatArray) -> FloatArray:
    """Rows (n, w) of a signal as the log's columns have them."""
    if column.integrated:
        return np.asarray(np.gradient(rows, time, axis=0) / column.scale)
    return np.asarray((rows - column.offset) / column.scale)


def _menu(
    inputs: list[Input], time: FloatArray, rate: float
) -> Iterator[tuple[str, dict[str, FloatArray]]]:
    """Name and rows (n, 1) by signal."""
    still = {one.signal: np.full((len(time), 1), one.rest) for one in inputs}
    for k, (name, (low, high)) in enumerate(BANDS.items()):
        rng = np.random.default_rng([11, k])
        rows = {}
        for one in inputs:
            band = np.minimum([low * one.corner, high * one.corner], HIGHEST * rate)
            shape = _multisine(time, (float(band[0]), float(band[1])), rng)
            rows[one.signal] = one.rows(shape, time)
        yield name, rows
        if len(inputs) > 1:
            for one in inputs:
                yield f"{name} at {one.joint} alone", {**still, one.signal: rows[one.signal]}


def _multisine(time: FloatArray, band: tuple[float, float], rng: np.random.Generator) -> FloatArray:
    """Tones evenly over a band [Hz] with random phases, fading in, of peak 1 (n,)."""
    tones = np.linspace(*band, TONES)
    phases = rng.uniform(0.0, 2.0 * np.pi, TONES)
    shape = np.sin(2.0 * np.pi * np.outer(time, tones) + phases).sum(axis=1)
    shape = shape * np.minimum(time / (FADE * time[-1]), 1.0) ** 2
    return np.asarray(shape / np.max(np.abs(shape)))


def drive_of(
    forward: MjcfForward, rows: Mapping[str, FloatArray], like: Recording | None
) -> dict[str, FloatArray]:
    """What is fed in, and the start of each joint whose start is measured, held."""
    told, found = forward.rig.description.signals, dict(rows)
    count = len(next(iter(rows.values())))
    for name in forward.drive:
        if name not in found:
            width = len(told[name].columns) if name in told else 2
            known = like is not None and name in like.signals
            first = like[name][0] if like is not None and known else np.zeros(width)
            found[name] = np.tile(first, (count, 1))
    return found


def _borne(
    forward: MjcfForward, excitation: Excitation, inputs: Sequence[Input]
) -> Excitation | None:
    """The excitation as large as the nominal machine bears it; None if it bears it at no size."""
    if forward.mode is Mode.MOTION:
        return excitation
    drive = dict(excitation.drive)
    for _ in range(HALVINGS):
        made = Excitation(excitation.name, excitation.time, drive, rate=excitation.rate)
        if strain(forward, made) <= 1.0:
            return made
        for one in inputs:
            drive[one.signal] = one.rest + 0.5 * (drive[one.signal] - one.rest)
    return None
