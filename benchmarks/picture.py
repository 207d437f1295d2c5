"""The picture of the README: the rig in the beam scenario, and its motion against zero gravity.

Run by `make picture`; needs an OpenGL that MuJoCo can use off screen (MUJOCO_GL=egl or osmesa).
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl
import mujoco
import numpy as np

import ves_twin as vt

mpl.use("agg")
import matplotlib.pyplot as plt

MOMENTS = (0.0, 1.5, 2.5)
"""Times of the three views [s]: before, during and after the arm's half turn."""


def views(width: int, height: int) -> list[np.ndarray]:
    """Renderings of the rig at MOMENTS, from a run of the scenario."""
    sim = vt.Simulator(None, vt.Scenario.load("beam_horizontal_truth", {"run.duration": 3.0}))
    camera = mujoco.MjvCamera()
    camera.lookat[:], camera.distance = (0.0, 0.0, 1.05), 3.6
    camera.azimuth, camera.elevation = 128.0, -14.0
    found = []
    with mujoco.Renderer(sim.model, height, width) as renderer:
        for moment in MOMENTS:
            sim.advance(moment - sim.time)
            mujoco.mj_forward(sim.model, sim.data)
            renderer.update_scene(sim.data, camera)
            found.append(renderer.render().copy())
    return found


def main(path: Path) -> None:
    """Draw the picture into a file."""
    run = vt.simulate(vt.Scenario.load("beam_horizontal_truth"))
    figure = plt.figure(figsize=(12.0, 6.4), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(1.25, 1.0))
    for axes, image, moment in zip(top.subplots(1, 3), views(640, 560), MOMENTS, strict=True):
        axes.imshow(image)
        axes.set_title(f"t = {moment:g} s", fontsize=10)
        axes.axis("off")
    labels = (("Y [mm]", 1), ("rotation about Z [mrad]", 5))
    for axes, (label, column) in zip(bottom.subplots(1, 2), labels, strict=True):
        axes.plot(
            run.time, 1e3 * run["reference.pose"][:, column], "k", lw=1.0, label="zero gravity"
        )
        axes.plot(
            run.time, 1e3 * run["truth.pose"][:, column], "C0", lw=1.2, label="emulated by the rig"
        )
        axes.set_xlabel("time [s]")
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    axes.legend(loc="upper right", fontsize=9)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
