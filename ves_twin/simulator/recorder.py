"""Recorder: rows from the compiled loop, completed with computed signals, handed to a sink."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from time import monotonic
from typing import Protocol

import numpy as np

from ves_twin.kinematics.stewart import StewartGeometry, pose_jacobian, track_poses
from ves_twin.signals import SIGNALS
from ves_twin.simulator.board import SLICES, WIDTH
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.reference import ZeroGravityReference
from ves_twin.types import FloatArray

BUFFER_SECONDS = 4.0
"""Simulated time that the buffer holds."""

FLUSH_SECONDS = 0.5
"""Rows leave the buffer at least this often in wall-clock time: what a kill can cost."""

IDEAL, LEG_LAG = "reference.pose", "reference.pose_leg_lag"


class Sink(Protocol):
    """Where rows go."""

    def write(self, time: FloatArray, signals: Mapping[str, FloatArray]) -> None:
        """Take rows: time [s] (n,) and signals (n, width)."""
        ...


class MemorySink:
    """Keeps rows in memory."""

    def __init__(self) -> None:
        self.parts: list[tuple[FloatArray, dict[str, FloatArray]]] = []

    def write(self, time: FloatArray, signals: Mapping[str, FloatArray]) -> None:
        """Keep the rows."""
        self.parts.append((time, dict(signals)))

    def collect(self) -> tuple[FloatArray, dict[str, FloatArray]]:
        """All rows: time (n,) and signals (n, width)."""
        times = np.concatenate([time for time, _ in self.parts]) if self.parts else np.zeros(0)
        names = self.parts[0][1] if self.parts else {}
        return times, {n: np.concatenate([part[n] for _, part in self.parts]) for n in names}


class NoSink:
    """Drops rows, for environments that read the board themselves."""

    def write(self, time: FloatArray, signals: Mapping[str, FloatArray]) -> None:
        """Drop the rows."""


@dataclass
class _Buffers:
    """What has not been handed to the sink yet, and where the computed signals stand."""

    rows: int
    cycles: int
    pose: FloatArray
    inverse: FloatArray

    def copy(self) -> _Buffers:
        return _Buffers(self.rows, self.cycles, self.pose.copy(), self.inverse.copy())


@dataclass(frozen=True)
class RecorderSnapshot:
    """Copy of the buffers, the references and the length of the memory sink."""

    at: _Buffers
    log: FloatArray
    points: FloatArray
    starts: FloatArray
    references: Mapping[str, FloatArray]
    kept: int


class Recorder:
    """Completes rows with the pose from leg lengths and the zero-g references, and passes them on.

    Args:
        clock: periods.
        geometry: what the computers believe of the platform, for the pose from leg lengths.
        guess: pose near the first row (6,).
        references: name of the signal -> reference, empty where there is nothing to emulate.
        sink: where rows go.
    """

    def __init__(
        self,
        clock: Clock,
        geometry: StewartGeometry,
        guess: FloatArray,
        references: Mapping[str, ZeroGravityReference],
        sink: Sink,
    ) -> None:
        self._clock = clock
        self._geometry = geometry
        self._references = dict(references)
        self.sink = sink
        self._cycle = clock.admittance * clock.tick
        capacity = int(BUFFER_SECONDS / self._cycle) + 1
        self.log = np.zeros((capacity * (clock.admittance // clock.log + 2), WIDTH + 1))
        self._points = np.zeros((capacity, 4, 3))
        self._starts = np.zeros(capacity)
        jacobian = pose_jacobian(guess, geometry.base, geometry.top, geometry.home)
        self._at = _Buffers(0, 0, guess.copy(), np.asarray(np.linalg.inv(jacobian)))
        self._flushed = monotonic()
        self.names = tuple(n for n in SIGNALS if n not in (IDEAL, LEG_LAG) or n in references)

    @property
    def rows(self) -> int:
        """Rows waiting in the buffer."""
        return self._at.rows

    @rows.setter
    def rows(self, rows: int) -> None:
        self._at.rows = rows

    def begin_cycle(self, time: float, points: FloatArray) -> None:
        """Note the arm's commands of the cycle that starts at a time [s]; flush when it is time."""
        if self._at.cycles == len(self._starts) or monotonic() - self._flushed > FLUSH_SECONDS:
            self.flush()
        self._starts[self._at.cycles] = time
        self._points[self._at.cycles] = points
        self._at.cycles += 1

    def flush(self) -> None:
        """Complete the waiting rows and hand them to the sink."""
        rows = self.log[: self._at.rows, 1:].copy()
        time = self.log[: self._at.rows, 0].copy()
        cycles = self._at.cycles
        self._at.rows = self._at.cycles = 0  # first, so that an interrupt cannot write rows twice
        self._flushed = monotonic()
        self._add_platform_pose(rows)
        for name, reference in self._references.items():
            self._add_reference(rows, time, name, reference, cycles)
        if len(time):
            self.sink.write(time, {name: rows[:, SLICES[name]] for name in self.names})

    def drop_references(self) -> None:
        """Stop integrating the zero-g references; their signals leave the recording."""
        self._references = {}
        self.names = tuple(n for n in self.names if n not in (IDEAL, LEG_LAG))

    def snapshot(self) -> RecorderSnapshot:
        """Buffers, references, and how much the memory sink holds."""
        return RecorderSnapshot(
            at=self._at.copy(),
            log=self.log[: self._at.rows].copy(),
            points=self._points.copy(),
            starts=self._starts.copy(),
            references={name: r.snapshot() for name, r in self._references.items()},
            kept=len(self.sink.parts) if isinstance(self.sink, MemorySink) else 0,
        )

    def restore(self, snapshot: RecorderSnapshot) -> None:
        """Go back to a snapshot; rows that a file already has stay there."""
        self._at = snapshot.at.copy()
        self.log[: self._at.rows] = snapshot.log
        self._points[:], self._starts[:] = snapshot.points, snapshot.starts
        for name, state in snapshot.references.items():
            self._references[name].restore(state)
        if isinstance(self.sink, MemorySink):
            del self.sink.parts[snapshot.kept :]

    def _add_platform_pose(self, rows: FloatArray) -> None:
        lengths = np.ascontiguousarray(rows[:, SLICES["leg.length"]])
        g = self._geometry
        at = self._at
        poses = track_poses(lengths, at.pose, at.inverse, g.base, g.top, g.home)
        rows[:, SLICES["platform.pose"]] = poses

    def _add_reference(
        self,
        rows: FloatArray,
        time: FloatArray,
        name: str,
        reference: ZeroGravityReference,
        count: int,
    ) -> None:
        poses = np.empty((count + 1, 6))
        rates = np.empty((count + 1, 6))
        for i in range(count):
            poses[i], rates[i] = reference.pose, reference.pose_rate
            reference.advance(self._points[i], self._cycle)
        poses[count], rates[count] = reference.pose, reference.pose_rate
        if self._clock.log == self._clock.admittance:
            rows[:, SLICES[name]] = poses[: len(rows)]
        elif len(rows):
            from scipy.interpolate import CubicHermiteSpline  # slow to import

            starts = np.append(self._starts[:count], self._starts[count - 1] + self._cycle)
            rows[:, SLICES[name]] = CubicHermiteSpline(starts, poses, rates)(time)
