"""APPENDIX_B: the arm: lengths, masses, inertias, Jacobians."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.planning.virtual_manipulator import VirtualManipulator
from ves_twin.plant.assembly import JOINTS, assemble_fixed_arm, compile_model
from ves_twin.plant.puma_chain import puma_chain
from ves_twin.thesis.claim import Claim
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluation import Answer, Evaluation

LINKS = ("link0", "link1", "link2", "link3")
STEP = 1e-5
"""Step of the centred differences [rad]: errors of 1e-11 m/rad by curvature and by round-off."""


def _arm(context: Context) -> mujoco.MjModel:
    return compile_model(assemble_fixed_arm(context.plant))


def _poses(count: int) -> FloatArray:
    return np.random.default_rng(5).uniform(-np.pi, np.pi, (count, 3))


def _lengths(context: Context, claim: Claim) -> Evaluation:
    model, arm, worst = _arm(context), context.plant.arm, 0.0
    data = mujoco.MjData(model)
    for q in _poses(50):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        worst = max(worst, float(np.max(np.abs(data.site("tip").xpos - arm.tip(q)))))
    return Evaluation(
        (arm.d0, arm.d1, arm.d2, arm.d3, arm.a2, arm.a3),
        holds=worst < 1e-9,
        note=f"tip in MuJoCo against the DH formulas, 50 poses: {worst:.0e} m",
    )


def _masses(context: Context, claim: Claim) -> Evaluation:
    model = _arm(context)
    masses = tuple(float(model.body(name).mass[0]) for name in LINKS)
    return Evaluation(masses, note="bodies of the compiled model")


def _centres(context: Context, claim: Claim) -> Evaluation:
    """Centres of mass from MuJoCo's world, carried back into the DH frames of the links."""
    model, arm, q = _arm(context), context.plant.arm, _poses(1)[0]
    data = mujoco.MjData(model)
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    base = np.eye(4)
    base[2, 3] = arm.d0
    values: list[float] = []
    for name, frame in zip(LINKS, (base, *arm.transforms(q)), strict=True):
        com = frame[:3, :3].T @ (data.body(name).xipos - frame[:3, 3])
        values += [float(v) for v in com]
    return Evaluation(tuple(values), note="bodies of the compiled model, in link frames")


def _inertias(context: Context, claim: Claim) -> Evaluation:
    model = _arm(context)
    rotor = [0.0, 0.0, *(float(model.joint(name).armature[0]) for name in JOINTS[1:])]
    values: list[float] = []
    for name, extra in zip(LINKS, rotor, strict=True):
        xx, yy, zz = model.body(name).inertia
        values += [float(xx), float(yy), float(zz) + extra]
    note = "xx of link 3 is 0.020: with 0.015 no rigid body could have these (E-28)"
    return Evaluation(tuple(values), note=note)


def _jacobians(context: Context, claim: Claim) -> Evaluation:
    arm, worst = context.plant.arm, 0.0
    for q in _poses(50):
        jacobian = arm.jacobian(q, arm.tip(q))[:3]
        for j, step in enumerate(STEP * np.eye(3)):
            slope = (arm.tip(q + step) - arm.tip(q - step)) / (2.0 * STEP)
            worst = max(worst, float(np.max(np.abs(jacobian[:, j] - slope))))
    return Evaluation((worst,), note="tip, 50 poses; minus signs lost in the print (E-29)")


def _virtual(context: Context, claim: Claim) -> Evaluation:
    chain = puma_chain(context.plant)
    frames = context.plant.arm.transforms(np.zeros(3))[:, :3, :3]
    to_tip, to_base = (
        make(chain).links for make in (VirtualManipulator.to_endpoint, VirtualManipulator.to_base)
    )
    values = (to_tip[0, 2], (frames[0].T @ to_tip[1])[2], (frames[2].T @ to_base[3])[0])
    note = "body-consistent lengths: R1 = d1 - r0z = 0.389 m, and 93.7 kg (E-41)"
    return Evaluation(tuple(map(float, values)), note=note)


APPENDIX_B: Mapping[str, Answer] = {
    "C107": _lengths,
    "C108": _masses,
    "C109": _centres,
    "C110": _inertias,
    "C111": _jacobians,
    "C112": _virtual,
}
"""Claim -> answer."""
