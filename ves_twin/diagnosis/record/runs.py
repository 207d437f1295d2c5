"""Runs: predictions of a forward on the analysis grid, for all recordings together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from ves_twin.core.budget import Budget
from ves_twin.core.types import BoolArray, FloatArray, IntArray, SingleArray
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.model.forward import Excitation, Forward, Hypothesis, Parameter
from ves_twin.diagnosis.model.grid import AnalysisGrid
from ves_twin.diagnosis.record.last_runs import LastRuns

Progress = Callable[[float, str], None]
"""Called with the share done, 0 to 1, and what is being done."""


POINTS = 2
"""Points whose columns are kept: where a choice of causes was made, and where its fit ended."""


def silent(share: float, what: str) -> None:
    """Progress that tells nobody."""


@dataclass(frozen=True)
class Coordinate:
    """One axis of the space of departures: a parameter, in one recording or in all (-1)."""

    parameter: Parameter
    recording: int = -1


@dataclass(frozen=True)
class Runs:
    """Predictions of all recordings, stacked by rows, from one vector of departures.

    A departure is a value minus its nominal, one for each coordinate; a parameter that is drawn
    anew for each recording has a coordinate for each.

    Attributes:
        forward: the plant.
        programmes: what was fed in, one for each recording.
        columns: channels of the forward that were recorded.
        workers: that share many predictions out.
        holes: rows of the grid without a measurement, (rows, c) of each recording; () for none.
    """

    forward: Forward
    programmes: tuple[Excitation, ...]
    columns: tuple[int, ...]
    workers: Workers = field(default_factory=Workers, compare=False)
    holes: tuple[BoolArray, ...] = ()
    _last: LastRuns = field(default_factory=LastRuns, init=False, compare=False, repr=False)
    _columns: LastRuns = field(
        default_factory=lambda: LastRuns(POINTS), init=False, compare=False, repr=False
    )

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The axes of the space of departures."""
        axes = []
        for parameter in self.forward.parameters:
            copies = range(len(self.programmes)) if parameter.per_recording else (-1,)
            axes += [Coordinate(parameter, k) for k in copies]
        return tuple(axes)

    @cached_property
    def own(self) -> list[IntArray]:
        """Coordinates that each recording feels."""
        owners = np.array([axis.recording for axis in self.coordinates])
        return [np.flatnonzero((owners == -1) | (owners == k)) for k in range(len(self.programmes))]

    @property
    def budget(self) -> Budget:
        """Time that is left."""
        return self.workers.budget

    @cached_property
    def sd(self) -> FloatArray:
        """Commissioning sd of each coordinate."""
        return np.array([axis.parameter.sd for axis in self.coordinates])

    @cached_property
    def nuisances(self) -> IntArray:
        """Coordinates with a commissioning sd."""
        return np.flatnonzero(self.sd > 0.0)

    @cached_property
    def low(self) -> FloatArray:
        """Lower bound of each departure."""
        return np.array([a.parameter.low - a.parameter.nominal for a in self.coordinates])

    @cached_property
    def high(self) -> FloatArray:
        """Upper bound of each departure."""
        return np.array([a.parameter.high - a.parameter.nominal for a in self.coordinates])

    @cached_property
    def grids(self) -> tuple[AnalysisGrid, ...]:
        """Analysis grid of each recording."""
        return tuple(self._grid(programme) for programme in self.programmes)

    @staticmethod
    def _grid(programme: Excitation) -> AnalysisGrid:
        if programme.poses:
            return AnalysisGrid(programme.period, 1)
        return AnalysisGrid.of(programme.period, programme.rate)

    @cached_property
    def times(self) -> tuple[FloatArray, ...]:
        """Times of the grid's rows of each recording [s]."""
        pairs = zip(self.grids, self.programmes, strict=True)
        return tuple(grid.times(programme.time) for grid, programme in pairs)

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """Rows of each recording in the stack."""
        ends = np.cumsum([0, *(len(time) for time in self.times)])
        return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))

    @property
    def kept(self) -> BoolArray:
        """Rows of the grid that were measured (rows, c)."""
        if self.holes:
            return ~np.concatenate(self.holes)
        return np.ones((self.slices[-1].stop, len(self.columns)), bool)

    @property
    def origin(self) -> FloatArray:
        """No departure."""
        return np.zeros(len(self.coordinates))

    def indices(self, hypothesis: Hypothesis) -> IntArray:
        """Coordinates that a hypothesis moves."""
        names = [axis.parameter.name for axis in self.coordinates]
        return np.array([names.index(name) for name in hypothesis.parameters], int)

    def depart(self, base: FloatArray, where: IntArray, sizes: FloatArray) -> FloatArray:
        """Departures with some coordinates set, held within bounds."""
        shift = base.copy()
        shift[where] = sizes
        return np.clip(shift, self.low, self.high)

    def one(self, shift: FloatArray, refined: bool = False) -> SingleArray:
        """Prediction (rows, channels) at a vector of departures."""
        return np.concatenate([self._of(k, shift, refined) for k in range(len(self.programmes))])

    def _of(self, recording: int, shift: FloatArray, refined: bool) -> SingleArray:
        """Of one recording; as it was where none of its own departures has changed since."""
        own = self.own[recording]
        key = (recording, refined, shift[own].tobytes())
        several = len(self.programmes) > 1
        if several and (there := self._last.get(key)) is not None:
            return there
        programme, grid = self.programmes[recording], self.grids[recording]
        rows = self.forward.simulate(programme, self.values(recording, shift), refined)
        found = grid.reduce(rows[:, list(self.columns)])
        if several:
            self._last.keep(key, found)
        return found

    def values(self, recording: int, shift: FloatArray) -> dict[str, float]:
        """Parameter -> value in a recording, at a vector of departures."""
        parts = ((self.coordinates[i].parameter, float(shift[i])) for i in self.own[recording])
        return {parameter.name: parameter.nominal + move for parameter, move in parts}

    def columns_at(self, point: FloatArray, compute: Callable[[], SingleArray]) -> SingleArray:
        """Columns about a point (k, rows, channels), as they were if they were asked for before.

        Several starts of one fit, and several choices of causes, begin at one point.
        """
        key = (0, False, point.tobytes())
        found = self._columns.get(key)
        if found is None:
            found = compute()
            found.setflags(write=False)
            self._columns.keep(key, found)
        return found

    def many(
        self, shifts: Sequence[FloatArray], progress: Progress = silent, what: str = ""
    ) -> SingleArray:
        """Predictions (k, rows, channels) at many departures, by the workers."""
        return np.stack(list(self._each(shifts, progress, what))) if len(shifts) else self._none()

    def _none(self) -> SingleArray:
        rows = sum(len(time) for time in self.times)
        return np.zeros((0, rows, len(self.columns)), np.float32)

    def _each(
        self, shifts: Sequence[FloatArray], progress: Progress, what: str
    ) -> Iterator[SingleArray]:
        total = len(shifts)
        chunk = max(1, total // (8 * self.workers.count))
        for i, stack in enumerate(self.workers.map(self.one, shifts, chunk)):
            progress((i + 1) / total, what)
            yield stack
