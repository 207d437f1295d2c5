"""beam_matrices: the `[beam]` table of an emulated-system file, made into M, B and K."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.units import to_si
from ves_twin.mechanics.beams.beam import DAMPING_RATIO, BeamMatrices, BentBeam, StraightBeam
from ves_twin.mechanics.beams.section import ALUMINIUM, Material, Tube

FORMS = ("corrected", "reduced", "thesis")
_LENGTHS = {"straight": {"length"}, "bent": {"l1", "l2"}}
_KEYS = {"shape", "form", "outer_diameter", "wall", "elasticity", "rigidity", "density"}
_OPTIONAL = {"elasticity", "rigidity", "density", "damping_ratio", "direction"}


def beam_matrices(table: object, where: str) -> BeamMatrices:
    """Matrices of a beam given by its shape; lengths may carry a unit, as in "90 mm".

    Keys: shape (straight | bent), form (corrected | reduced | thesis), length and direction or
    l1 and l2, outer_diameter, wall; elasticity, rigidity, density (aluminium of the thesis);
    damping_ratio (0.05, not for the form `thesis`).

    Raises:
        UnknownNameError: an unknown key, shape or form.
        InvalidInputError: a number missing or of the wrong kind.
    """
    if not isinstance(table, Mapping):
        raise InvalidInputError(f"{where}: beam", table, "a table with shape, form and lengths")
    shape = _choice(table, "shape", _LENGTHS, where)
    form = _choice(table, "form", FORMS, where)
    known = _KEYS | _LENGTHS[shape]
    known |= {"direction"} if shape == "straight" else set()
    known |= {"damping_ratio"} if form != "thesis" else set()
    for key in table:
        if key not in known:
            raise UnknownNameError(f"key of beam in {where}", str(key), known)
    for key in sorted(known - _OPTIONAL):
        if key not in table:
            raise InvalidInputError(f"{where}: beam.{key}", None, "a value; it has no default")
    beam = _build(table, shape, where)
    ratio = 0.0
    if form != "thesis":
        ratio = _number(table, "damping_ratio", "1", where, DAMPING_RATIO)
    if ratio < 0:
        raise InvalidInputError(f"{where}: beam.damping_ratio", ratio, "at least 0")
    try:
        if form == "thesis":
            return beam.thesis()
        return beam.corrected(ratio) if form == "corrected" else beam.reduced(ratio)
    except (OverflowError, ZeroDivisionError, np.linalg.LinAlgError):
        expected = "sizes from which finite matrices follow"
        raise InvalidInputError(f"{where}: beam", dict(table), expected) from None


def _build(table: Mapping[str, Any], shape: str, where: str) -> StraightBeam | BentBeam:
    def metres(key: str) -> float:
        return _number(table, key, "m", where)

    material = Material(
        _number(table, "elasticity", "Pa", where, ALUMINIUM.elasticity),
        _number(table, "rigidity", "Pa", where, ALUMINIUM.rigidity),
        _number(table, "density", "kg/m^3", where, ALUMINIUM.density),
    )
    tube = Tube(metres("outer_diameter"), metres("wall"), material)
    if shape == "bent":
        return BentBeam(metres("l1"), metres("l2"), tube)
    given = table.get("direction", (0.0, 0.0, 1.0))
    if not isinstance(given, list | tuple) or len(given) != 3:
        raise InvalidInputError(f"{where}: beam.direction", given, "3 numbers, root to platform")
    x, y, z = (to_si(value, "1", f"{where}: beam.direction") for value in given)
    return StraightBeam(metres("length"), tube, (x, y, z))


def _number(
    table: Mapping[str, Any], key: str, unit: str, where: str, default: float | None = None
) -> float:
    return to_si(table.get(key, default), unit, f"{where}: beam.{key}")


def _choice(table: Mapping[str, Any], key: str, known: Any, where: str) -> str:
    value = str(table.get(key))
    if value not in known:
        raise UnknownNameError(f"beam.{key} in {where}", value, known)
    return value
