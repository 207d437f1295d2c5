"""APPENDIX_A: matrices of the emulated beams, from their formulas."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ves_twin.core.resources import find_resource
from ves_twin.core.toml_file import read_toml
from ves_twin.core.types import FloatArray
from ves_twin.core.units import to_si
from ves_twin.mechanics.beams.beam import DAMPING_RATIO, BeamMatrices, BentBeam, StraightBeam
from ves_twin.mechanics.beams.section import ALUMINIUM, Tube
from ves_twin.thesis.claim import Claim
from ves_twin.thesis.context import Context, Models
from ves_twin.thesis.evaluation import Answer, Evaluation


def _lengths(model: str, keys: tuple[str, ...]) -> tuple[float, ...]:
    """Lengths [m] of the `[beam]` table of an emulated model that is shipped."""
    path = find_resource("emulated model", "models/emulated", model)
    table = read_toml("emulated model", path)[0]["beam"]
    return tuple(to_si(table[key], "m", f"{path.name}: beam.{key}") for key in keys)


def _straight_lengths() -> tuple[float, ...]:
    return _lengths("beam_horizontal_reduced", ("length", "outer_diameter", "wall"))


def _bent_lengths() -> tuple[float, ...]:
    return _lengths("beam_bent_corrected", ("l1", "l2", "outer_diameter", "wall"))


def _matrices(beam: StraightBeam | BentBeam, context: Context) -> BeamMatrices:
    return beam.thesis() if context.models is Models.THESIS else beam.corrected()


def _straight(context: Context) -> BeamMatrices:
    """The vertical beam."""
    length, outer, wall = _straight_lengths()
    return _matrices(StraightBeam(length, Tube(outer, wall)), context)


def _bent(context: Context) -> BeamMatrices:
    l1, l2, outer, wall = _bent_lengths()
    return _matrices(BentBeam(l1, l2, Tube(outer, wall)), context)


def _material(context: Context, claim: Claim) -> Evaluation:
    a = ALUMINIUM
    return Evaluation((a.elasticity, a.rigidity, a.density), note="material of the beams")


def _straight_shape(context: Context, claim: Claim) -> Evaluation:
    return Evaluation(_straight_lengths(), note="model file beam_horizontal_reduced")


def _bent_shape(context: Context, claim: Claim) -> Evaluation:
    note = "model file beam_bent_corrected; only as a diameter do the masses come out (E-16)"
    return Evaluation(_bent_lengths(), note=note)


def _ratio(context: Context, claim: Claim) -> Evaluation:
    return Evaluation((DAMPING_RATIO,), note="of every beam")


def _stiffness(context: Context, claim: Claim) -> Evaluation:
    k = _straight(context).stiffness
    values = (float(k[0, 0]), float(k[2, 2]), float(k[5, 5]))
    return Evaluation(values, note="inverse of the compliance, vertical beam")


def _coupling(context: Context, claim: Claim) -> Evaluation:
    k = _straight(context).stiffness
    return Evaluation((abs(float(k[0, 4])), float(k[3, 3])), note="inverse of the compliance")


def _end_mass(context: Context, claim: Claim) -> Evaluation:
    m = np.sort(np.diag(_straight(context).mass))
    note = f"half the beam's mass, and that times L^2; torsion {m[0]:g} kg m^2 has no formula"
    return Evaluation((float(m[1]), float(m[-1])), note=note)


def _rows(
    what: str, pick: Callable[[BeamMatrices], FloatArray], notes: Mapping[Models, str]
) -> Answer:
    def compute(context: Context, claim: Claim) -> Evaluation:
        values = tuple(float(value) for value in np.ravel(pick(_bent(context))))
        worst = int(np.argmax(np.abs(np.array(values) - claim.expected)))
        row, column = divmod(worst, 6)
        where = f"; largest deviation at {what}{row + 1}{column + 1}"
        return Evaluation(values, note=f"{notes[context.models]}{where}")

    return compute


STIFFNESS = {
    Models.THESIS: "inverse of the compliance with the wrong Q55 (E-15)",
    Models.CORRECTED: "inverse of the compliance with Q55 put right (E-15)",
}
DAMPING = {
    Models.THESIS: "matrix root of K M with the whole mass (E-18)",
    Models.CORRECTED: "symmetric, 5 % in every mode (E-18)",
}
MASS = {
    Models.THESIS: "half the mass, times L2^2, L1^2 and their sum: two interchanged (E-17)",
    Models.CORRECTED: "half the mass, times L2^2, the sum of squares, L1^2 (E-17)",
}


def _bent_mass(context: Context, claim: Claim) -> Evaluation:
    m = np.diag(_bent(context).mass)
    return Evaluation(tuple(map(float, (m[0], *m[3:]))), note=MASS[context.models])


APPENDIX_A: Mapping[str, Answer] = {
    "C097": _material,
    "C098": _straight_shape,
    "C099": _bent_shape,
    "C100": _ratio,
    "C101": _stiffness,
    "C102": _coupling,
    "C103": _end_mass,
    "C104": _rows("K", lambda m: m.stiffness, STIFFNESS),
    "C105": _rows("B", lambda m: m.damping, DAMPING),
    "C106": _bent_mass,
}
"""Claim -> answer."""
