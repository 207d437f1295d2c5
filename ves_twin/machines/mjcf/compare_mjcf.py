"""compare_mjcf: where recordings of a rig and its simulation part, in every mode it can run in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import BoolArray, FloatArray, SingleArray
from ves_twin.diagnosis.forward import Channel, Excitation
from ves_twin.diagnosis.grid import AnalysisGrid
from ves_twin.machines.mjcf.description import Mode
from ves_twin.machines.mjcf.forward import MjcfForward
from ves_twin.machines.mjcf.machine import Rig

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
            "measured_rms": float(np.sqrt(np.nanmean(self.measured**2))),
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
    poses: bool
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
    return tuple(_one(r, rig, mode) for r in recordings for mode in modes_of(rig, r))


def modes_of(rig: Rig, recording: Recording) -> tuple[Mode, ...]:
    """The mode of a rig's file, and closed loop where set-points were recorded."""
    told = rig.description
    own = told.drive.mode
    if not told.controllers or own is Mode.REFERENCE:
        return (own,)
    fed = MjcfForward.of(rig, Mode.REFERENCE).drive
    return (own, Mode.REFERENCE) if all(n in recording.signals for n in fed) else (own,)


def _one(recording: Recording, rig: Rig, mode: Mode) -> RigComparison:
    forward = MjcfForward.of(rig, mode)
    programme = Excitation.of(recording, forward.drive, rate=rig.description.rate)
    simulated = forward.simulate(programme, {})
    if not np.all(np.isfinite(simulated)):
        came = f"a simulation of {recording.info.scenario} ({mode}) that diverges"
        raise InvalidInputError(
            rig.description.model, came, "a finite motion; try a smaller timestep"
        )
    skip = 0 if mode is Mode.MOTION else int(np.ceil(FORGET / programme.period))
    grid = AnalysisGrid.of(programme.period, programme.rate)
    grid = AnalysisGrid(programme.period, 1) if programme.poses else grid
    columns = []
    here = [c for c in enumerate(forward.channels) if c[1].signal in recording.signals]
    if not here:
        wanted = forward.channels[0].signal
        raise UnknownNameError("signal in the recording", wanted, recording.signals)
    for c, channel in here:
        measured = recording[channel.signal][skip:, channel.column]
        expected = simulated[skip:, c]
        gap = measured - expected
        bad = ~np.isfinite(gap)
        if bad.all():
            raise InvalidInputError(channel.name, "no number in its rows", "a measurement")
        kept = gap[~bad]
        slow = _slow(gap, bad, grid)
        columns.append(
            ColumnGap(
                channel=channel,
                time=recording.time[skip:],
                measured=measured,
                simulated=expected,
                rms=float(np.sqrt(np.mean(kept**2))),
                peak=float(np.max(np.abs(kept))),
                mean=float(np.mean(kept)),
                rms_slow=float(np.sqrt(np.mean(np.square(slow, dtype=float)))),
            )
        )
    name = recording.info.scenario
    told = rig.description
    return RigComparison(
        name, told.name, rig.identity, mode, told.rate, programme.poses, tuple(columns)
    )


def _slow(gap: FloatArray, bad: BoolArray, grid: AnalysisGrid) -> SingleArray:
    """The difference on the analysis grid, without the rows that a hole goes into."""
    at = np.arange(len(gap))
    filled = np.where(bad, np.interp(at, at[~bad], gap[~bad]), gap)
    found = grid.reduce(filled[:, None])[:, 0]
    touched = grid.touched(bad[:, None])[:, 0]
    return np.asarray(found if touched.all() or not bad.any() else found[~touched])
