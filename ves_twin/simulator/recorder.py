"""Recorder: rows from the compiled loop, completed with computed signals, handed to a sink."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass
from time import monotonic
from typing import Protocol

import numpy as np

from ves_twin.core.read_only import ReadOnly
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray, IntArray
from ves_twin.mechanics.kinematics.stewart import StewartGeometry, pose_jacobian, track_poses
from ves_twin.simulator.beside import Beside
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.log_faults import LogFaults, LogTail
from ves_twin.simulator.reference import ZeroGravityReference
from ves_twin.simulator.signal_bus import SLICES, WIDTH

BUFFER_SECONDS = 1.0
"""Simulated time that the buffer holds: with more, a run waits longer for its last references."""

FLUSH_SECONDS = 0.5
"""Rows leave the buffer at least this often in wall-clock time: what a kill can cost."""

Notes = tuple[FloatArray, IntArray, IntArray, FloatArray, int, int]
"""Rows, then ticks, first rows and arm commands of cycles; how many rows and cycles are in them."""

IDEAL, LEG_LAG = "reference.pose", "reference.pose_leg_lag"

_NO_TIME = np.zeros(0)


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
    """Drops rows uncompleted, for environments that read the board themselves."""

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
class RecorderSnapshot(ReadOnly):
    """Copy of the buffers, the references and the length of the memory sink."""

    at: _Buffers
    log: FloatArray
    points: FloatArray
    ticks: IntArray
    first_rows: IntArray
    references: Mapping[str, FloatArray]
    tail: LogTail
    kept: int


class Recorder:
    """Completes rows with the pose from leg lengths and the zero-g references, and passes them on.

    It does so in a thread while the run goes on: on a second core the references cost no time.
    What is asked of the recorder from outside waits for that thread.

    Args:
        clock: periods.
        geometry: what the computers believe of the platform, for the pose from leg lengths.
        guess: pose near the first row (6,).
        references: name of the signal -> reference, empty where there is nothing to emulate.
        sink: where rows go.
        absent: signals that the rig does not have.
        faults: what the log makes of the rows.
    """

    def __init__(
        self,
        clock: Clock,
        geometry: StewartGeometry,
        guess: FloatArray,
        references: Mapping[str, ZeroGravityReference],
        sink: Sink,
        absent: Set[str] = frozenset(),
        faults: LogFaults | None = None,
    ) -> None:
        self._clock = clock
        self._geometry = geometry
        self._references = dict(references)
        self.sink = sink
        self._faults = faults or LogFaults(())
        self._cycle = clock.admittance * clock.tick
        capacity = int(BUFFER_SECONDS / self._cycle) + 1
        self.log = np.zeros((capacity * (clock.admittance // clock.log + 2), WIDTH + 1))
        self._points = np.zeros((capacity, 4, 3))
        self._ticks = np.zeros(capacity, np.int64)
        self._first_rows = np.zeros(capacity, np.int64)
        jacobian = pose_jacobian(guess, geometry.base, geometry.top, geometry.home)
        self._at = _Buffers(0, 0, guess.copy(), np.asarray(np.linalg.inv(jacobian)))
        self._flushed = monotonic()
        self._beside = Beside()
        absent = {*absent, *({IDEAL, LEG_LAG} - set(references))}
        self.names = tuple(name for name in SIGNALS if name not in absent)

    @property
    def rows(self) -> int:
        """Rows waiting in the buffer."""
        return self._at.rows

    @rows.setter
    def rows(self, rows: int) -> None:
        self._at.rows = rows

    def begin_cycle(self, tick: int, points: FloatArray) -> None:
        """Note tick and arm commands of the cycle that starts now; flush when it is time."""
        self._flush_in_time()
        cycle = self._at.cycles
        self._ticks[cycle], self._first_rows[cycle] = tick, self._at.rows
        self._points[cycle] = points
        self._at.cycles += 1

    def notes(self) -> Notes:
        """The buffers for compiled cycles, with room in them; `noted` tells what came in."""
        self._flush_in_time()
        at = self._at
        return self.log, self._ticks, self._first_rows, self._points, at.rows, at.cycles

    def noted(self, rows: int, cycles: int) -> None:
        """So many rows and cycles are in the buffers now."""
        self._at.rows, self._at.cycles = rows, cycles

    def flush(self, unfinished: bool = False) -> None:
        """Hand the waiting rows to the sink, and return when it has them.

        Args:
            unfinished: also those of the cycle under way; only at the end of a run, since a
                cycle is handed over once.

        Raises:
            VesTwinError: the sink refused rows, these or earlier ones.
        """
        at = self._at
        if unfinished or at.cycles == 0:
            self._hand_over(at.rows, at.cycles)
        else:
            self._hand_over(int(self._first_rows[at.cycles - 1]), at.cycles - 1)
        self._beside.wait()

    def _flush_in_time(self) -> None:
        if self._at.cycles == len(self._ticks) or monotonic() - self._flushed > FLUSH_SECONDS:
            self._hand_over(self._at.rows, self._at.cycles)

    def _hand_over(self, count: int, cycles: int) -> None:
        """Have the first rows completed and handed on beside; move what is left to the front."""
        self._beside.wait()
        at = self._at
        rows, time = self.log[:count, 1:].copy(), self.log[:count, 0].copy()
        ticks, points = self._ticks[:cycles].copy(), self._points[:cycles].copy()
        left, cycles_left = at.rows - count, at.cycles - cycles
        self.log[:left] = self.log[count : at.rows].copy()
        for buffer in (self._ticks, self._points, self._first_rows):
            buffer[:cycles_left] = buffer[cycles : at.cycles].copy()
        self._first_rows[:cycles_left] -= count
        at.rows, at.cycles = left, cycles_left  # first, so that an interrupt writes no row twice
        self._flushed = monotonic()
        sink = self.sink
        if not isinstance(sink, NoSink):
            self._beside.start(lambda: self._complete(sink, rows, time, ticks, points))

    def _complete(
        self, sink: Sink, rows: FloatArray, time: FloatArray, ticks: IntArray, points: FloatArray
    ) -> None:
        """Add the computed signals to rows and hand these to the sink."""
        self._add_platform_pose(rows)
        for name, reference in self._references.items():
            self._add_reference(rows, time, name, reference, ticks, points)
        if len(time):
            signals = {name: rows[:, SLICES[name]] for name in self.names}
            sink.write(time, self._faults.logged(time, signals))

    def collect(self) -> tuple[FloatArray, dict[str, FloatArray]]:
        """All rows that are kept in memory: time [s] (n,) and every signal (n, width).

        A run that ended before its first row has every signal, too, of no rows.
        """
        self._beside.wait()
        time, kept = self.sink.collect() if isinstance(self.sink, MemorySink) else (_NO_TIME, {})
        empty = {name: np.zeros((0, SIGNALS[name].width)) for name in self.names}
        return time, empty | kept

    def drop_references(self) -> None:
        """Stop integrating the zero-g references; their signals leave the recording."""
        self._beside.wait()
        self._references = {}
        self.names = tuple(n for n in self.names if n not in (IDEAL, LEG_LAG))

    def snapshot(self) -> RecorderSnapshot:
        """Buffers, references, and how much the memory sink holds."""
        self._beside.wait()
        return RecorderSnapshot(
            at=self._at.copy(),
            log=self.log[: self._at.rows].copy(),
            points=self._points.copy(),
            ticks=self._ticks.copy(),
            first_rows=self._first_rows.copy(),
            references={name: r.snapshot() for name, r in self._references.items()},
            tail=self._faults.tail,
            kept=len(self.sink.parts) if isinstance(self.sink, MemorySink) else 0,
        )

    def restore(self, snapshot: RecorderSnapshot) -> None:
        """Go back to a snapshot; rows that a file already has stay there."""
        self._beside.wait()
        self._at = snapshot.at.copy()
        self.log[: self._at.rows] = snapshot.log
        self._points[:] = snapshot.points
        self._faults.tail = snapshot.tail
        self._ticks[:], self._first_rows[:] = snapshot.ticks, snapshot.first_rows
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
        ticks: IntArray,
        points: FloatArray,
    ) -> None:
        poses, rates, _ = reference.advance(points, self._cycle)
        if self._clock.log == self._clock.admittance:
            rows[:, SLICES[name]] = poses[: len(rows)]
        elif len(rows):
            from scipy.interpolate import CubicHermiteSpline  # slow to import

            # from whole ticks, so that a knot has the same bits wherever a flush falls
            knots = np.append(ticks, ticks[-1] + self._clock.admittance) * self._clock.tick
            rows[:, SLICES[name]] = CubicHermiteSpline(knots, poses, rates)(time)
