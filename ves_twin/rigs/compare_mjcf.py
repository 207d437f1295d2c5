"""compare_mjcf: where recordings of a rig and its simulation part, in every mode it can run in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.diagnosis.forward import Channel, Programme
from ves_twin.diagnosis.grid import AnalysisGrid
from ves_twin.errors import InvalidInputError
from ves_twin.recording.recording import Recording
from ves_twin.rigs.description import Mode
from ves_twin.rigs.forward import MjcfForward
from ves_twin.rigs.rig import Rig
from ves_twin.types import FloatArray

FORGET = 1.0
"""Time [s] at the begin that is not compared in forward simulation: a start is read from noisy
rows, and a controller's memory is empty."""

SCHEMA = 1


@dataclass(frozen=True)
class ColumnGap:
    """One column: how far measured and simulated are apart.

    Attributes:
        channel: name, signal, unit, declared noise.
        time: of the rows [s] (n,).
        measured, simulated: (n,).
        rms, peak, mean: of the difference, all rows [unit].
        rms_slow: of the difference on the analysis grid [unit].
    """

    channel: Channel
    time: FloatArray
    measured: FloatArray
    simulated: FloatArray
    rms: float
    peak: float
    mean: float
    rms_slow: float

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        return {
            "rms": self.rms,
            "rms_slow": self.rms_slow,
            "peak": self.peak,
            "mean": self.mean,
            "measured_rms": float(np.sqrt(np.mean(self.measured**2))),
            "noise": self.channel.sd,
            "unit": self.channel.unit,
        }


@dataclass(frozen=True)
class RigComparison:
    """One recording in one mode."""

    name: str
    rig: str
    identity: str
    mode: Mode
    rate: float
    columns: tuple[ColumnGap, ...]

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        return {
            "name": self.name,
            "basis": "plant",
            "plant": self.rig,
            "plant_hash": self.identity,
            "mode": self.mode.value,
            "slow_below": 0.5 * self.rate,
            "channels": {c.channel.name: c.to_dict() for c in self.columns},
        }


def compare_mjcf(recordings: Sequence[Recording], rig: Rig) -> tuple[RigComparison, ...]:
    """Hold recordings against a rig.

    Args:
        recordings: of the rig.
        rig: the two files.

    Returns:
        For each recording the mode of the file, and closed loop where the file has controllers.

    Raises:
        InvalidInputError: no recording.
    """
    if not recordings:
        raise InvalidInputError("recordings", "none", "at least one")
    return tuple(_one(recording, rig, mode) for recording in recordings for mode in modes_of(rig))


def modes_of(rig: Rig) -> tuple[Mode, ...]:
    """Modes that a rig's file has the signals for, its own first."""
    told = rig.description
    own = told.drive.mode
    closed = [Mode.REFERENCE] if told.controllers and own is not Mode.REFERENCE else []
    return (own, *closed)


def _one(recording: Recording, rig: Rig, mode: Mode) -> RigComparison:
    forward = MjcfForward.of(rig, mode)
    programme = Programme.of(recording, forward.drive, rate=rig.description.rate)
    simulated = forward.simulate(programme, {})
    skip = 0 if mode is Mode.MOTION else int(np.ceil(FORGET / programme.period))
    grid = AnalysisGrid.of(programme.period, programme.rate)
    grid = AnalysisGrid(programme.period, 1) if programme.poses else grid
    columns = []
    for c, channel in enumerate(forward.channels):
        measured = recording[channel.signal][skip:, channel.column]
        expected = simulated[skip:, c]
        gap = measured - expected
        slow = grid.reduce(gap[:, None])[:, 0]
        columns.append(
            ColumnGap(
                channel=channel,
                time=recording.time[skip:],
                measured=measured,
                simulated=expected,
                rms=float(np.sqrt(np.mean(gap**2))),
                peak=float(np.max(np.abs(gap))),
                mean=float(np.mean(gap)),
                rms_slow=float(np.sqrt(np.mean(np.square(slow, dtype=float)))),
            )
        )
    name = recording.info.scenario
    told = rig.description
    return RigComparison(name, told.name, rig.identity, mode, told.rate, tuple(columns))
