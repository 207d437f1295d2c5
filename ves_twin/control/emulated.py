"""EmulatedSystem: the base that the platform pretends to be, M Y'' + B Y' + K Y = W."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from ves_twin.errors import InvalidInputError, UnknownNameError
from ves_twin.resources import find_resource
from ves_twin.toml_file import check_schema, read_toml
from ves_twin.types import FloatArray

SCHEMA = 1
_KEYS = {"schema", "name", "coupling", "source", "mass", "damping", "stiffness"}


class Coupling(StrEnum):
    """How full the matrices are; a fuller model takes longer to compute (thesis 2.4.2)."""

    DECOUPLED = "decoupled"
    BEAM = "beam"
    COUPLED = "coupled"


@dataclass(frozen=True)
class EmulatedSystem:
    """A linear base with six coordinates Y = (X, Y, Z, phiX, phiY, phiZ).

    Attributes:
        name: name of the model.
        coupling: how full the matrices are.
        mass: M (6, 6), symmetric, positive definite [kg, kg m, kg m^2].
        damping: B (6, 6), any [N s/m ...].
        stiffness: K (6, 6), any [N/m ...].
        source: where the numbers come from.
    """

    name: str
    coupling: Coupling
    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    source: str

    @staticmethod
    def load(name_or_path: str) -> EmulatedSystem:
        """A model from models/emulated/, or from a file.

        Raises:
            FileAccessError: missing or unreadable.
            UnknownNameError: no such model or key.
            InvalidInputError: matrices of another shape, not finite, M not positive definite.
            VersionError: another version of the format.
        """
        path = find_resource("emulated model", "models/emulated", name_or_path)
        content, _ = read_toml("emulated model", path)
        return _parse(content, path)

    def discretise(self, period: float) -> tuple[FloatArray, FloatArray]:
        """Exact zero-order-hold form X(k+1) = Phi X(k) + Gamma W(k), X = (Y, Y').

        Args:
            period: time between two cycles [s].

        Returns:
            Phi (12, 12) and Gamma (12, 6).

        Raises:
            InvalidInputError: the system runs away within one period.

        Source: thesis eqs 2.4 to 2.6, errata E-2.
        """
        from scipy.linalg import expm  # slow to import

        inverse = np.linalg.inv(self.mass)
        block = np.zeros((18, 18))
        block[:6, 6:12] = np.eye(6)
        block[6:12, :6] = -inverse @ self.stiffness
        block[6:12, 6:12] = -inverse @ self.damping
        block[6:12, 12:] = inverse
        with np.errstate(all="ignore"):
            exponential = expm(block * period)
        if not np.all(np.isfinite(exponential)):
            raise InvalidInputError(
                f"emulated system {self.name}", "matrices", "a system whose step response is finite"
            )
        phi = np.ascontiguousarray(exponential[:12, :12])
        return phi, np.ascontiguousarray(exponential[:12, 12:])


def _parse(content: dict[str, object], path: Path) -> EmulatedSystem:
    for key in content:
        if key not in _KEYS:
            raise UnknownNameError(f"key in {path.name}", key, _KEYS)
    check_schema(content, path, SCHEMA)
    coupling = str(content.get("coupling"))
    if coupling not in set(Coupling):
        raise UnknownNameError("coupling", coupling, set(Coupling))
    mass, damping, stiffness = (
        _matrix(content.get(key), f"{path.name}: {key}") for key in ("mass", "damping", "stiffness")
    )
    if not np.allclose(mass, mass.T) or np.min(np.linalg.eigvalsh(mass)) <= 0:
        raise InvalidInputError(
            f"{path.name}: mass", content["mass"], "a symmetric, positive definite matrix"
        )
    diagonal = all(np.array_equal(m, np.diag(np.diag(m))) for m in (mass, damping, stiffness))
    if coupling == Coupling.DECOUPLED and not diagonal:
        raise InvalidInputError(
            f"{path.name}: coupling", coupling, "'beam' or 'coupled', for full matrices"
        )
    return EmulatedSystem(
        name=str(content.get("name", path.stem)),
        coupling=Coupling(coupling),
        mass=mass,
        damping=damping,
        stiffness=stiffness,
        source=str(content.get("source", "")),
    )


def _matrix(value: object, what: str) -> FloatArray:
    try:
        array = np.array(value)
    except ValueError:  # rows of different lengths
        raise InvalidInputError(what, value, "6 numbers or 6 rows of 6 numbers") from None
    if array.dtype.kind not in "iuf":
        raise InvalidInputError(what, value, "6 numbers or 6 rows of 6 numbers")
    array = array.astype(float)
    if array.shape == (6,):
        array = np.diag(array)
    if array.shape != (6, 6):
        raise InvalidInputError(what, f"shape {array.shape}", "6 numbers or 6 rows of 6 numbers")
    if not np.all(np.isfinite(array)):
        raise InvalidInputError(what, value, "finite numbers")
    return array
