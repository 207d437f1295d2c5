"""Trials: linearisations of many programmes in turn, each by the runs that it needs of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ves_twin.core.types import IntArray, SingleArray
from ves_twin.diagnosis.bank.linearise import Linearisation, linearise
from ves_twin.diagnosis.experiment.separation import Axes
from ves_twin.diagnosis.record.runs import Runs

FORWARD_STEP = 1.0
"""Commissioning sd of one-sided differences: where tolerances are many, the search takes them."""


@dataclass(frozen=True)
class Trials:
    """What only adds to the channels is known of one programme, and holds for all of its rows.

    Attributes:
        names: of the tolerances that are taken; all of the plant if None.
    """

    names: Sequence[str] | None
    _added: dict[bytes, SingleArray] = field(default_factory=dict)

    def at(self, runs: Runs) -> tuple[Linearisation, Axes]:
        """At nominal, of one programme, with its axes.

        Tolerances of some names are taken by differences to one side, for half the runs.
        """
        where = self._axes(runs)
        adds = np.array([runs.coordinates[i].parameter.additive for i in where], bool)
        step = None if self.names is None else FORWARD_STEP
        moved, axes = where[~adds], (where, runs.sd[where])
        base = linearise(runs, runs.origin, axes=(moved, runs.sd[moved]), forward_step=step)
        columns = np.empty((len(where) + 1, *base.prediction.shape), np.float32)
        columns[np.append(~adds, True)] = base.columns
        if np.any(adds):
            columns[np.append(adds, False)] = self._known(runs, where[adds])
        return replace(base, columns=columns, bends=np.zeros(len(columns))), axes

    def _axes(self, runs: Runs) -> IntArray:
        named = runs.nuisances
        if self.names is not None:
            kept = [runs.coordinates[i].parameter.name in self.names for i in named]
            named = named[np.array(kept, bool)]
        return named

    def _known(self, runs: Runs, added: IntArray) -> SingleArray:
        rows = runs.times[0].tobytes()
        if rows not in self._added:
            axes = (added, runs.sd[added])
            there = linearise(runs, runs.origin, axes=axes, forward_step=FORWARD_STEP)
            if not np.all(np.isfinite(there.prediction)):
                return there.columns[:-1]
            self._added[rows] = there.columns[:-1]
        return self._added[rows]
