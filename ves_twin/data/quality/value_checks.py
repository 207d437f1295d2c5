"""check_values: columns of a recording that lack numbers, stick, saturate, drop out or jump."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS, Role
from ves_twin.core.types import FloatArray
from ves_twin.data.quality.check import Check, failed, passed, unknown
from ves_twin.data.quality.dropouts import dropouts
from ves_twin.data.quality.jumps import jumps
from ves_twin.data.quality.spikes import spikes

PILE = 0.02
"""Share of rows at the very largest or smallest value that counts as saturation."""

COMMANDS = {"leg.length": "leg.command", "arm.q": "arm.command"}
"""A measurement -> the command that it follows, column by column."""

RUN = 5
"""Rows in a row at an end value that count as saturation."""

OF_READINGS = ("saturation", "dropout", "jump", "spike")
"""Checks that a command does not have: it stays at its ends, and jumps, as it likes."""

PLACES = frozenset({"m", "mm", "cm", "um", "in", "rad", "mrad", "deg", "turn"})
"""Units of places, as the table of signals and machines' own files give them."""

MOTION = PLACES | {f"{unit}/s" for unit in PLACES} | {"rpm"}
"""Those, and units of speeds."""

SWITCHED = 3
"""Values that a switched command has at most."""


def check_values(recording: Recording) -> list[Check]:
    """Numbers that are missing, stuck, saturated or dropped out, for each measured signal."""
    commands = {own.name for own in recording.info.own_signals if own.role is Role.COMMAND}
    measured = [n for n in recording.signals if _is_measured(n)]
    return [
        check
        for name in measured
        for check in _signal(recording, name)
        if check.name not in OF_READINGS or name not in commands
    ]


def columns(name: str, width: int) -> tuple[str, ...]:
    """Column names of a signal: those of the table, else numbered from 1."""
    if name in SIGNALS and SIGNALS[name].width == width:
        return SIGNALS[name].columns
    return tuple(f"{name}.{i + 1}" for i in range(width)) if width > 1 else (name,)


def _is_measured(name: str) -> bool:
    return name not in SIGNALS or SIGNALS[name].role is Role.MEASUREMENT


def _signal(recording: Recording, name: str) -> list[Check]:
    values = recording[name]
    labels = columns(name, values.shape[1])
    missing = ~np.isfinite(values)
    if missing.any():
        bad = [labels[i] for i in np.flatnonzero(missing.any(axis=0))]
        share, first = missing.any(axis=1).mean(), recording.time[missing.any(axis=1)][0]
        text = f"{share:.1%} of the rows hold no number, first at {first:.3f} s"
        return [failed("missing", f"{', '.join(bad)}: {text}", *bad)]
    checks = [passed("missing", f"{name}: every row holds numbers", name)]
    still = np.ptp(values, axis=0) == 0.0
    stuck = [labels[i] for i in np.flatnonzero(still & _asked_to_move(recording, name))]
    if stuck and len(stuck) < values.shape[1]:
        text = f"{', '.join(stuck)} never change while the rest of {name} does"
        checks.append(failed("stuck", text, *stuck))
    elif still.any():
        resting = ", ".join(labels[i] for i in np.flatnonzero(still))
        checks.append(unknown("stuck", f"{resting} never change, nor were they asked to", name))
    else:
        checks.append(passed("stuck", f"{name}: every column changes", name))
    moves = _has(recording, name, MOTION)
    full = [labels[i] for i in range(values.shape[1]) if _saturated(values[:, i], moves)]
    if full:
        verb = "stays at its end value" if len(full) == 1 else "stay at their end values"
        text = f"{', '.join(full)} {verb} as a range that is too small would"
        checks.append(failed("saturation", text, *full))
    else:
        checks.append(passed("saturation", f"{name}: no column stays at an end value", name))
    if not moves:
        return checks
    checks.append(_dropout(recording, name, labels))
    if _has(recording, name, PLACES):
        checks += [_jump(recording, name, labels), _spike(recording, name, labels)]
    return checks


def _dropout(recording: Recording, name: str, labels: tuple[str, ...]) -> Check:
    values = recording[name]
    lost = {label: dropouts(values[:, i]) for i, label in enumerate(labels)}
    gone = {label: found for label, found in lost.items() if found}
    if not gone:
        return passed("dropout", f"{name}: no column jumps away and back", name)
    label, found = next(iter(gone.items()))
    at, rows = found[0].start, found[0].stop - found[0].start
    text = (
        f"{', '.join(gone)}: {sum(map(len, gone.values()))} times a jump away, a stand and a"
        f" jump back, as of a reading that drops out; {label} first at"
        f" {recording.time[at]:.3f} s, for {rows} rows"
    )
    return failed("dropout", text, *gone)


def _jump(recording: Recording, name: str, labels: tuple[str, ...]) -> Check:
    values, time = recording[name], recording.time
    others = [n for n in recording.signals if not _has(recording, n, MOTION)]
    commands = [c for n in others for c in recording[n].T if np.all(np.isfinite(c))]
    gone = {
        label: k for i, label in enumerate(labels) if (k := jumps(values[:, i], time, commands))
    }
    if not gone:
        return passed("jump", f"{name}: no column jumps and stays", name)
    label, rows = next(iter(gone.items()))
    text = (
        f"{label} is another one at once from {time[rows[0]]:.3f} s to the next row, and stays so:"
        " two runs in one recording, a counter that was set anew, or a reading that was frozen?"
    )
    return failed("jump", text, *gone)


def _spike(recording: Recording, name: str, labels: tuple[str, ...]) -> Check:
    values = recording[name]
    gone = {label: k for i, label in enumerate(labels) if (k := spikes(values[:, i]))}
    if not gone:
        return passed("spike", f"{name}: no single row is far from its neighbours", name)
    label, rows = next(iter(gone.items()))
    text = (
        f"{label} is far from its neighbours in {len(rows)} single rows, first at"
        f" {recording.time[rows[0]]:.3f} s: glitches of its sensor?"
    )
    return failed("spike", text, *gone)


def _has(recording: Recording, name: str, units: frozenset[str]) -> bool:
    """Whether a signal has such units: places and speeds do not jump, forces and currents may."""
    known = {own.name: own for own in recording.info.own_signals} | dict(SIGNALS)
    return name in known and set(known[name].units) <= units


def _asked_to_move(recording: Recording, name: str) -> NDArray[np.bool_]:
    """Columns whose command moves; all of them where there is no command, as for a sensor."""
    width = recording[name].shape[1]
    command = COMMANDS.get(name, "")
    if command not in recording.signals or recording[command].shape[1] != width:
        return np.ones(width, dtype=bool)
    return np.asarray(np.ptp(recording[command], axis=0) > 0.0)


def _saturated(values: FloatArray, moves: bool) -> bool:
    """Whether a column runs into its end value at full speed and stays there, often enough.

    A joint that comes to rest arrives slowly; a range that is too small stops it in motion. What
    is switched (a valve: off, on, the other way) is always at an end value. What tells no motion
    may be off: a voltage that ends at exactly nothing has reached no end of a range.

    Args:
        values: of the column (n,).
        moves: whether it tells places or speeds.
    """
    if len(np.unique(values)) <= SWITCHED or len(values) <= RUN:
        return False
    travels = np.abs(values[RUN:] - values[:-RUN])  # over some rows: one of coarse steps is a step
    if not np.any(travels > 0.0):
        return False
    fast = float(np.percentile(travels[travels > 0.0], 90.0))
    ends = [end for end in (values.max(), values.min()) if moves or end != 0.0]
    for end in ends:
        at = values == end
        edges = np.flatnonzero(np.diff(np.concatenate([[0], at.astype(int), [0]])))
        starts, lengths = edges[::2], edges[1::2] - edges[::2]
        entered = starts[(lengths >= RUN) & (starts >= RUN)]
        if len(entered) and at.mean() > PILE and np.median(travels[entered - RUN]) > 0.25 * fast:
            return True
    return False
