"""Pictures of the pages: the rig in the beam scenario, and the answer of a diagnosis.

Run by `make picture`; needs an OpenGL that MuJoCo can use off screen (MUJOCO_GL=egl or osmesa).
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl
import mujoco
import numpy as np

import ves_twin as vt
from ves_twin.machines.diagnose import verdict_on
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.report.colours import MEASURED, REFERENCE
from ves_twin.report.diagnosis.pictures import draw_answer
from ves_twin.report.diagnosis.words import fitted_word
from ves_twin.report.picture import save_picture
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.mjcf import BlindMjcf

mpl.use("agg")
import matplotlib.pyplot as plt

FAULT = {"coulomb_friction@joint:level": 0.05}
"""What the picture of a diagnosis hides: dry friction of the joint [N m]."""

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


def answer(path: Path) -> None:
    """Draw a pendulum with dry friction that its model lacks, and the diagnosis of it."""
    bench = BlindMjcf(Rig.load("pendulum"))
    rng = np.random.default_rng(7)
    rig = BlindRig(bench.commissioned(rng) | FAULT)
    verdict = verdict_on([bench.record(rig, "train", rng)], "pendulum")
    if verdict.exhibit is None:
        raise SystemExit("the diagnosis has no traces")
    save_picture(draw_answer(verdict.exhibit, fitted_word(verdict)), path, 150)


def main(path: Path) -> None:
    """Draw the rig into a file, and an answer beside it."""
    answer(path.with_name("answer.png"))
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
            run.time,
            1e3 * run["reference.pose"][:, column],
            color=REFERENCE,
            lw=2.4,
            label="zero gravity",
        )
        axes.plot(
            run.time,
            1e3 * run["truth.pose"][:, column],
            color=MEASURED,
            lw=1.2,
            label="emulated by the rig",
        )
        axes.set_xlabel("time [s]")
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    axes.legend(loc="upper right", fontsize=9)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
