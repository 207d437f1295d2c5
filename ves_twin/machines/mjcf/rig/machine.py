"""Rig: an MJCF model and its description, with everything that may differ in it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import mujoco

from ves_twin.core.engine_log import log_engine
from ves_twin.core.errors import FileAccessError, InvalidInputError, UnknownNameError, one_line
from ves_twin.core.units import to_si
from ves_twin.diagnosis.model.forward import Hypothesis, Parameter
from ves_twin.effects.bodies import MassCentre, Payload
from ves_twin.effects.effect import Effect
from ves_twin.effects.law import Law
from ves_twin.effects.law_table import CAUSE as LAW
from ves_twin.effects.law_table import FACTORS as LAW_FACTORS
from ves_twin.effects.law_table import LawTable
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.effects.registry import EFFECTS, attributes, build_anywhere, kind_anywhere
from ves_twin.machines.mjcf.parts.probe import Probe
from ves_twin.machines.mjcf.parts.stiff_friction import stiff_friction
from ves_twin.machines.mjcf.rig.check_description import check_description
from ves_twin.machines.mjcf.rig.description import Allowed, RigDescription, Setting
from ves_twin.machines.mjcf.rig.entry import Entry
from ves_twin.machines.mjcf.rig.load_description import load_description
from ves_twin.machines.mjcf.rig.places import anywhere, place_of
from ves_twin.machines.mjcf.rig.unfolded import unfolded


@dataclass(frozen=True)
class Rig:
    """Two files as a plant.

    Attributes:
        description: the TOML file.
        folder: that the model's path starts from.
        file: name or path it was loaded by.
        payloads: known point masses on it, each a body, a mass [kg] and a place in the body [m].
        probes: sensors beside those of the model file.
    """

    description: RigDescription
    folder: Path
    file: str = ""
    payloads: tuple[tuple[str, float, tuple[float, float, float]], ...] = ()
    probes: tuple[Probe, ...] = ()

    @staticmethod
    def load(name_or_path: str) -> Rig:
        """A shipped rig by name, or a TOML file beside its MJCF file.

        Raises:
            VesTwinError: a file that is missing or wrong, or names that do not fit together.
        """
        return Rig.of(*load_description(name_or_path), name_or_path)

    @staticmethod
    def of(description: RigDescription, folder: Path, file: str = "") -> Rig:
        """A description as it was read, with its shorthands written out; raises as `load`."""
        folded = Rig(description, folder, file)
        check_description(folded.description, folded.model)
        told = unfolded(folded.description, folded.model)
        rig = folded if told is folded.description else replace(folded, description=told)
        rig.check()
        return rig

    @cached_property
    def model(self) -> mujoco.MjModel:
        """The compiled model with the nominal values of the description.

        Raises:
            FileAccessError: no such model.
            InvalidInputError: not MJCF.
        """
        path = self.folder / self.description.model
        if not path.is_file():
            raise FileAccessError(f"model file '{path}' of rig {self.description.name} is missing")
        log_engine()
        try:
            edited = self.payloads or self.probes or self._shifted
            model = self._loaded(path) if edited else mujoco.MjModel.from_xml_path(str(path))
        except (ValueError, mujoco.FatalError) as error:
            raise InvalidInputError(str(path), one_line(error), "a MuJoCo model") from None
        stiff_friction(model)
        for setting in self.description.parameters:
            if setting.value is not None:
                effect, place = self._effect_of(setting, model)
                (magnitude,) = effect.magnitudes_at(place)
                change = {
                    magnitude.name: _value(setting, effect, magnitude) - effect.present(model)
                }
                effect.sized(change).edit_model(model)
        try:
            mujoco.mj_setConst(model, mujoco.MjData(model))
        except mujoco.FatalError as error:
            raise InvalidInputError(str(path), one_line(error), "a model that can move") from None
        return model

    @property
    def laws(self) -> tuple[Law, ...]:
        """Those of the description that are at work."""
        return tuple(told.law for told in self.description.laws if not told.cause)

    @property
    def promoted(self) -> tuple[LawTable, ...]:
        """Those of the description that are causes."""
        return tuple(told for told in self.description.laws if told.cause)

    @cached_property
    def entries(self) -> tuple[Entry, ...]:
        """Everything that may differ, causes and commissioning errors."""
        found: dict[tuple[str, str], Entry] = {}
        settings = {self._key(s): s for s in self.description.parameters}
        for allowed in self.description.effects:
            kind = kind_anywhere(allowed.kind).kind
            for target in allowed.on:
                found[kind, target] = self._entry(allowed, target, settings.get((kind, target)))
        for (kind, target), setting in settings.items():
            if (kind, target) not in found:
                only = Allowed(kind=kind, on=(target,), cause=False)
                found[kind, target] = self._entry(only, target, setting)
        for kind, targets in self._present.items():
            for target in targets:
                if (kind, target) not in found:
                    only = Allowed(kind=kind, on=(target,), cause=False)
                    found[kind, target] = self._entry(only, target, None)
        order = list(EFFECTS)
        return tuple(sorted(found.values(), key=lambda e: order.index(e.effect.kind)))

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Of all entries."""
        found = []
        settings = {self._key(s): s for s in self.description.parameters}
        for entry in self.entries:
            for m, nominal in zip(entry.magnitudes, entry.nominal, strict=True):
                allowed = Entry.told_of(m, entry.magnitudes[0], entry.allowed)
                told = settings.get(entry.key) or allowed
                low, high = entry.bounds(m, nominal, told)
                name = entry.name(m)
                one = entry.per_recording
                found.append(
                    Parameter(name, m.unit, nominal, low, high, m.sd, one, component=m.component)
                )
        most = LAW_FACTORS[1]
        return (*found, *(Parameter(law.name, "1", 0.0, -most, most) for law in self.promoted))

    @cached_property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """Causes that may be named."""
        found = []
        for entry in self.entries:
            if not entry.cause:
                continue
            first, nominal = entry.magnitudes[0], entry.nominal[0]
            one_sided = first.sign is Sign.POSITIVE and nominal == 0.0
            found.append(
                Hypothesis(
                    effect=entry.effect.kind,
                    target=entry.effect.target,
                    parameters=tuple(entry.name(m) for m in entry.magnitudes),
                    smallest=tuple(m.smallest for m in entry.magnitudes),
                    largest=tuple(m.largest for m in entry.magnitudes),
                    signs=(1,) if one_sided else (-1, 1),
                    source=entry.source,
                    linear=anywhere(entry.effect).linear and len(entry.magnitudes) == 1,
                    transient=anywhere(entry.effect).transient,
                    starts=entry.effect.starts(entry.place),
                )
            )
        least, most = LAW_FACTORS
        laws = (
            Hypothesis(
                LAW, law.law.label, (law.name,), (least,), (most,), source=law.source,
                transient="time" in law.of,
            )
            for law in self.promoted
        )  # fmt: skip
        return (*found, *laws)

    @cached_property
    def identity(self) -> str:
        """Hash of both files' content and of MuJoCo's version."""
        parts = (
            self.description.model_dump_json(),
            mujoco.__version__,
            *self.payloads,
            *self.probes,
        )
        digest = hashlib.sha256(repr(parts).encode())
        digest.update((self.folder / self.description.model).read_bytes())
        return digest.hexdigest()[:16]

    def effects_at(self, values: Mapping[str, float]) -> Iterator[tuple[Effect, Place]]:
        """Effects that are at work where parameters have values, in the order of `entries`.

        A library has hundreds, of which a prediction has few at work: the others are not made.
        """
        places, standing = self._idle
        moved = {
            place[0]
            for name, value in values.items()
            if (place := places.get(name)) is not None and value != place[1]
        }
        for number in sorted(moved | standing):
            entry = self.entries[number]
            effect = entry.at(values)
            if not effect.neutral:
                yield effect, entry.place

    @cached_property
    def _idle(self) -> tuple[Mapping[str, tuple[int, float]], frozenset[int]]:
        """Number of the entry of each parameter, with its value of no size; those of a size now."""
        places, standing = {}, set()
        for number, entry in enumerate(self.entries):
            native = bool(entry.effect.attribute)
            for magnitude, nominal in zip(entry.magnitudes, entry.nominal, strict=True):
                places[entry.name(magnitude)] = (number, nominal if native else 0.0)
            if not entry.at({}).neutral:
                standing.add(number)
        return places, frozenset(standing)

    def check(self) -> None:
        """Raise UnknownNameError or InvalidInputError where the two files do not fit together."""
        check_description(self.description, self.model)
        _ = self.hypotheses, self.parameters

    def _loaded(self, path: Path) -> mujoco.MjModel:
        """The model with its payloads, bodies without a joint and without extent, and probes.

        A body whose centre may move is none that MuJoCo may simplify by where it is.
        """
        spec = mujoco.MjSpec.from_file(str(path))
        for body in spec.bodies:
            if body.name in self._shifted:
                body.simple = 0
        for probe in self.probes:
            probe.add(spec)
        for name, mass, place in self.payloads:
            body = spec.body(name)
            if body is None or name == "world":
                known = {b.name for b in spec.bodies if b.name != "world"}
                raise UnknownNameError("body of the payload", name, known)
            point = body.add_body(pos=place, mass=mass, ipos=[0.0] * 3, inertia=[0.0] * 3)
            point.explicitinertial = True
        return spec.compile()

    @property
    def _shifted(self) -> set[str]:
        """Bodies whose centre of mass may move."""
        told = self.description
        centres = {s.body for s in told.parameters if s.attribute.startswith("centre_")}
        entries = [(a.kind, a.on) for a in told.effects]
        entries += [(kind, tuple(targets)) for kind, targets in told.present.items()]
        payloads = {name for kind, on in entries if kind == Payload.kind for name in on}
        axes = [name for kind, on in entries if kind == MassCentre.kind for name in on]
        return centres | payloads | {name.rpartition(".")[0] for name in axes}

    def _entry(self, allowed: Allowed, target: str, setting: Setting | None) -> Entry:
        effect = build_anywhere(allowed.kind, target, {})
        place = place_of(effect, self.description, self.model)
        told = self._present.get(effect.kind, {}).get(target, {})
        if told and effect.attribute:
            name, attribute = effect.setting
            expected = f'[[parameters]] with {effect.element} = "{name}", attribute = "{attribute}"'
            came = f"present.{effect.kind}.{target}"
            raise InvalidInputError(came, told, f"{expected} and value")
        build_anywhere(effect.kind, target, told)
        own = effect.present(self.model) if effect.attribute else 0.0
        plain, what = effect.magnitudes_at(place), f"{effect.kind}@{target}"
        told_of = (Entry.told_of(m, plain[0], allowed) for m in plain)
        magnitudes = tuple(
            Entry.sized(m, told, setting, what, own) for m, told in zip(plain, told_of, strict=True)
        )
        if effect.attribute:
            nominal: tuple[float, ...] = (own,)
        else:
            nominal = tuple(float(told.get(m.name, 0.0)) for m in magnitudes)
            for m, value in zip(magnitudes, nominal, strict=True):
                if value < effect.least(0.0):
                    what = f"present.{effect.kind}.{target}.{m.name}"
                    raise InvalidInputError(what, value, f"at least {effect.least(0.0):g}")
        source = allowed.source or (setting.source if setting else "") or anywhere(effect).source
        one = allowed.per_recording
        return Entry(effect, place, magnitudes, nominal, allowed.cause, one, source, allowed)

    def _effect_of(self, setting: Setting, model: mujoco.MjModel) -> tuple[Effect, Place]:
        kind, target = self._key(setting)
        effect = build_anywhere(kind, target, {})
        return effect, place_of(effect, self.description, model)

    @property
    def _present(self) -> dict[str, dict[str, dict[str, float]]]:
        """What is at work by the file, kinds by their names of today."""
        return {kind_anywhere(k).kind: told for k, told in self.description.present.items()}

    @staticmethod
    def _key(setting: Setting) -> tuple[str, str]:
        """Kind and target of the effect that changes an attribute."""
        element, name = setting.element
        attribute = setting.attribute
        known = {found: kind for (on, found), kind in attributes().items() if on is element}
        if attribute not in known:
            raise UnknownNameError(f"attribute of {element} {name}", attribute, known)
        on = known[attribute].anywhere
        axis = attribute.rpartition("_")[2]
        return known[attribute].kind, f"{name}.{axis}" if on and on.axis else name


def _value(setting: Setting, effect: Effect, m: Magnitude) -> float:
    """What a setting makes of its attribute: a mass above zero, friction and springs not below."""
    what = f"{setting.attribute} of {effect.target}"
    value = to_si(setting.value, m.unit, what)
    if m.sign is Sign.POSITIVE and value < 0.0:
        raise InvalidInputError(what, setting.value, "zero or more")
    if value <= effect.least(0.0):
        raise InvalidInputError(what, setting.value, "more than zero")
    return value
