"""Series: the recordings of all days, and the screen of the library over them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.diagnosis.model.forward import Hypothesis, Parameter
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.trend.day import Day
from ves_twin.diagnosis.trend.false_alarms import Limits, Scores, false_alarm_limits, scores
from ves_twin.diagnosis.trend.joint import Joint, directions
from ves_twin.diagnosis.trend.one_rig import OneRig, Sharing, one_rig
from ves_twin.diagnosis.trend.result import TrendStatistics
from ves_twin.diagnosis.trend.shapes import Shapes
from ves_twin.diagnosis.verdict.verdict import Findable

FOUND = 0.52
"""Normal quantile of 70 %: how often the smallest change is found."""


@dataclass(frozen=True)
class Series:
    """All recordings, and the screen of the library over them."""

    days: tuple[Day, ...]
    causes: tuple[Hypothesis, ...]
    joint: Joint
    shapes: Shapes
    limits: Limits
    found: Scores
    rig: OneRig

    @staticmethod
    def of(days: Sequence[Day], causes: tuple[Hypothesis, ...], settings: Settings) -> Series:
        """Screen recordings of one machine."""
        told = [day.telling(causes) for day in days]
        joint, shapes = Joint.of(told), Shapes(np.array([day.time for day in days]))
        alpha, p = settings.alpha, told[0].shared
        limits = false_alarm_limits(joint, shapes, causes, alpha, settings.seed)
        found = scores(joint, shapes, causes, joint.score[None])
        parts = [Sharing(t.information[:p, :p], t.score[:p]) for t in told]
        rig = one_rig(parts, days[0].shared, alpha, settings.seed)
        return Series(tuple(days), causes, joint, shapes, limits, found, rig)

    @property
    def statistics(self) -> TrendStatistics:
        """Best scores beside their limits."""
        found, limits = self.found, self.limits
        return TrendStatistics(
            float(found.change.max()),
            limits.change,
            float(found.varies.max()),
            limits.varies,
            float(found.constant.max()),
            limits.constant,
        )

    @property
    def suspicious(self) -> bool:
        """Whether anything wants an explanation."""
        s = self.statistics
        beyond = s.change > s.change_limit or s.varies > s.varies_limit
        return beyond or s.constant > s.constant_limit or any(day.off for day in self.days)

    def suspects(self, count: int) -> list[Hypothesis]:
        """Causes by what a size of their own on each day would take away."""
        free = [self.joint.free(h) for h in range(len(self.causes))]
        return [self.causes[h] for h in np.argsort(free)[::-1][:count]]

    def smallest(self) -> dict[str, Findable]:
        """Step in the middle of the series that each cause would have been found with."""
        middle = self.shapes.columns[(len(self.shapes.steps) - 1) // 2]
        found = {}
        for h, cause in enumerate(self.causes):
            power = self.joint.power(h)
            (row,) = directions(power, middle[None]) if np.any(power) else (0.0 * middle,)
            slope = abs(float(row @ power @ middle))
            size = float(np.sqrt(self.limits.change) + FOUND) / slope if slope > 0.0 else np.inf
            runs = self.days[0].bank.base.runs
            parameter = runs.coordinates[int(runs.indices(cause)[0])].parameter
            found[cause.label] = Findable(
                size if size <= cause.largest[0] else None, parameter.unit
            )
        return found

    def parameter(self, cause: Hypothesis) -> Parameter:
        """The number of a cause."""
        runs = self.days[0].bank.base.runs
        return runs.coordinates[int(runs.indices(cause)[0])].parameter
