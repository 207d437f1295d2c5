"""Stop, Play, Hold: candidates that no function of the place alone can be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.candidate import Candidate
from ves_twin.effects.law import Law, LawShape


@dataclass(frozen=True)
class Stop(Candidate):
    """A contact that begins within the range."""

    side: int
    begin: float
    stiffness: float
    wide: float

    @property
    def start(self) -> FloatArray:
        """Begin, stiffness, damping, share of the load that it takes."""
        return np.array([self.begin, self.stiffness, 0.01 * self.stiffness, 0.3])

    @property
    def sd(self) -> FloatArray:
        """Wide: the range, ten times the stiffness that is begun with, all of the load."""
        return np.array([0.3 * self.wide, 10.0 * self.stiffness, self.stiffness, 1.0])

    @property
    def mean(self) -> FloatArray:
        """No contact at the place where the search begins."""
        return np.array([self.begin, 0.0, 0.0, 0.0])

    @property
    def steps(self) -> FloatArray:
        """Small enough not to leave the range in contact."""
        return np.array([0.003 * self.wide, 0.02 * self.stiffness, 0.002 * self.stiffness, 0.02])

    @property
    def chosen(self) -> int:
        """Its side."""
        return 1

    def law(self, numbers: FloatArray) -> Law:
        """A stop; stiffness and damping do not pull."""
        begin, stiffness, damping, share = numbers.tolist()
        values = (
            begin,
            float(self.side),
            max(stiffness, 0.0),
            max(damping, 0.0),
            min(max(share, 0.0), 1.0),
        )
        names = tuple(v.name for v in self.of)
        sign = ">" if self.side > 0 else "<"
        form = f"stop at x {sign} {begin:.4g}, stiffness {values[2]:.3g}, damping {values[3]:.3g}"
        return Law(self.place.name, self.place.kind, LawShape.STOP, names, (), values, form=form)

    @property
    def label(self) -> str:
        """With its shape."""
        return f"{super().label}: stop"


@dataclass(frozen=True)
class Play(Candidate):
    """A reading behind a gap."""

    @property
    def start(self) -> FloatArray:
        """A sixth of what a sensor may be off."""
        return np.array([self.place.scale / 6.0])

    @property
    def sd(self) -> FloatArray:
        """What a sensor may be off."""
        return np.array([self.place.scale])

    def law(self, numbers: FloatArray) -> Law:
        """A play."""
        gap = abs(float(numbers[0]))
        form = f"play of {gap:.3g} {self.place.unit}"
        kind = self.place.kind
        return Law(self.place.name, kind, LawShape.PLAY, (), (), (gap,), form=form)

    @property
    def label(self) -> str:
        """With its shape."""
        return f"{self.place.name}: play"


@dataclass(frozen=True)
class Hold(Candidate):
    """A reading that is renewed every few rows; how many was chosen by evidence."""

    rows: int

    @property
    def start(self) -> FloatArray:
        """No open number."""
        return np.zeros(0)

    @property
    def sd(self) -> FloatArray:
        """No open number."""
        return np.zeros(0)

    @property
    def chosen(self) -> int:
        """The rows."""
        return 1

    def law(self, numbers: FloatArray) -> Law:
        """A hold."""
        kind, form = self.place.kind, f"renewed every {self.rows} rows"
        return Law(self.place.name, kind, LawShape.HOLD, (), (), (float(self.rows),), form=form)

    @property
    def label(self) -> str:
        """With its shape."""
        return f"{self.place.name}: hold"
