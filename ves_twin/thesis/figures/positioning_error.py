"""draw_figure_5_11: positioning error in the release of Table 5-2, without and with filter."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.plant.plant import Plant
from ves_twin.procedures.registry import load_procedure
from ves_twin.procedures.response.positioning_error import (
    AXES,
    PositioningErrorTest,
    compare_releases,
    draw_releases,
    reduction,
)
from ves_twin.thesis.figures.figure import FigureResult

QUICK_DURATION = 4.0


def draw_figure_5_11(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """The releases of the shipped procedure `positioning_error`."""
    test = load_procedure("positioning_error")
    if not isinstance(test, PositioningErrorTest):
        raise TypeError("scenarios/positioning_error.toml names another procedure")
    duration = QUICK_DURATION if quick else test.duration
    releases = compare_releases(plant, test.legs, duration)
    png = draw_releases(releases, folder / "fig-5-11.png")
    first = releases[0]
    numbers: dict[str, float] = {}
    for release in releases:
        for i, axis in enumerate(AXES):
            unit = "m" if i < 3 else "rad"
            numbers[f"rms {axis}, {release.label} [{unit}]"] = float(release.rms[i])
    for release in releases[1:]:
        cut = 100.0 * reduction(first.rms, release.rms)
        numbers[f"reduction, {release.label}, mean [%]"] = float(np.mean(cut))
        for axis, value in zip(AXES, cut, strict=True):
            numbers[f"reduction {axis}, {release.label} [%]"] = float(value)
    note = "error: commanded pose in force less true pose at the same instant"
    return FigureResult("fig-5-11", "Platform positioning errors", png, numbers, (note,))
