"""Recording: named signals on one clock; measured and simulated are the same type."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.signals import SIGNALS, Role, Signal
from ves_twin.core.types import FloatArray

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

LISTED = 6
"""Signals that `repr` lists before it counts the rest: it stays within ten lines."""

POSES = "poses"
"""Clock of a recording whose rows are poses at rest: time is only their order."""


@dataclass(frozen=True)
class Event:
    """Something that happened at a time [s] of a run."""

    time: float
    kind: str
    message: str


@dataclass(frozen=True)
class RecordingInfo:
    """Where a recording comes from; travels in the file's metadata.

    Attributes:
        origin: "simulated" or "measured".
        scenario: name of the scenario, empty if none.
        settings: the validated scenario as JSON, so that the run can be repeated.
        plant: name of the plant.
        plant_hash: hash of its physics.
        plant_base: plant that `parameters` differ from, so that the rig can be built again.
        parameters: values that differ from it, by dotted name.
        effects: what deviated from the description: kind, target, sizes.
        seed: seed of the noise.
        versions: package -> version.
        log: clock of the rows: admittance, leg or tick; POSES where rows are poses at rest.
        period: time between rows [s].
        held: slower signals -> time between their changes [s].
        outcome: how the run ended; "unfinished" while it runs or if it was killed.
        events: what happened.
        own_signals: signals that the rig's table lacks: another machine's, or extra sensors.
        imported: where measured data come from and what was done to them.
    """

    origin: str
    scenario: str = ""
    settings: str = "{}"
    plant: str = ""
    plant_hash: str = ""
    plant_base: str = ""
    parameters: Mapping[str, object] = field(default_factory=dict)
    effects: Mapping[str, object] = field(default_factory=dict)
    seed: int = 0
    versions: Mapping[str, str] = field(default_factory=dict)
    log: str = ""
    period: float = 0.0
    held: Mapping[str, float] = field(default_factory=dict)
    outcome: str = "unfinished"
    events: tuple[Event, ...] = ()
    own_signals: tuple[Signal, ...] = ()
    imported: Mapping[str, object] = field(default_factory=dict)

    def signal(self, name: str) -> Signal:
        """What a signal is: one of its own, or of the rig's table; raises UnknownNameError."""
        known = SIGNALS | {signal.name: signal for signal in self.own_signals}
        if name not in known:
            raise UnknownNameError("signal", name, known)
        return known[name]

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        return asdict(self)

    @staticmethod
    def from_dict(content: Mapping[str, object]) -> RecordingInfo:
        """From plain values; keys of later versions are passed over."""
        known = {f.name for f in fields(RecordingInfo)}
        values = {key: value for key, value in content.items() if key in known}
        events = values.pop("events", ()) or ()
        if not isinstance(events, list | tuple):
            raise InvalidInputError("events of a recording", events, "a list")
        kinds = {
            "settings": str,
            "versions": Mapping,
            "parameters": Mapping,
            "held": Mapping,
            "period": float | int,
            "imported": Mapping,
        }
        for key, kind in kinds.items():
            if key in values and not isinstance(values[key], kind):
                raise InvalidInputError(f"{key} of a recording", values[key], "another type")
        own = values.pop("own_signals", ()) or ()
        if not isinstance(own, list | tuple):
            raise InvalidInputError("own_signals of a recording", own, "a list")
        told = tuple(Event(**e) for e in events)
        return RecordingInfo(**values, events=told, own_signals=tuple(map(_signal, own)))  # type: ignore[arg-type]


def _fall(time: FloatArray) -> str:
    """Words for the first row whose time is no number, or not after that of the row before."""
    bad = ~np.isfinite(time)
    bad[1:] |= ~(np.diff(time) > 0.0)
    row = int(np.argmax(bad))
    before = f" after {time[row - 1]:.6g} s" if row else ""
    return f"{time[row]:.6g} s{before} in row {row + 1}"


def _signal(content: Mapping[str, Any]) -> Signal:
    axes, units = tuple(map(str, content["axes"])), tuple(map(str, content["units"]))
    words = {key: str(content[key]) for key in ("name", "frame", "meaning")}
    return Signal(axes=axes, units=units, role=Role(content["role"]), **words)


@dataclass(frozen=True)
class Recording(ReadOnly):
    """Named signals on one clock.

    Attributes:
        time: time of the rows [s], strictly increasing (n,).
        signals: name -> values (n, width), units of `info.signal(name)`.
        info: where the recording comes from.

    Raises:
        InvalidInputError: time that does not increase, or a signal of another length.
    """

    time: FloatArray
    signals: Mapping[str, FloatArray]
    info: RecordingInfo

    def __post_init__(self) -> None:
        super().__post_init__()
        if not np.all(np.isfinite(self.time)) or np.any(np.diff(self.time) <= 0):
            raise InvalidInputError(
                "recording time",
                _fall(self.time),
                "strictly increasing times; two runs in one file are two logs",
            )
        for name, values in self.signals.items():
            if values.ndim != 2 or values.shape[0] != len(self.time):
                raise InvalidInputError(
                    f"signal {name}", f"shape {values.shape}", f"({len(self.time)}, width)"
                )

    def __getitem__(self, name: str) -> FloatArray:
        try:
            return self.signals[name]
        except KeyError:
            raise UnknownNameError("signal", name, self.signals) from None

    def __len__(self) -> int:
        return len(self.time)

    def window(self, start: float, stop: float) -> Recording:
        """The rows with start <= t < stop [s]."""
        rows = (self.time >= start) & (self.time < stop)
        return Recording(
            self.time[rows], {name: v[rows] for name, v in self.signals.items()}, self.info
        )

    def __repr__(self) -> str:
        """What it is, how long, and its first signals with their units; at most ten lines."""
        info = self.info
        what = " ".join(filter(None, (info.origin, info.scenario or info.plant)))
        span = f"{self.time[0]:g} to {self.time[-1]:g} s" if len(self) else "empty"
        lines = [f"Recording: {what}, {len(self)} rows, {span}, {info.outcome}"]
        for name in list(self.signals)[:LISTED]:
            signal = info.signal(name)
            units = ", ".join(dict.fromkeys(signal.units))
            lines.append(f"  {name:<18} {signal.width} x [{units}]  {signal.meaning}")
        left = list(self.signals)[LISTED:]
        if left:
            few = ", ".join(left[:4]) + (" ..." if len(left) > 4 else "")
            lines.append(f"  and {len(left)} more: {few}")
        return "\n".join(lines)

    def to_pandas(self) -> pd.DataFrame:
        """The rows as a DataFrame indexed by time [s]; see `core.recording.data_frame`."""
        from ves_twin.core.recording.data_frame import data_frame

        return data_frame(self)

    def plot(self, *names: str) -> Figure:
        """Signals against time as a matplotlib figure; the first three if none is named."""
        from ves_twin.core.recording.plot import plot

        return plot(self, names or list(self.signals)[:3])
