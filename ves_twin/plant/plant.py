"""Plant: the frozen description of the rig that everything else is built from."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.resources import beside, find_resource, resource_folder
from ves_twin.effects.effect import Effect
from ves_twin.effects.law import Law
from ves_twin.effects.law_table import LawTable, put_over
from ves_twin.effects.registry import parse_effects
from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.kinematics.puma560 import Puma560
from ves_twin.mechanics.kinematics.stewart import StewartGeometry
from ves_twin.plant.fidelity import Fidelity, check_room
from ves_twin.plant.hydraulics import Hydraulics
from ves_twin.plant.parameters import (
    HEAD_KEYS,
    ParameterTable,
    parse_parameters,
    read_plant_file,
)
from ves_twin.plant.rig_laws import parse_laws

NOMINAL = "ves2"
"""The plant that has every number."""

RIG_KIND = "rig"
"""`kind` of the file of another machine, which is no plant of VES II."""

_PLANT_ASKED = "a plant of VES II; compare, diagnose, trend and plan take an MJCF machine"

MJCF_FILES = ("frame.xml", "leg.xml", "platform.xml", "sensor.xml", "puma560.xml")
"""The parts of the rig, each a file that opens on its own in any MuJoCo viewer."""


@dataclass(frozen=True)
class Plant:
    """A rig: MJCF parts and the numbers that go into them and into the compiled loop.

    Attributes:
        name: name of the plant, for instance "ves2".
        parameters: every number with unit, sd, grade and source.
        fidelity: how much is modelled.
        hydraulics: how the cylinders are modelled.
        effects: what deviates from the description; none is at zero.
        told_laws: physics beyond both, as functions at a place; those that are causes do not act.
    """

    name: str
    parameters: ParameterTable
    fidelity: Fidelity = Fidelity.FULL
    hydraulics: Hydraulics = Hydraulics.LINEAR
    effects: tuple[Effect, ...] = ()
    told_laws: tuple[LawTable, ...] = ()

    @staticmethod
    def load(name_or_path: str) -> Plant:
        """A plant by name ("ves2") or from a file.

        A file is either complete, or it names a `base` plant and lists under `[parameters]`
        what differs: `"leg.rod_mass" = 2.7`. Effects stand under `[effects]`, laws under
        `[[laws]]`. A `base` given by its path is looked for beside the file first.

        Raises:
            FileAccessError: missing or unreadable file.
            UnknownNameError: no such plant or parameter.
            InvalidInputError: a value of the wrong kind, shape, unit or range.
            VersionError: a file of another version of the format.
        """
        path = find_resource("plant", "models", name_or_path)
        if path.parent == resource_folder("models"):
            return _shipped(path, path.stat().st_mtime_ns)
        return Plant.read(path)

    @staticmethod
    def read(path: Path) -> Plant:
        """A plant from a file; raises as `load`."""
        content = read_plant_file(path)
        if content.get("kind") == RIG_KIND:
            raise InvalidInputError(f"{path}: kind", RIG_KIND, _PLANT_ASKED)
        changes = content.get("parameters", {})
        if not isinstance(changes, Mapping):
            raise InvalidInputError(f"{path}: parameters", changes, "a table of changed values")
        for key in content:
            if "base" in content and key not in HEAD_KEYS:
                raise UnknownNameError("key", key, HEAD_KEYS)
        name = str(content.get("name", path.stem))
        if "base" in content:
            plant = replace(_load_base(content["base"], path), name=name)
        else:
            plant = Plant(name, _complete(parse_parameters(content, path), path))
        form = str(content.get("hydraulic_model", plant.hydraulics))
        if form not in set(Hydraulics):
            raise UnknownNameError("hydraulic_model", form, set(Hydraulics))
        effects = content.get("effects", {})
        if not isinstance(effects, Mapping):
            raise InvalidInputError(f"{path}: effects", effects, "a table of effects")
        plant = replace(plant, hydraulics=Hydraulics(form)).with_values(changes)
        plant = plant.with_fidelity(str(content.get("fidelity", plant.fidelity)))
        plant = plant.with_laws(*parse_laws(content.get("laws", []), path))
        return plant.extended(*parse_effects(effects))

    def with_values(self, values: Mapping[str, object]) -> Plant:
        """The same plant with other parameter values.

        Args:
            values: dotted names to values; nested tables are allowed.
        """
        if not values:
            return self
        plant = replace(self, parameters=self.parameters.with_values(flat(values)))
        return plant.with_fidelity(self.fidelity)

    def with_fidelity(self, fidelity: str) -> Plant:
        """The same rig modelled in more or less detail.

        Args:
            fidelity: "full" or "fast".

        Raises:
            UnknownNameError: no such fidelity.
            InvalidInputError: a number differs from nominal, by value or by an effect, that this
                fidelity has no room for.
        """
        if fidelity not in set(Fidelity):
            raise UnknownNameError("fidelity", fidelity, set(Fidelity))
        chosen = Fidelity(fidelity)
        if chosen is not Fidelity.FULL:
            nominal = Plant.load(NOMINAL).parameters
            kinds = (effect.kind for effect in self.effects)
            check_room(chosen, [*self.actual.differences(nominal), *kinds])
        return replace(self, fidelity=chosen)

    def extended(self, *effects: Effect) -> Plant:
        """The same plant with more effects; one of the same kind and target is replaced.

        An effect of zero size is left out, so that it is no effect to the last bit.
        """
        for effect in effects:
            effect.check()
        merged = {(e.kind, e.target): e for e in (*self.effects, *effects)}
        kept = tuple(merged[key] for key in sorted(merged) if not merged[key].neutral)
        return replace(self, effects=kept).with_fidelity(self.fidelity)

    def with_laws(self, *laws: LawTable) -> Plant:
        """The same plant with more laws; one of the same place and variables is replaced."""
        return replace(self, told_laws=put_over(self.told_laws, laws)) if laws else self

    @property
    def laws(self) -> tuple[Law, ...]:
        """Those that are at work."""
        return tuple(told.law for told in self.told_laws if not told.cause)

    @property
    def actual(self) -> ParameterTable:
        """The parameters as the effects leave them: what the rig is built from."""
        if not self.effects:
            return self.parameters
        numbers = {name: self.parameters.array(name) for name in self.parameters}
        for effect in self.effects:
            effect.edit_numbers(numbers)
        changed = {
            name: value
            for name, value in numbers.items()
            if not np.array_equal(value, self.parameters[name].value)
        }
        return self.parameters.with_values(changed)

    @property
    def geometry(self) -> StewartGeometry:
        """Joint positions of the platform."""
        number = self.parameters.number
        return StewartGeometry.symmetric(
            base_radius=number("platform.base_radius"),
            top_radius=number("platform.top_radius"),
            base_half_angle=number("platform.base_half_angle"),
            top_half_angle=number("platform.top_half_angle"),
            joint_height=number("platform.joint_height"),
            top_offset=number("platform.top_offset"),
        )

    @property
    def arm(self) -> Puma560:
        """Kinematics of the arm."""
        return Puma560(**{k: self.parameters.number(f"arm.{k}") for k in _ARM_LENGTHS})

    @property
    def gravity_model(self) -> GravityModel:
        """M_total and P of the arm's own masses."""
        array = self.parameters.array
        return GravityModel.of(
            self.arm.chain,
            array("arm.mass"),
            array("arm.com"),
            self.parameters.number("gravity"),
        )

    @property
    def sensor_identity(self) -> str:
        """What stands for the serial number of the force sensor: a hash of gains and ranges."""
        names = ("sensor.crosstalk", "sensor.range", "sensor.resolution")
        digest = hashlib.sha256(b"".join(self.parameters.array(name).tobytes() for name in names))
        return digest.hexdigest()[:12]

    @property
    def base(self) -> str:
        """The shipped plant of the same hydraulics and fidelity, from which `changes` count."""
        form = "" if self.hydraulics is Hydraulics.LINEAR else "_pressure"
        return NOMINAL + form + ("" if self.fidelity is Fidelity.FULL else "_fast")

    def changes(self) -> dict[str, object]:
        """Values that differ from `base`: dotted name -> plain value."""
        base = Plant.load(self.base).parameters
        return {
            name: here.tolist() for name, (here, _) in self.parameters.differences(base).items()
        }

    @property
    def hash(self) -> str:
        """Short hash over every number and MJCF part: equal hash, equal physics."""
        digest = hashlib.sha256(f"{self.fidelity} {self.hydraulics}".encode())
        for name in sorted(self.parameters):
            digest.update(name.encode() + self.parameters.array(name).tobytes())
        for effect in self.effects:
            digest.update(repr(effect).encode())
        for law in self.laws:
            digest.update(repr(law).encode())
        for file in MJCF_FILES:
            digest.update((resource_folder("models") / file).read_bytes())
        return digest.hexdigest()[:16]


@lru_cache(maxsize=32)
def _shipped(path: Path, modified: int) -> Plant:
    """A shipped plant, read once: a diagnosis asks for it with every one of a thousand runs."""
    return Plant.read(path)


def _complete(table: ParameterTable, path: Path) -> ParameterTable:
    """The table, if it has the numbers of the nominal plant in their units and shapes."""
    nominal = find_resource("plant", "models", NOMINAL)
    if path != nominal:
        needed = parse_parameters(read_plant_file(nominal), nominal)
        missing = [name for name in needed if name not in table]
        if missing:
            what = f"{path}: {missing[0]} and {len(missing) - 1} more numbers"
            raise InvalidInputError(what, None, f'a value, or base = "{NOMINAL}" to start from')
        for name, parameter in table.items():
            expected = needed[name]
            if (parameter.unit, parameter.value.shape) != (expected.unit, expected.value.shape):
                came = f"{parameter.value.shape} {parameter.unit}"
                shape = f"{expected.value.shape} {expected.unit}"
                raise InvalidInputError(f"{path}: {name}", came, shape)
    return table


def _load_base(name: object, path: Path) -> Plant:
    if not isinstance(name, str):
        raise InvalidInputError(f"{path}: base", name, "the name or the path of a plant")
    try:
        return Plant.load(beside(path, name))
    except RecursionError:
        raise InvalidInputError(
            f"{path}: base", name, "a plant that does not lead back here"
        ) from None


_ARM_LENGTHS = ("d0", "d1", "d2", "d3", "a2", "a3")


def flat(values: Mapping[str, object], prefix: str = "") -> dict[str, object]:
    """Nested tables as dotted names."""
    result: dict[str, object] = {}
    for key, value in values.items():
        if isinstance(value, Mapping):
            result.update(flat(value, f"{prefix}{key}."))
        else:
            result[f"{prefix}{key}"] = value
    return result


def mjcf_part(file: str) -> Path:
    """Path of one MJCF part."""
    return resource_folder("models") / file
