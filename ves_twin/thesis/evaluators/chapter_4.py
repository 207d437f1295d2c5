"""CHAPTER_4: motion of an arm on a flexible base."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from ves_twin.plant.assembly import JOINTS, assemble_free_arm, compile_model
from ves_twin.thesis.claim import Claim
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluation import Answer, Evaluation, NotBuilt

PATHS = NotBuilt("the coupling map and its two joint paths (4.2)")
PPED = NotBuilt("poles and damping estimator of the arm on its base (4.3.2)")


def _base_mass(context: Context, claim: Claim) -> Evaluation:
    model = compile_model(assemble_free_arm(context.plant))
    links = [f"arm/link{i}" for i in range(len(JOINTS) + 1)]
    mass = sum(float(model.body(name).mass[0]) for name in links)
    return Evaluation((mass,), note="sum of the links in the model; the print is 0.3 kg off (E-27)")


def _order(context: Context, claim: Claim) -> Evaluation:
    model = compile_model(assemble_free_arm(context.plant))
    data = mujoco.MjData(model)
    data.qpos[6] = np.pi / 4  # any pose that is not singular
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return Evaluation(
        (float(np.linalg.matrix_rank(mass)), 2.0 * model.nv),
        note="rank of the mass matrix of the arm on a free base; two poles each",
    )


CHAPTER_4: Mapping[str, Answer] = {
    **dict.fromkeys(("C057", "C058", "C059"), PATHS),
    "C060": _base_mass,
    "C061": _order,
    **dict.fromkeys((f"C{number:03d}" for number in range(62, 72)), PPED),
}
"""Claim -> answer."""
