"""StabilityMap: lowest stable model mass against leg gain, full plant and one axis."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.control.leg_loop import EDGE, FilterPlace
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.json_text import json_text
from ves_twin.core.whole_file import write_whole
from ves_twin.core.workers import Workers
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.procedures.stability.confirm import Confirmation, confirm_by_run
from ves_twin.procedures.stability.map_point import MapPoint
from ves_twin.procedures.stability.one_axis import OneAxis
from ves_twin.procedures.stability.stability_bench import StabilityBench
from ves_twin.scenario.fields import Hertz, PerSecond, Seconds
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome

MAP_NAME, FIGURE_NAME = "stability_map.json", "stability_map.png"

ASIDE = 0.1
"""Runs confirm a limit from this share of it below and above."""


class StabilityMap(Procedure):
    """Lowest stable translational mass of an emulated base, for gains and filter places.

    The base is the scenario's, at rest; its damping, stiffness and rotational inertia stay. The
    limit comes from the Floquet multipliers of the whole sampled loop; at the gains of `confirm`
    runs of `duration` measure the growth a tenth below and above it. `scenario` is a name or a
    file.
    """

    scenario: str = "beam_horizontal_truth"
    gains: Annotated[tuple[Annotated[PerSecond, Field(gt=0)], ...], Field(min_length=1)]
    filters: Annotated[tuple[FilterPlace, ...], Field(min_length=1)] = tuple(FilterPlace)
    edge: Annotated[Hertz, Field(gt=0)] = EDGE
    lightest: Annotated[float, Field(gt=0)] = 10.0
    heaviest: Annotated[float, Field(gt=0)] = 190.0
    confirm: tuple[PerSecond, ...] = ()
    duration: Annotated[Seconds, Field(ge=5.0, le=600.0)] = 20.0
    workers: Annotated[int, Field(ge=1, le=64)] = 2

    def carry_out(self, conduct: RunContext) -> Result:
        """Find the limits, confirm some by runs, write the map and its picture."""
        if self.lightest >= self.heaviest:
            raise InvalidInputError(
                "lightest", self.lightest, f"less than heaviest {self.heaviest}"
            )
        Scenario.load(self.scenario)  # refused before anything is written
        # matplotlib is slow to import
        from ves_twin.procedures.stability.stability_figure import draw_map

        plant = conduct.plant or Plant.load(self.plant)
        jobs = [(self, plant, gain, place) for place in self.filters for gain in self.gains]
        with Workers(self.workers) as workers:
            points = workers.collect(
                map_point, jobs, lambda share: conduct.progress(share, "limits")
            )
        content: dict[str, JsonValue] = {
            "plant": plant.name,
            "plant_hash": plant.hash,
            "scenario": self.scenario,
            "points": [{**asdict(p), "share": p.share} for p in points],
        }
        text = json_text(content)
        write_whole(conduct.folder / MAP_NAME, text + "\n")
        draw_map(points, plant.name, conduct.folder / FIGURE_NAME)
        return Result(Outcome.COMPLETED, content, tuple(_table(points)))


def map_point(job: tuple[StabilityMap, Plant, float, FilterPlace]) -> MapPoint:
    """One point of the map: limit of the full plant and of the one axis, and runs beside it."""
    options, plant, gain, place = job
    changes = {"legs.gain": gain, "legs.filter": place.value, "legs.edge": options.edge}
    scenario = Scenario.load(options.scenario, changes)
    bench = StabilityBench(plant, scenario)
    own, limit = bench.vibration(), bench.mass_limit(options.lightest, options.heaviest)
    axis = OneAxis.of(plant, gain, place, options.edge, scenario.platform.rate)
    bounded = options.lightest < limit.mass < np.inf
    runs: tuple[Confirmation, ...] = ()
    if bounded and gain in options.confirm:
        masses = [limit.mass * (1.0 - ASIDE), limit.mass * (1.0 + ASIDE)]
        runs = tuple(
            confirm_by_run(plant, scenario, mass, bench.vibration(mass), options.duration)
            for mass in masses
        )
    return MapPoint(
        gain=gain,
        place=place.value,
        payload=bench.payload,
        limit=min(limit.mass, options.heaviest),
        bounded=bounded,
        frequency=limit.frequency,
        one_axis=axis.lowest_stable_ratio() * bench.payload,
        base_growth=own.growth,
        base_frequency=own.frequency,
        runs=runs,
    )


def _table(points: list[MapPoint]) -> list[str]:
    lines = [
        "  filter     gain  limit    of the    at     one axis   own base",
        "              1/s    kg    payload    Hz      of payload  1/s @ Hz",
    ]
    for p in points:
        mark = " " if p.bounded else "<" if p.share < 1.0 else ">"
        lines.append(
            f"  {p.place:9s} {p.gain:5.1f} {mark}{p.limit:6.1f}   {p.share:6.3f} {p.frequency:7.1f}"
            f"      {p.one_axis / p.payload:6.3f}   {p.base_growth:+6.2f} @ {p.base_frequency:.1f}"
        )
        lines += [
            f"      run at {r.mass:.1f} kg: {r.rate:+.2f} +- {r.sd:.2f} 1/s"
            f" at {r.frequency:.1f} Hz, {r.verdict}; multipliers {r.expected:+.2f} 1/s"
            for r in p.runs
        ]
    return lines
