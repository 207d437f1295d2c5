"""check_clock: rate, gaps and repeated rows of a recording."""

from __future__ import annotations

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS, Role
from ves_twin.data.clock.clock_report import longest_step, rounding, usual_step
from ves_twin.data.clock.usual_period import is_usual
from ves_twin.data.quality.check import Check, failed, passed, unknown
from ves_twin.data.repeats import repeats

JITTER = 0.05
"""Rows that lie off the even clock by more than this share of a period are jitter."""

STILL = 1.5
"""Smallest steps of a column up to which it counts as standing still."""


def check_clock(recording: Recording) -> list[Check]:
    """Rate, gaps and repeats.

    A gap is a step of more than 1.5 median periods. Rows are repeats where every measured
    column equals the row before in a recording that otherwise moves: a logger that held them. Not
    where a column that is told in steps moves by one about them: there the machine stands. Nor
    where none goes on behind them as it came: there it turns back.
    """
    if len(recording) < 3:
        return [unknown("rate", f"{len(recording)} rows are too few to tell a rate")]
    steps = np.diff(recording.time)
    period = usual_step(recording.time) or float(np.median(steps))
    return [_rate(recording, steps, period), _gaps(recording, steps, period), _repeats(recording)]


def _rate(recording: Recording, steps: np.ndarray, period: float) -> Check:
    even = steps[steps < longest_step(steps, period)]
    off = np.max(np.abs(even - period), initial=0.0) - rounding(steps)
    jitter = max(float(off), 0.0) / period
    declared = recording.info.period
    said = f"{1.0 / period:.2f} Hz"
    if declared > 0.0 and abs(period / declared - 1.0) > JITTER:
        return failed(
            "rate", f"rows come at {said}, the recording declares {1.0 / declared:.2f} Hz"
        )
    if not is_usual(period):
        return unknown("rate", f"rows are {period:.3g} s apart: is that the unit of their clock?")
    if jitter > JITTER:
        return failed("rate", f"rows come at {said} with {jitter:.0%} jitter, expected under 5 %")
    return passed("rate", f"{said}, jitter {jitter:.1%}")


def _gaps(recording: Recording, steps: np.ndarray, period: float) -> Check:
    holes = np.flatnonzero(steps >= longest_step(steps, period))
    if not len(holes):
        return passed("gaps", "none")
    longest = holes[np.argmax(steps[holes])]
    return failed(
        "gaps",
        f"{len(holes)} gaps, the longest of {steps[longest]:.3f} s at"
        f" {recording.time[longest]:.3f} s; expected a row every {period:.4f} s",
    )


def _repeats(recording: Recording) -> Check:
    changes, moves, goes_on = np.zeros((3, len(recording) - 1), dtype=bool)
    for values in recording.signals.values():
        with np.errstate(invalid="ignore"):
            told = np.diff(values, axis=0)
        steps = np.abs(told)
        before, behind = _last(told), _last(told[::-1])[::-1]
        first = (before == 0.0) != (behind == 0.0)  # it has not moved yet, or does not any more
        goes_on |= np.any((before * behind > 0.0) | first, axis=1)
        changes |= np.any(steps != 0.0, axis=1)
        smallest = np.min(np.where(steps > 0.0, steps, np.inf), axis=0)
        moves |= np.any(steps > STILL * smallest, axis=1)
    if not changes.any():
        return unknown("repeats", "no signal changes at all")
    about = np.concatenate([[False], moves, [False]])
    held = np.flatnonzero(~changes & goes_on & (about[:-2] | about[2:]))
    first, last = np.flatnonzero(changes)[[0, -1]]
    # a machine rests before and after its motion, and one row alone harms nothing
    if len(held) > 1 and np.any((held > first) & (held < last)):
        begin, said = recording.time[held[0] + 1], f"{len(held)} of {len(recording)} rows"
        said += " repeat the one before"
        return failed("repeats", f"{said}, first at {begin:.3f} s{_slower(recording)}")
    return passed("repeats", "none")


def _last(steps: np.ndarray) -> np.ndarray:
    """The last step of each column (n, c) that was none of zero, row by row."""
    rows = np.arange(len(steps))[:, None]
    at = np.maximum.accumulate(np.where(steps != 0.0, rows, 0), axis=0)
    return np.take_along_axis(steps, at, axis=0)


def _slower(recording: Recording) -> str:
    """Which measurements come more slowly than rows, and their key; commands are held."""
    known = {**SIGNALS, **{own.name: own for own in recording.info.own_signals}}
    most = {
        name: _stands(values)
        for name, values in recording.signals.items()
        if name not in known or known[name].role is not Role.COMMAND
    }
    slow = ", ".join(f"{name} (`repeats = {rows}`)" for name, rows in most.items() if rows > 1)
    if not slow:
        return ""
    return (
        f"; readings come more slowly than rows in {slow}: that key in the file of a machine of"
        " yours takes them straight between"
    )


def _stands(values: np.ndarray) -> int:
    """Rows that a reading stands for at most, in any column of a signal (n, c)."""
    return max((repeats(column) for column in values.T if np.all(np.isfinite(column))), default=1)
