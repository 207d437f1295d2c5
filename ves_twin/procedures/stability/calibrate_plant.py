"""CalibratePlant: the invented numbers, fitted so that the thesis's claims hold together."""

from __future__ import annotations

import json
from typing import Annotated, Self

import numpy as np
from pydantic import Field, JsonValue, model_validator

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.core.types import FloatArray
from ves_twin.core.workers import Workers
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.procedures.stability.calibration_files import Fit, write_fit
from ves_twin.procedures.stability.claims import KNOWN_CLAIMS, Evaluation, Gains, measure_claims
from ves_twin.procedures.stability.feasible import Feasible
from ves_twin.scenario.fields import Part, PerSecond, named
from ves_twin.simulator.outcome import Outcome

GAINS = ("gain.low", "gain.high")
"""Leg gains that are fitted like numbers of the plant; the K1 scale is not in the thesis."""

SHORTEST = 0.01
"""Reach below which a search ends."""

GAIN = 0.01
"""Gain of the worst margin that is worth another round."""


class Claim(Part):
    """A claim that holds from `low` to `high`; `scale` beyond a bound is a margin of 1."""

    name: Annotated[str, named("claim", KNOWN_CLAIMS)]
    low: float | None = None
    high: float | None = None
    scale: Annotated[float, Field(gt=0)]

    @model_validator(mode="after")
    def _has_a_bound(self) -> Self:
        if self.low is None and self.high is None:
            raise ValueError(f"claim '{self.name}' has neither low nor high")
        return self

    def margins(self, value: float) -> dict[str, float]:
        """Distance of a value from each bound in units of `scale`, positive inside."""
        found = {}
        if self.low is not None:
            found[f"{self.name} >="] = (value - self.low) / self.scale
        if self.high is not None:
            found[f"{self.name} <="] = (self.high - value) / self.scale
        return found


class Knob(Part):
    """A number that is fitted, within a range."""

    name: str
    low: Annotated[float, Field(gt=0)]
    high: Annotated[float, Field(gt=0)]


class LegGains(Part):
    """Leg gains at which the claims are looked at."""

    low: Annotated[PerSecond, Field(gt=0)] = 12.6
    raised: Annotated[PerSecond, Field(gt=0)] = 16.0
    high: Annotated[PerSecond, Field(gt=0)] = 20.9


class CalibratePlant(Procedure):
    """Successive linear programmes for the largest worst margin of all claims.

    Each round takes forward differences of all margins to the logarithms of the knobs, finds the
    change with the largest worst margin within `reach`, tries it and its half on the plant, and
    keeps the better one if it gains; else the reach shrinks. No rounds: the margins and their
    sensitivities as the plant stands.
    """

    gains: LegGains = LegGains()
    claims: Annotated[tuple[Claim, ...], Field(min_length=1)]
    knobs: Annotated[tuple[Knob, ...], Field(min_length=1)]
    rounds: Annotated[int, Field(ge=0, le=50)] = 4
    reach: Annotated[float, Field(gt=0, le=1)] = 0.15
    difference: Annotated[float, Field(gt=0, le=0.3)] = 0.04
    verify: bool = True
    workers: Annotated[int, Field(ge=1, le=64)] = 2

    def carry_out(self, conduct: RunContext) -> Result:
        """Fit, say what pulls against what, and write the plant and its entries."""
        plant = conduct.plant or Plant.load(self.plant)
        for knob in self.knobs:
            single = (n for n, p in plant.parameters.items() if p.per_leg or not p.value.shape)
            known = {*GAINS, *single}
            if knob.name not in known:
                raise UnknownNameError("number to fit", knob.name, known)
        start = np.log([self._present(plant, knob.name) for knob in self.knobs])
        low, high = (np.log([getattr(k, end) for k in self.knobs]) for end in ("low", "high"))
        if np.any(start < low) or np.any(start > high):
            worst = self.knobs[int(np.argmax(np.maximum(low - start, start - high)))]
            value = self._present(plant, worst.name)
            raise InvalidInputError(worst.name, value, f"a start in {worst.low} ... {worst.high}")
        at, history, region, values = self._search(plant, start, low, high, conduct)
        widths = np.array([region.width(i) for i in range(len(at))])
        ends = np.column_stack(
            [np.maximum(widths[:, 0], low - at), np.minimum(widths[:, 1], high - at)]
        )
        spread = np.exp(at) * 0.5 * (ends[:, 1] - ends[:, 0])
        fit = Fit(
            plant=plant,
            names=tuple(knob.name for knob in self.knobs),
            start=np.exp(start),
            values=np.exp(at),
            spread=spread,
            claims=values,
            region=region,
            history=tuple(history),
            at_ends=self._at_ends(plant, at, ends, conduct) if self.verify else {},
        )
        lines = write_fit(fit, self.claims_text(), conduct.folder)
        content: dict[str, JsonValue] = json.loads(
            (conduct.folder / "calibration.json").read_text(encoding="utf-8")
        )
        return Result(Outcome.COMPLETED, content, tuple(lines))

    def claims_text(self) -> dict[str, str]:
        """Each claim's bounds as text."""
        return {
            c.name: " ... ".join("" if b is None else f"{b:g}" for b in (c.low, c.high))
            for c in self.claims
        }

    def _search(
        self, plant: Plant, at: FloatArray, low: FloatArray, high: FloatArray, conduct: RunContext
    ) -> tuple[FloatArray, list[float], Feasible, dict[str, float]]:
        """Best point found, worst margin of each round, region about it, values at it."""
        reach, rounds = self.reach, 0
        region, values = self._linearise(plant, at, conduct, rounds)
        history = [float(np.min(region.margins))]
        while rounds < self.rounds and reach > SHORTEST:
            rounds += 1
            steps = [region.step(low - at, high - at, reach / part) for part in (1.0, 2.0)]
            worst = self._worst(plant, [at + step for step in steps])
            best = int(np.argmax(worst))
            if worst[best] > history[-1] + GAIN:
                at = at + steps[best]
                region, values = self._linearise(plant, at, conduct, rounds)
                history.append(float(np.min(region.margins)))
            reach *= 0.5**best if worst[best] > history[-1] - GAIN else 0.25
        return at, history, region, values

    def _linearise(
        self, plant: Plant, at: FloatArray, conduct: RunContext, rounds: int
    ) -> tuple[Feasible, dict[str, float]]:
        points = [at, *(at + self.difference * row for row in np.eye(len(at)))]
        jobs = [self._evaluation(plant, point) for point in points]
        share = 1.0 / (self.rounds + 1 + self.verify)
        with Workers(self.workers) as workers:
            found = workers.collect(
                measure_claims,
                jobs,
                lambda done: conduct.progress(share * (rounds + done), f"round {rounds}"),
            )
        rows = [self._margins(values) for values in found]
        margins = np.array([list(row.values()) for row in rows])
        jacobian = (margins[1:] - margins[0]).T / self.difference
        return Feasible(tuple(rows[0]), margins[0], jacobian), found[0]

    def _at_ends(
        self, plant: Plant, at: FloatArray, ends: FloatArray, conduct: RunContext
    ) -> dict[str, list[float]]:
        """Worst margin with one knob at each end of its width, measured, not linearised."""
        if not np.all(np.isfinite(ends)):
            return {}
        points = [
            at + ends[i, side] * row for i, row in enumerate(np.eye(len(at))) for side in (0, 1)
        ]
        jobs = [self._evaluation(plant, point) for point in points]
        with Workers(self.workers) as workers:
            found = workers.collect(
                measure_claims, jobs, lambda share: conduct.progress(0.9, "ends")
            )
        worst = [min(self._margins(values).values()) for values in found]
        return {k.name: worst[2 * i : 2 * i + 2] for i, k in enumerate(self.knobs)}

    def _worst(self, plant: Plant, points: list[FloatArray]) -> list[float]:
        """Worst margin at each point; minus infinity for a plant that cannot stand."""
        jobs = [self._evaluation(plant, point) for point in points]
        with Workers(self.workers) as workers:
            found = workers.collect(_measure_or_nothing, jobs)
        return [min(self._margins(v).values()) if v else -np.inf for v in found]

    def _margins(self, values: dict[str, float]) -> dict[str, float]:
        rows: dict[str, float] = {}
        for claim in self.claims:
            rows.update(claim.margins(values[claim.name]))
        return rows

    def _evaluation(self, plant: Plant, at: FloatArray) -> Evaluation:
        values = dict(zip((k.name for k in self.knobs), np.exp(at).tolist(), strict=True))
        gains = Gains(
            low=values.pop("gain.low", self.gains.low),
            raised=self.gains.raised,
            high=values.pop("gain.high", self.gains.high),
        )
        return Evaluation(plant.with_values(values), gains, frozenset(c.name for c in self.claims))

    def _present(self, plant: Plant, name: str) -> float:
        if name in GAINS:
            return float(getattr(self.gains, name.removeprefix("gain.")))
        return plant.parameters.number(name)


def _measure_or_nothing(evaluation: Evaluation) -> dict[str, float]:
    try:
        return measure_claims(evaluation)
    except VesTwinError:
        return {}
