"""GravityCalibration: calibration matrix, zero, M_total and P as a file that names its sensor."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.resources import find_resource
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import write_whole
from ves_twin.mechanics.gravity.first_moments import FirstMoments
from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.gravity.identify import Identification

SCHEMA = 1
_KEYS = {"schema", "name", "source", "sensor", "arm", "model"}


@dataclass(frozen=True)
class GravityCalibration(ReadOnly):
    """What the computers load before an experiment (thesis Appendix E, step 8).

    Attributes:
        sensor: identity of the force sensor it was made with.
        arm: identity of the chain it was made for.
        matrix: C (6, 6), wrench in SI per signal.
        zero: signal under no load (6,).
        total_mass: M_total [kg].
        moments: P [kg m] (p,).
        gravity: acceleration of gravity [m/s^2].
        names: what each parameter of P is led by (p,).
        half_width: half the 90 % intervals of M_total and P (1 + p,); infinite if hidden.
        source: where it comes from.
    """

    sensor: str
    arm: str
    matrix: FloatArray
    zero: FloatArray
    total_mass: float
    moments: FloatArray
    gravity: float
    names: tuple[str, ...]
    half_width: FloatArray
    source: str

    @staticmethod
    def of(identification: Identification, sensor: str, source: str) -> GravityCalibration:
        """The file's content of an identification."""
        model = identification.model
        return GravityCalibration(
            sensor=sensor,
            arm=model.basis.chain.identity,
            matrix=identification.calibration,
            zero=identification.zero,
            total_mass=model.total_mass,
            moments=model.moments,
            gravity=model.gravity,
            names=model.basis.names,
            half_width=identification.half_width()[42:],
            source=source,
        )

    @staticmethod
    def load(name_or_path: str) -> GravityCalibration:
        """A calibration from models/gravity/, or from a file.

        Raises:
            FileAccessError: missing or unreadable.
            UnknownNameError: no such calibration or key.
            InvalidInputError: numbers missing, of another shape or not finite; singular matrix.
            VersionError: another version of the format.
        """
        path = find_resource("gravity calibration", "models/gravity", name_or_path)
        content, _ = read_toml("gravity calibration", path)
        check_schema(content, path, SCHEMA)
        for key in content:
            if key not in _KEYS:
                raise UnknownNameError(f"key in {path.name}", key, _KEYS)
        sensor, arm, model = (_table(content, key, path) for key in ("sensor", "arm", "model"))
        names = tuple(str(name) for name in _list(model.get("names"), f"{path.name}: model.names"))
        matrix = _array(sensor, "matrix", (6, 6), path)
        if not np.linalg.cond(matrix) < 1e6:
            raise InvalidInputError(f"{path.name}: sensor.matrix", "singular", "an invertible one")
        return GravityCalibration(
            sensor=str(sensor.get("identity")),
            arm=str(arm.get("identity")),
            matrix=matrix,
            zero=_array(sensor, "zero", (6,), path),
            total_mass=float(_array(model, "total_mass", (), path)),
            moments=_array(model, "moments", (len(names),), path),
            gravity=float(_array(model, "gravity", (), path)),
            names=names,
            half_width=_array(model, "half_width", (1 + len(names),), path, finite=False),
            source=str(content.get("source", "")),
        )

    def save(self, path: Path) -> None:
        """Write the file; what was there is replaced only when the new one is whole."""
        matrix = "\n".join(f"    {_row(row)}," for row in self.matrix)
        names = ", ".join(json.dumps(name) for name in self.names)
        text = f"""# Sensor matrix C and zero, M_total and P; loaded by gravity.method = "model".
schema = {SCHEMA}
name = {json.dumps(path.stem)}
source = {json.dumps(self.source)}

[sensor]             # C turns signals into wrenches [N, N m]; zero is the signal under no load
identity = "{self.sensor}"
matrix = [
{matrix}
]
zero = {_row(self.zero)}

[arm]
identity = "{self.arm}"

[model]              # kg and kg m; half_width: half the 90 % intervals of total_mass and moments
gravity = {self.gravity!r}
total_mass = {self.total_mass!r}
names = [{names}]
moments = {_row(self.moments)}
half_width = {_row(self.half_width)}
"""
        write_whole(path, text)

    def check(self, sensor: str, basis: FirstMoments) -> None:
        """Raise InvalidInputError if it belongs to another sensor or arm."""
        if self.sensor != sensor:
            raise InvalidInputError(
                "gravity.file", f"a calibration of sensor {self.sensor}", f"one of sensor {sensor}"
            )
        if self.arm != basis.chain.identity or self.names != basis.names:
            came = f"a calibration of arm {self.arm} with {len(self.names)} moments"
            expected = f"one of arm {basis.chain.identity} with {len(basis.names)}"
            raise InvalidInputError("gravity.file", came, expected)

    def model(self, basis: FirstMoments) -> GravityModel:
        """M_total and P on the basis of the arm it was checked against."""
        return GravityModel(basis, self.total_mass, self.moments, self.gravity)


def _row(values: FloatArray) -> str:
    return f"[{', '.join(repr(float(v)) for v in values)}]"


def _table(content: Mapping[str, object], key: str, path: Path) -> Mapping[str, object]:
    table = content.get(key)
    if not isinstance(table, Mapping):
        raise InvalidInputError(f"{path.name}: {key}", table, "a table")
    return table


def _list(value: object, what: str) -> list[object]:
    if not isinstance(value, list):
        raise InvalidInputError(what, value, "a list")
    return value


def _array(
    table: Mapping[str, object], key: str, shape: tuple[int, ...], path: Path, finite: bool = True
) -> FloatArray:
    what = f"{path.name}: {key}"
    try:
        array = np.array(table.get(key), dtype=float)
    except (TypeError, ValueError):
        raise InvalidInputError(what, table.get(key), f"numbers of shape {shape}") from None
    if array.shape != shape or np.any(np.isnan(array)) or (finite and np.any(np.isinf(array))):
        raise InvalidInputError(what, table.get(key), f"finite numbers of shape {shape}")
    return array
