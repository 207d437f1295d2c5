"""CHAPTER_4: motion of an arm on a flexible base."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from ves_twin.control.emulated import EmulatedSystem
from ves_twin.errors import UnknownNameError
from ves_twin.planning.flexible_base import (
    HIGH_GAINS,
    PPED_GAINS,
    FlexibleBaseArm,
    JointGains,
)
from ves_twin.planning.pped import damping_estimator, strain_energy_integral
from ves_twin.planning.puma import puma_chain
from ves_twin.plant.assembly import JOINTS, assemble_free_arm, compile_model
from ves_twin.procedures.coupling_map_paths import CouplingMapPaths
from ves_twin.procedures.registry import load_procedure
from ves_twin.thesis.claim import Claim
from ves_twin.thesis.context import Context, Models
from ves_twin.thesis.evaluation import Answer, Evaluation, NotBuilt

PATHS = "coupling_map_paths"
"""Procedure of the good and the bad path (4.2)."""

POSE = (45.0, 0.0, 0.0)
"""Joint angles [deg] about which the PPED gains are chosen (4.3.2)."""

START = (0.1, 0.1, 0.1, 0.0, 0.0, 0.0)
"""Pose [m, rad] from which the base is released (4.3.2)."""

FASTER = (-1.0, -6.0)
"""Real parts [1/s] of the pairs that 4.3.2 places at -2 to -5."""


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


def _arm_on_base(context: Context, gains: JointGains) -> FlexibleBaseArm:
    """The arm on the bent beam: as printed with rotors inside the links, or corrected (E-28)."""
    printed = context.models is Models.THESIS
    chain = puma_chain(context.plant, printed)
    base = EmulatedSystem.load("beam_bent_printed" if printed else "beam_bent_corrected")
    return FlexibleBaseArm.about(chain, base, np.radians(POSE), gains)


def _both(context: Context) -> tuple[FlexibleBaseArm, FlexibleBaseArm]:
    return _arm_on_base(context, PPED_GAINS), _arm_on_base(context, HIGH_GAINS)


def _paths(context: Context, claim: Claim) -> Evaluation:
    procedure = load_procedure(PATHS)
    if not isinstance(procedure, CouplingMapPaths):
        raise UnknownNameError("procedure", PATHS, ())
    runs = procedure.runs(context.plant)
    good, bad = (float(np.max(runs[name].energy)) for name in ("good", "bad"))
    return Evaluation(
        (good / bad,),
        note=f"peaks of {good:.2f} and {bad:.2f} J in zero gravity; the thesis's paths are lost",
        runs=(f"ves-twin run {PATHS}",),
    )


def _pose(context: Context, claim: Claim) -> Evaluation:
    return Evaluation(POSE, note="the rows below are computed there")


def _gains(gains: JointGains, what: str) -> Answer:
    def read(context: Context, claim: Claim) -> Evaluation:
        values = tuple(float(value) for value in getattr(gains, what))
        return Evaluation(values, note="as the planning room has them")

    return read


def _estimator(context: Context, claim: Claim) -> Evaluation:
    soft, stiff = (damping_estimator(arm.poles()) for arm in _both(context))
    return Evaluation((soft / stiff,), note=f"{soft:.2f} against {stiff:.2f}")


def _dominant(context: Context, claim: Claim) -> Evaluation:
    soft, stiff = (arm.poles() for arm in _both(context))
    moves = [float(np.min(np.abs(soft - pole))) for pole in stiff[:6]]
    words = ", ".join(f"{p.real:.3f} +- {p.imag:.3f}j" for p in stiff[:6] if p.imag > 0)
    return Evaluation((max(moves),), note=f"six, not four, stay: {words}")


def _towards_real(context: Context, claim: Claim) -> Evaluation:
    ratios = []
    for arm in _both(context):
        poles = arm.poles()
        chosen = poles[(poles.real < FASTER[0]) & (poles.real > FASTER[1]) & (poles.imag > 0)]
        ratios.append(np.sort(-chosen.imag / chosen.real))
    soft, stiff = ratios
    words = " to ".join(", ".join(f"{r:.2f}" for r in ratio) for ratio in (stiff, soft))
    note = f"pairs at -1 to -6: imaginary over real {words}; smallest before over largest after"
    if not (len(stiff) and len(soft)):
        return Evaluation(holds=False, note=note)
    return Evaluation((float(stiff[0] / soft[-1]),), note=note)


def _start(context: Context, claim: Claim) -> Evaluation:
    return Evaluation(START, note="the row below is computed from there")


def _energy(context: Context, claim: Claim) -> Evaluation:
    soft, stiff = (strain_energy_integral(arm, np.array(START), 60.0) for arm in _both(context))
    return Evaluation((soft / stiff,), note=f"{soft:.2f} against {stiff:.2f} J s")


CHAPTER_4: Mapping[str, Answer] = {
    "C057": _paths,
    "C058": NotBuilt("the good path on the rig without gravity compensation (4.2)"),
    "C059": NotBuilt("the slope of the coupling lines on the faces of joint 1 (4.2)"),
    "C060": _base_mass,
    "C061": _order,
    "C062": _pose,
    "C063": _gains(PPED_GAINS, "stiffness"),
    "C064": _gains(PPED_GAINS, "damping"),
    "C065": _gains(HIGH_GAINS, "stiffness"),
    "C066": _gains(HIGH_GAINS, "damping"),
    "C067": _estimator,
    "C068": _dominant,
    "C069": _towards_real,
    "C070": _start,
    "C071": _energy,
}
"""Claim -> answer."""
