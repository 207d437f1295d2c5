"""import_log: a lab file and its map become a recording, with an account of what was done."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.signals import SIGNALS, Signal
from ves_twin.core.types import FloatArray
from ves_twin.core.units import to_unit
from ves_twin.data.account import Account, ChannelAccount
from ves_twin.data.clock.aligned import Aligned, align
from ves_twin.data.clock.resample import resample
from ves_twin.data.formats.log import Log
from ves_twin.data.mapping.frames import turn_signal
from ves_twin.data.mapping.import_map import ImportMap, Window
from ves_twin.data.mapping.targets import Target, resolve
from ves_twin.data.quality.gate import quality_gate
from ves_twin.data.suspicions import Range, suspicions

JITTER = 0.02
"""Jitter of the steps [periods] from which on an import says what can be done about it."""

FEWEST, MOST = 2, 100_000_000
"""Rows of a recording; more than the most are 0.8 GB a column."""


@dataclass(frozen=True)
class Imported:
    """A recording, and what was done to make it."""

    recording: Recording
    account: Account


def import_log(
    log: Log,
    told: ImportMap,
    window: Window | None = None,
    plausible: Mapping[str, Range] | None = None,
    known: Sequence[Signal] = (),
) -> Imported:
    """Make a recording of a lab file as a map says.

    Channels of several tables and clocks come onto the rows of one clock: those of the main clock,
    or an even rate if the map asks for one. Time counts from the first row.

    Args:
        log: the file.
        told: the map.
        window: stretch to import; the map's if left out.
        plausible: ranges of the plant's signals, by which mixed units are suspected.
        known: signals of an MJCF machine, which the map then need not declare.

    Raises:
        UnknownNameError: a column, clock, frame or signal that does not exist, with the nearest.
        InvalidInputError: units that do not convert, times that do not rise, or no rows.
    """
    targets = resolve(log, told, known)
    aligned = align(log, told, targets)
    rows, step = _rows(aligned, told, window or told.window)
    signals, own, done, held = _signals(aligned, told, targets, rows, step)
    notes = [*aligned.notes]
    for target in {t.channel.frame: t for t in targets if t.channel.frame}.values():
        name, frame = target.signal.name, told.frames[str(target.channel.frame)]
        signals[name] = turn_signal(signals[name], target.signal, frame.axes, frame.origin)
        notes.append(f"{name}: turned from frame {target.channel.frame} to its own")
    kinds = {t.signal.name: t.signal for t in targets}
    suspected = [
        words
        for name, values in signals.items()
        for words in suspicions(values, kinds[name], plausible or {})
    ]
    line = aligned.rows_of_main
    if told.rate is None and not told.clock.even and line.jitter > JITTER:
        notes.append(
            f"the rows come with {line.jitter:.0%} jitter: even = true in [clock] draws their"
            f' stamps straight, or rate = "{1.0 / step:.5g} Hz" gives even rows'
        )
    even = told.rate is not None or line.gaps == 0
    info = RecordingInfo(
        origin="measured",
        versions={"ves_twin": version("ves_twin"), "pyarrow": version("pyarrow")},
        period=step if even else 0.0,
        held=held,
        outcome="completed",
        own_signals=own,
    )
    recording = Recording(rows - rows[0], signals, info)
    failed = [f"{c.name}: {c.message}" for c in quality_gate(recording).failures]
    account = Account(
        file=log.path.name,
        form=log.form,
        sha256=_digest(log.path),
        rows=len(rows),
        rate=1.0 / step,
        zero=float(rows[0]) + aligned.origin,
        clocks={name: line.to_dict() for name, line in aligned.clocks.items()},
        offsets=aligned.offsets,
        channels=tuple(done),
        notes=tuple(notes),
        suspected=tuple(suspected),
        checks=tuple(failed),
        faults=log.faults,
    )
    content = {**account.to_dict(), "map": told.model_dump(mode="json", by_alias=True)}
    return Imported(replace(recording, info=replace(info, imported=content)), account)


def _rows(aligned: Aligned, told: ImportMap, window: Window) -> tuple[FloatArray, float]:
    """Times of the rows on the main clock [s] and their usual step."""
    line = aligned.rows_of_main
    if told.rate is None:
        rows, step = line.time, line.period
    else:
        step = 1.0 / told.rate
        asked = (line.time[-1] - line.time[0]) / step
        if not asked < MOST:
            came = f"{told.rate:g} Hz, {asked:.3g} rows"
            raise InvalidInputError("rate", came, f"at most {MOST:,} rows")
        count = int(np.floor(asked + 1e-6)) + 1
        rows = np.asarray(line.time[0] + np.arange(count) * step, np.float64)
    inside = rows[(rows >= window.start - 1e-9) & (rows < window.stop - 1e-9)]
    if len(inside) < FEWEST:
        came = f"{len(inside)} rows from {window.start:g} to {window.stop:g} s"
        raise InvalidInputError("window", came, f"some of {rows[0]:.4g} to {rows[-1]:.4g} s")
    return inside, step


def _signals(
    aligned: Aligned,
    told: ImportMap,
    targets: tuple[Target, ...],
    rows: FloatArray,
    step: float,
) -> tuple[dict[str, FloatArray], tuple[Signal, ...], list[ChannelAccount], dict[str, float]]:
    signals: dict[str, FloatArray] = {}
    held: dict[str, float] = {}
    done = []
    for target in targets:
        name, channel = target.signal.name, target.channel
        if name not in signals:
            signals[name] = np.full((len(rows), target.signal.width), np.nan)
        line = aligned.line(target)
        raw = aligned.values.pop(target.place)[line.rows]
        with np.errstate(over="ignore", invalid="ignore"):  # counted as missing below
            values = channel.sign * _converted(channel.scale * raw + channel.offset, target)
        found = resample(
            values, line.time, line.period, rows, step, channel.way, target.signal.role, told.gaps
        )
        signals[name][:, target.column] = found.values
        if found.held > 0.0:
            held[name] = max(held.get(name, 0.0), found.held)
        missing = float(np.mean(~np.isfinite(found.values)))
        done.append(
            ChannelAccount(channel.from_, channel.to, target.conversion, found.how, missing)
        )
    own = {t.signal.name: t.signal for t in targets if SIGNALS.get(t.signal.name) != t.signal}
    return signals, tuple(own.values()), done, held


def _converted(values: FloatArray, target: Target) -> FloatArray:
    factor, offset = to_unit(target.unit, target.si, target.channel.from_)
    if factor == 1.0 and offset == 0.0:
        return values
    return np.asarray(factor * values + offset)


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
