"""check_wiring: swapped columns, turned signs and foreign units of a recording."""

from __future__ import annotations

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.data.quality.check import Check, failed, passed, unknown
from ves_twin.data.quality.value_checks import COMMANDS, columns

FACTORS = {
    "mm against m": 1000.0,
    "cm against m": 100.0,
    "degrees against radians": 180.0 / np.pi,
}

CLEAR = 0.9
"""A correlation that is enough to say which command a column follows."""


def check_wiring(recording: Recording) -> list[Check]:
    """Whether each column follows its own command, with the right sign and in the right unit."""
    checks = []
    for measurement, command in COMMANDS.items():
        if command in recording.signals and measurement in recording.signals:
            checks += _pair(recording[command], recording[measurement], measurement)
    return checks


def _pair(command: FloatArray, measured: FloatArray, name: str) -> list[Check]:
    labels = columns(name, measured.shape[1])
    moving = np.ptp(command, axis=0) > 0.0
    finite = np.all(np.isfinite(command), axis=1) & np.all(np.isfinite(measured), axis=1)
    if finite.sum() < 10 or not moving.any():
        return [
            unknown("wiring", f"{name}: the commands do not move, so nothing can be told", name)
        ]
    command, measured = command[finite], measured[finite]
    scale = _unit(command[:, moving], measured[:, moving], name)
    match = _correlation(measured, command)
    checks = [scale] if scale is not None else [passed("units", f"{name}: as its command", name)]
    swapped, turned = [], []
    for i in np.flatnonzero(moving):
        row = match[i]
        best = int(np.argmax(np.abs(row)))
        if best != i and abs(row[best]) > CLEAR and abs(row[best]) > abs(row[i]) + 0.2:
            swapped.append(f"{labels[i]} follows command {best + 1}")
        elif row[i] < -CLEAR:
            turned.append(labels[i])
    if swapped:
        checks.append(failed("wiring", f"{'; '.join(swapped)}: columns look swapped", name))
    if turned:
        checks.append(failed("sign", f"{', '.join(turned)} move against their command", name))
    if not swapped and not turned:
        checks.append(passed("wiring", f"{name}: every column follows its own command", name))
    return checks


def _unit(command: FloatArray, measured: FloatArray, name: str) -> Check | None:
    ratio = float(np.median(np.std(measured, axis=0) / np.maximum(np.std(command, axis=0), 1e-12)))
    for words, factor in FACTORS.items():
        for found, way in ((factor, ""), (1.0 / factor, ", the other way round,")):
            if abs(np.log(max(ratio, 1e-12) / found)) < 0.25:
                moves = f"{name} moves {ratio:.4g} times as far as its command"
                return failed("units", f"{moves}: {words}{way} is suspected", name)
    return None


def _correlation(measured: FloatArray, command: FloatArray) -> FloatArray:
    """Correlation of every measured column with every command, at the best small lag."""
    best = np.zeros((measured.shape[1], command.shape[1]))
    for lag in range(0, min(12, len(command) // 4)):
        a = _unit_columns(measured[lag:])
        b = _unit_columns(command[: len(command) - lag])
        here = a.T @ b
        best = np.where(np.abs(here) > np.abs(best), here, best)
    return best


def _unit_columns(values: FloatArray) -> FloatArray:
    centred = values - values.mean(axis=0)
    return np.asarray(centred / np.maximum(np.linalg.norm(centred, axis=0), 1e-12))
