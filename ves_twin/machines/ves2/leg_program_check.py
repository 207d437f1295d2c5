"""check_leg_program: whether the log holds the lengths that the leg program acted on."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.data.quality.check import Check, Grade, failed, passed, unknown
from ves_twin.scenario.schema import Legs

NAME = "recorder"

SIGNALS = ("leg.command", "leg.length", "valve.command")

SHARE = 0.1
"""Of a leg's mean error: what a leg program of another gain than planned would shift, at most."""

CLEAR = 10.0
"""Standard errors of an offset that count; rows of a motion are coloured, about three as one."""

CUT = 3
"""Rows of one leg with its very largest command from which that is taken for a limit."""

LATE = 5e-4
"""Delay of one length behind those of the others [s] that is borne: a tenth of a leg's cycle."""

FEWEST = 50
"""Rows from which an offset is told."""


def check_leg_program(recording: Recording, legs: Legs, full_speed: float) -> Check:
    """The log's lengths against the valve commands that were made of what the program read.

    At rest the section of the leg loop has gain 1, so that u v = K1 (L_command - L) holds for the
    means. In motion rows lie beside the program's cycle and the section lags: both add terms in
    the rates of command and length, alike in all legs, and are fitted with the offset of each.
    A length that is logged later than the other legs' adds -delay times its rate. An offset or a
    delay of the transducer itself reaches the program too and leaves none here.

    Args:
        recording: on its own clock.
        legs: gain K1 [1/s] and what the section filters.
        full_speed: rod speed v believed at full opening [m/s].

    Returns:
        Failed with the columns that are off in the log; unknown where a signal is missing.
    """
    if legs.gain <= 0.0 or any(name not in recording.signals for name in SIGNALS):
        return unknown(NAME, "no valve commands to hold the logged lengths against", *SIGNALS)
    command, length, valve = (recording[name] for name in SIGNALS)
    error = command - length
    told = valve * full_speed / legs.gain - error
    period = float(np.median(np.diff(recording.time))) if len(recording) > 1 else 1.0
    rates = np.gradient(np.array([command, length]), period, axis=1)
    finite = np.isfinite(told) & np.all(np.isfinite(rates), axis=0)
    rows = np.all(finite & ~_cut_off(valve), axis=1)
    if rows.sum() < FEWEST:
        return unknown(NAME, f"{rows.sum()} rows whose valve commands are not cut off", *SIGNALS)
    offset, late = _told(told[rows], rates[:, rows])
    borne = SHARE * np.abs(error[rows].mean(axis=0)) + CLEAR * offset.sd
    off = np.abs(offset.value) > borne
    slow = np.abs(late.value) > LATE + CLEAR * late.sd
    words = [f"leg.length.{i + 1} by {1e3 * offset.value[i]:+.2f} mm" for i in np.flatnonzero(off)]
    words += [
        f"leg.length.{i + 1} by {1e3 * late.value[i]:+.1f} ms" for i in np.flatnonzero(slow & ~off)
    ]
    if words:
        why = "is off what its valve commands say that it was: the log is wrong, not the rig"
        columns = [f"leg.length.{i + 1}" for i in np.flatnonzero(off | slow)]
        return failed(NAME, f"{', '.join(words)} {why}", *columns)
    return passed(NAME, "leg.length: as the leg program read it", "leg.length")


def misread_legs(checks: Iterable[Check]) -> tuple[int, ...]:
    """Legs, from 1, that failed checks of the recorder name."""
    found = {
        int(column.rpartition(".")[2])
        for check in checks
        if check.name == NAME and check.grade is Grade.FAILED
        for column in check.signals
    }
    return tuple(sorted(found))


def _cut_off(valve: FloatArray) -> BoolArray:
    """Where commands stand at a limit, that of the program or a lower one (n, 6)."""
    size = np.abs(valve)
    at = size >= np.nanmax(size, axis=0, initial=0.0)
    return np.asarray(at & (at.sum(axis=0) >= CUT))


@dataclass(frozen=True)
class _Told:
    """One number of each leg and its standard error (6,)."""

    value: FloatArray
    sd: FloatArray


def _told(told: FloatArray, rates: FloatArray) -> tuple[_Told, _Told]:
    """Offset [m] and delay [s] of each leg in the log.

    Args:
        told: what commands say beyond the logged error [m] (n, 6).
        rates: of the command and of the length [m/s] (2, n, 6).
    """
    middle, means = told.mean(axis=0), rates.mean(axis=1)
    moving = rates - means[:, None]
    shares, *_ = np.linalg.lstsq(moving.reshape(2, -1).T, (told - middle).ravel())
    left = told - middle - np.tensordot(shares, moving, axes=1)
    power = np.maximum(np.sum(moving[1] ** 2, axis=0), 1e-30)
    slope = np.sum(left * moving[1], axis=0) / power
    sd = (left - slope * moving[1]).std(axis=0)
    offset = _Told(middle - shares @ means, left.std(axis=0) / np.sqrt(len(told)))
    return offset, _Told(np.median(slope) - slope, sd / np.sqrt(power))
