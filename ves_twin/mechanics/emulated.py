"""EmulatedSystem: the base that the platform pretends to be, M Y'' + B Y' + K Y = W."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.resources import find_resource
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated_beam import beam_matrices

SCHEMA = 1
MATRICES = ("mass", "damping", "stiffness")
_KEYS = {"schema", "name", "coupling", "source", "units", "nonsymmetric", "beam", *MATRICES}

SYMMETRY = 1e-9
"""Largest difference across the diagonal over the size of the two entries: round-off of a file."""


class Coupling(StrEnum):
    """How full the matrices are; a fuller model takes longer to compute (thesis 2.4.2)."""

    DECOUPLED = "decoupled"
    BEAM = "beam"
    COUPLED = "coupled"


@dataclass(frozen=True)
class EmulatedSystem(ReadOnly):
    """A linear base with six coordinates Y = (X, Y, Z, phiX, phiY, phiZ).

    Attributes:
        name: name of the model.
        coupling: how full the matrices are.
        mass: M (6, 6), symmetric, positive definite [kg, kg m, kg m^2].
        damping: B (6, 6) [N s/m, N s, N m s].
        stiffness: K (6, 6) [N/m, N, N m].
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

        A file gives `mass`, `damping` and `stiffness` in SI (6 numbers of a diagonal or 6 rows),
        or a `[beam]` table from which they follow. M must be symmetric and positive definite; B
        and K symmetric and positive semi-definite (a free base has no spring). A file that means
        a matrix to be otherwise, such as the printed B of thesis A.5, says
        `nonsymmetric = ["damping"]`.

        Raises:
            FileAccessError: missing or unreadable.
            UnknownNameError: no such model or key.
            InvalidInputError: matrices of another shape, not finite, or not as said above.
            VersionError: another version of the format.
        """
        path = find_resource("emulated model", "models/emulated", name_or_path)
        content, _ = read_toml("emulated model", path)
        return _parse(content, path)

    @property
    def identity(self) -> str:
        """A hash of M, B and K: equal identity, equal system."""
        parts = (self.mass, self.damping, self.stiffness)
        return hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest()[:12]

    def with_mass(self, mass: float) -> EmulatedSystem:
        """The same base with another translational mass [kg], the same along X, Y and Z.

        Rotational inertia, coupling of mass, damping and stiffness stay as they are.

        Raises:
            InvalidInputError: a mass with which M is not positive definite.
        """
        matrix = self.mass.copy()
        matrix[range(3), range(3)] = mass
        if np.min(np.linalg.eigvalsh(matrix)) <= 0.0:
            raise InvalidInputError(f"mass of {self.name}", mass, "a positive definite matrix M")
        return replace(self, name=f"{self.name}, {mass:g} kg", mass=matrix)

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
    mass, damping, stiffness = _matrices(content, path.name)
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


def _matrices(content: dict[str, object], where: str) -> list[FloatArray]:
    units = content.get("units", "SI")
    if units != "SI":
        expected = "'SI': kg, N s/m and N/m, with rad for angles"
        raise InvalidInputError(f"{where}: units", units, expected)
    if "beam" in content:
        given = [key for key in (*MATRICES, "nonsymmetric") if key in content]
        if given:
            expected = "nothing beside [beam], from which it follows"
            raise InvalidInputError(f"{where}: {given[0]}", content[given[0]], expected)
        beam = beam_matrices(content["beam"], where)
        return [beam.mass, beam.damping, beam.stiffness]
    exempt = content.get("nonsymmetric", [])
    if not isinstance(exempt, list) or not set(map(str, exempt)) <= {"damping", "stiffness"}:
        expected = "a list out of 'damping' and 'stiffness'"
        raise InvalidInputError(f"{where}: nonsymmetric", exempt, expected)
    found = [_matrix(content.get(key), f"{where}: {key}") for key in MATRICES]
    for key, matrix in zip(MATRICES, found, strict=True):
        if key not in exempt:
            _check_energy(key, matrix, where)
        elif np.array_equal(matrix, matrix.T):
            expected = f"no exception for a symmetric {key}"
            raise InvalidInputError(f"{where}: nonsymmetric", exempt, expected)
    return found


def _check_energy(key: str, matrix: FloatArray, where: str) -> None:
    """Refuse a matrix whose energy x' A x is not one: skew parts, or negative values."""
    root = np.sqrt(np.abs(np.diag(matrix)))  # before the product, which may be beyond doubles
    pair = np.outer(root, root)
    size = np.maximum(pair, np.maximum(np.abs(matrix), np.abs(matrix.T)))
    skew = np.abs(matrix - matrix.T) > SYMMETRY * size
    if np.any(skew):
        i, j = (int(k) for k in np.argwhere(skew)[0])
        came = f"{matrix[i, j]:g} in row {i + 1}, column {j + 1} and {matrix[j, i]:g} across"
        declare = "" if key == "mass" else f', or nonsymmetric = ["{key}"] where that is meant'
        raise InvalidInputError(f"{where}: {key}", came, f"a symmetric matrix{declare}")
    scale = np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), 1.0))
    smallest = float(np.min(np.linalg.eigvalsh(matrix / np.outer(scale, scale))))
    definite = "positive definite" if key == "mass" else "positive semi-definite"
    if smallest < -SYMMETRY or (key == "mass" and smallest <= SYMMETRY):
        came = f"an eigenvalue of {smallest:.3g} of the matrix scaled to ones on its diagonal"
        raise InvalidInputError(f"{where}: {key}", came, f"a symmetric, {definite} matrix")


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
