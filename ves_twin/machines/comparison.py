"""Comparison: everything that comparing recordings found."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.data.quality.check import Check, Grade
from ves_twin.diagnosis.bank.envelope import ENVELOPE_SD
from ves_twin.diagnosis.record.residuals.channel import ChannelComparison
from ves_twin.machines.tolerance import Excess

if TYPE_CHECKING:
    from ves_twin.machines.ves2.emulation_cost import EmulationCost

SCHEMA = 1


class Basis(StrEnum):
    """What a recording is held against.

    PLANT: the plant's answer to its set-points. RECORDING: another recording of the same
    programme. RESIDUAL: another recording of another programme, each less the plant's answer to
    its own set-points.
    """

    PLANT = "plant"
    RECORDING = "recording"
    RESIDUAL = "residual"


@dataclass(frozen=True)
class Traces(ReadOnly):
    """What was compared: time [s] (n,), and signals (n, width) as they were and as expected.

    `reach` is the sd of what a machine in order shows about `expected`, of noise and tolerances,
    by column (n,); empty where nobody computed it.
    """

    time: FloatArray
    measured: Mapping[str, FloatArray]
    expected: Mapping[str, FloatArray]
    reach: Mapping[str, FloatArray] = field(default_factory=dict)


@dataclass(frozen=True)
class RecordingComparison:
    """One recording.

    Attributes:
        name: of the recording.
        basis: what it is held against.
        checks: of the data-quality gate, also of the recording that it is held against.
        channels: column by column.
        absent: signals that would be compared and are not there, or hold too little.
        cost: for the emulation; None where nothing is emulated.
        notes: what was done to the data, and what the numbers rest on.
        start: first time that is compared [s].
        stop: last one [s].
        rate: of the rows [Hz].
        plant: name of the machine.
        plant_hash: of it.
        made_by: hash of the plant that made the recording; empty for a measured one.
        mode: what was fed in, "motion", "control", "reference", or "free": nothing.
        slow_below: highest frequency of the analysis grid [Hz].
        poses: whether rows are poses at rest and times their numbers.
        traces: the rows behind it.
        imposed: joints that moved as recorded while others were integrated.
    """

    name: str
    basis: Basis
    checks: tuple[Check, ...]
    channels: tuple[ChannelComparison, ...]
    absent: tuple[str, ...]
    cost: EmulationCost | None
    notes: tuple[str, ...]
    start: float
    stop: float
    rate: float
    plant: str
    plant_hash: str
    made_by: str
    mode: str
    slow_below: float
    poses: bool
    traces: Traces
    imposed: tuple[str, ...] = ()

    @property
    def quality(self) -> Grade:
        """Of the data: failed if a check failed, unknown if one could not tell."""
        grades = {check.grade for check in self.checks}
        worst = (Grade.FAILED, Grade.UNKNOWN, Grade.PASSED)
        return next((grade for grade in worst if grade in grades), Grade.UNKNOWN)

    @property
    def outside(self) -> dict[str, float]:
        """Share of the rows outside the envelope, by column; empty where there is none."""
        found = {}
        for c in self.channels:
            sd = self.traces.reach.get(c.name)
            if sd is not None:
                gap = self.traces.measured[c.signal] - self.traces.expected[c.signal]
                found[c.name] = float(np.mean(np.abs(gap[:, c.column]) > ENVELOPE_SD * sd))
        return found

    @property
    def wide(self) -> tuple[str, ...]:
        """Columns whose envelope is wider than they move: it tells next to nothing of them."""
        found = []
        for c in self.channels:
            sd = self.traces.reach.get(c.name)
            rows = self.traces.measured[c.signal][:, c.column]
            if sd is not None and ENVELOPE_SD * float(np.median(sd)) > float(np.nanstd(rows)):
                found.append(c.name)
        return tuple(found)

    @property
    def beyond_noise(self) -> tuple[ChannelComparison, ...]:
        """Channels with more than noise, the loudest first."""
        loud = [channel for channel in self.channels if channel.beyond_noise]
        return tuple(sorted(loud, key=lambda channel: -channel.loudness))

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        return {
            "name": self.name,
            "basis": self.basis.value,
            "quality": self.quality.value,
            "checks": [asdict(check) for check in self.checks],
            "start": self.start,
            "stop": self.stop,
            "rate": self.rate,
            "plant": self.plant,
            "plant_hash": self.plant_hash,
            "made_by": self.made_by,
            "mode": self.mode,
            "imposed": list(self.imposed),
            "slow_below": self.slow_below,
            "absent": list(self.absent),
            "notes": list(self.notes),
            "beyond_noise": [channel.name for channel in self.beyond_noise],
            "outside_envelope": self.outside,
            "channels": {channel.name: channel.to_dict() for channel in self.channels},
            "emulation_cost": asdict(self.cost) if self.cost else None,
        }


@dataclass(frozen=True)
class Comparison:
    """All recordings.

    Attributes:
        recordings: in the order given.
        excesses: limits of the tolerance that are not kept; None if no tolerance was given.
        versions: package -> version.
    """

    recordings: tuple[RecordingComparison, ...]
    excesses: tuple[Excess, ...] | None
    versions: Mapping[str, str]

    @property
    def in_tolerance(self) -> bool | None:
        """Whether every limit is kept; None if none was given."""
        return None if self.excesses is None else not self.excesses

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON; what cannot be told is null."""
        content = {
            "schema": SCHEMA,
            "in_tolerance": self.in_tolerance,
            "out_of_tolerance": [asdict(e) for e in self.excesses or ()],
            "recordings": [recording.to_dict() for recording in self.recordings],
            "versions": dict(self.versions),
        }
        plain = _plain(content)
        return plain if isinstance(plain, dict) else {}


def _plain(value: object) -> object:
    """A value as JSON has it: enumerations as text, NaN and infinity as null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, StrEnum):
        return value.value
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return value
    if isinstance(value, int):
        return int(value)
    number = float(value)  # type: ignore[arg-type]
    return number if math.isfinite(number) else None
