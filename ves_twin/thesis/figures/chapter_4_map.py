"""draw_figure_4_1: three faces of the coupling map, with the paths on the one they lie in."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.coupling_map import CouplingMap, coupling_map
from ves_twin.plant.plant import Plant
from ves_twin.plant.puma_chain import puma_chain
from ves_twin.procedures.planning.coupling_map_paths import CouplingMapPaths
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import save_picture
from ves_twin.thesis.figures.chapter_4_shipped import shipped
from ves_twin.thesis.figures.figure import FigureResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FACES = {"A": (1, 2), "B": (0, 1), "C": (0, 2)}
"""Joints of the faces of one quadrant, 0 to 90 deg each; the third joint is held at 0."""

COUNT = 100
"""Configurations along each side of a map."""

APART = np.radians(5.0)
"""A line is not begun nearer than this to another one."""

UPRIGHT = 30.0
"""A low direction counts as nearly vertical within this angle of the vertical axis [deg]."""

STYLES = {"good": ("C2", "Good path"), "straight": ("C0", "straight"), "bad": ("C3", "Bad path")}


def draw_figure_4_1(plant: Plant, folder: Path, quick: bool) -> FigureResult:
    """Lines of minimum energy, the darker the more a crossing costs, and the paths on face B."""
    procedure = shipped("coupling_map_paths", CouplingMapPaths)
    chain, base = puma_chain(plant), EmulatedSystem.load(procedure.emulated)
    angles = np.linspace(0.0, np.pi / 2, 30 if quick else COUNT)
    maps = {
        name: coupling_map(chain, base, joints, angles, angles, np.zeros(3))
        for name, joints in FACES.items()
    }
    shades = np.concatenate([face.most.ravel() for face in maps.values()])
    span = (float(shades.min()), float(shades.max()))
    figure = new_figure(4.2, 11.0)
    numbers: dict[str, float] = {}
    for axes, (name, face) in zip(figure.subplots(1, 3), maps.items(), strict=True):
        _draw_lines(axes, face, span)
        first, second = (joint + 1 for joint in face.joints)
        axes.set_title(f"face {name}", fontsize=10)
        axes.set_xlabel(f"joint {first} [deg]")
        axes.set_ylabel(f"joint {second} [deg]")
        tilt = np.degrees(np.arctan2(face.low[..., 0], np.abs(face.low[..., 1])))
        numbers[f"face {name}, coupling across the lines, least"] = float(face.most.min())
        numbers[f"face {name}, coupling across the lines, most"] = float(face.most.max())
        numbers[f"face {name}, median tilt of the lines from vertical [deg]"] = float(
            np.median(tilt)
        )
        share = 100.0 * float(np.mean(tilt < UPRIGHT))
        numbers[f"face {name}, lines within 30 deg of vertical [%]"] = share
        if name == "B":
            for kind, path in procedure.paths(chain, base).items():
                colour, label = STYLES[kind]
                axes.plot(*np.degrees(path[:, :2]).T, color=colour, lw=2, label=label)
            start, end = np.degrees(procedure.start), np.degrees(procedure.end)
            axes.text(start[0] - 4, start[1] + 1, "I", fontsize=12)
            axes.text(end[0] + 1, end[1] - 4, "F", fontsize=12)
            axes.legend(fontsize=8, loc="upper right")
    png = save_picture(figure, folder / "fig-4-1.png")
    notes = (
        "start and end are a choice: those of the thesis are lost",
        "Q in the form 'compliance'; the thesis does not print Q",
    )
    title = "Coupling map cross sections for the PUMA 560 on the bent beam"
    return FigureResult("fig-4-1", title, png, numbers, notes)


def _draw_lines(axes: Axes, face: CouplingMap, span: tuple[float, float]) -> None:
    from matplotlib.collections import LineCollection  # slow to import

    drawn = np.empty((0, 2))
    for place in _seeds(face):
        if len(drawn) and np.min(np.sum((drawn - place) ** 2, axis=1)) < APART**2:
            continue
        line = face.line(place, np.radians(0.5))
        drawn = np.vstack([drawn, line])
        i = np.clip(np.searchsorted(face.first, line[:, 0]), 0, len(face.first) - 1)
        j = np.clip(np.searchsorted(face.second, line[:, 1]), 0, len(face.second) - 1)
        grey = 0.85 * (span[1] - face.most[i, j]) / (span[1] - span[0])
        points = np.degrees(line)
        segments = np.stack([points[:-1], points[1:]], axis=1)
        colours = np.repeat(grey[:-1, None], 3, axis=1)
        axes.add_collection(LineCollection(list(segments), colors=colours, linewidths=1.3))
    axes.set_xlim(-5, 95)
    axes.set_ylim(-5, 95)
    axes.set_aspect("equal")


def _seeds(face: CouplingMap) -> FloatArray:
    """Places to begin lines, the middle first."""
    side = np.linspace(0.02, 0.98, 19) * (np.pi / 2)
    grid = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    middle = np.array([face.first.mean(), face.second.mean()])
    return np.asarray(grid[np.argsort(np.sum((grid - middle) ** 2, axis=1))])
