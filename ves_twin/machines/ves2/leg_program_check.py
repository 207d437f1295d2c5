"""check_leg_program: whether the log holds the lengths that the leg program acted on."""

from __future__ import annotations

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.data.quality.check import Check, failed, passed, unknown
from ves_twin.scenario.schema import Legs

NAME = "recorder"

SIGNALS = ("leg.command", "leg.length", "valve.command")

SHARE = 0.1
"""Of a leg's mean error: what a leg program of another gain than planned would shift, at most."""

CLEAR = 10.0
"""Standard errors of an offset that count; rows of a motion are coloured, about three as one."""

CUT = 3
"""Rows of one leg with its very largest command from which that is taken for a limit."""

FEWEST = 50
"""Rows from which an offset is told."""


def check_leg_program(recording: Recording, legs: Legs, full_speed: float) -> Check:
    """The log's lengths against the valve commands that were made of what the program read.

    At rest the section of the leg loop has gain 1, so that u v = K1 (L_command - L) holds for the
    means. In motion rows lie beside the program's cycle and the section lags: both add terms in
    the rates of command and length, alike in all legs, and are fitted with the offset of each.
    An offset of the transducer itself reaches the program too and leaves none here.

    Args:
        recording: on its own clock.
        legs: gain K1 [1/s] and what the section filters.
        full_speed: rod speed v believed at full opening [m/s].

    Returns:
        Failed with the legs whose logged length is off; unknown where a signal is missing.
    """
    if legs.gain <= 0.0 or any(name not in recording.signals for name in SIGNALS):
        return unknown(NAME, "no valve commands to hold the logged lengths against", *SIGNALS)
    command, length, valve = (recording[name] for name in SIGNALS)
    error = command - length
    told = valve * full_speed / legs.gain - error
    rates = np.gradient(command, axis=0), np.gradient(length, axis=0)
    finite = np.isfinite(told) & np.isfinite(rates[0]) & np.isfinite(rates[1])
    rows = np.all(finite & ~_cut_off(valve), axis=1)
    if rows.sum() < FEWEST:
        return unknown(NAME, f"{rows.sum()} rows whose valve commands are not cut off", *SIGNALS)
    offset, sd = _offsets(told[rows], [rate[rows] for rate in rates])
    borne = SHARE * np.abs(error[rows].mean(axis=0)) + CLEAR * sd
    off = [
        f"leg.length.{i + 1} by {1e3 * offset[i]:+.2f} mm"
        for i in np.flatnonzero(np.abs(offset) > borne)
    ]
    if off:
        why = "is off what its valve commands say that it was: the log is wrong, not the rig"
        return failed(NAME, f"{', '.join(off)} {why}", "leg.length")
    return passed(NAME, "leg.length: as the leg program read it", "leg.length")


def _cut_off(valve: FloatArray) -> BoolArray:
    """Where commands stand at a limit, that of the program or a lower one (n, 6)."""
    size = np.abs(valve)
    at = size >= np.nanmax(size, axis=0, initial=0.0)
    return np.asarray(at & (at.sum(axis=0) >= CUT))


def _offsets(told: FloatArray, rates: list[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Offset of each leg and its standard error [m] (6,), terms in the rates common to all."""
    middle = told.mean(axis=0)
    means = np.array([rate.mean(axis=0) for rate in rates])
    columns = np.column_stack([(r - m).ravel() for r, m in zip(rates, means, strict=True)])
    shares, *_ = np.linalg.lstsq(columns, (told - middle).ravel(), rcond=None)
    left = (told - middle).ravel() - columns @ shares
    sd = left.reshape(told.shape).std(axis=0) / np.sqrt(len(told))
    return middle - shares @ means, sd
