"""Readings: every other way to read the columns of a machine, one change at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ves_twin.data.mapping.column_expression import quoted
from ves_twin.diagnosis.record.likeness import FACTORS
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.parts.predecessor import predecessor
from ves_twin.machines.mjcf.plausible.reading import Reading
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import driven_joint

TURNS = {"a quarter turn": 0.5 * np.pi, "minus a quarter turn": -0.5 * np.pi, "half a turn": np.pi}
"""Between the zeros that laboratories have: hanging, upright, level."""


@dataclass(frozen=True)
class Readings:
    """Ways to read columns of positions and efforts.

    Attributes:
        rig: the machine.
        sources: actuator -> signal of its effort.
        angles: joint -> signal of its position.
    """

    rig: Rig
    sources: Mapping[str, str]
    angles: Mapping[str, str]

    def every(self) -> Iterator[Reading]:
        """Every other way to read the columns, one change at a time."""
        sources, angles = self.sources, self.angles
        for actuator, signal in sources.items():
            key = f"the sign of {signal}: compare.SIGNAL.sign, or signals.NAME.scale"
            yield Reading(f"the other sign of {signal}", key, {}, {actuator: -1.0})
        for joint, signal in angles.items():
            key = f"the axis of joint {joint} and the sign of {signal}"
            yield Reading(f"the other sign of {signal}", key, {joint: -1.0}, {})
        for names in (sources, angles):
            for word, share, group in self._units(names):
                told = ", ".join(names[n] for n in group)
                numbers = dict.fromkeys(group, share)
                both = ({}, numbers) if names is sources else (numbers, {})
                yield Reading(f"{told} in {word}", f"unit and scale of {told}", *both)
            for one, two in combinations(names, 2):
                told = f"{names[one]} and {names[two]}"
                yield Reading(f"{told} swapped", f"the columns of {told}", {}, {}, (one, two))
        yield from self.from_the_world()
        yield from self._before_gears(angles)
        yield from self._from_another_zero(angles)
        if len(self.sources) > 1:
            every = dict.fromkeys(self.sources, -1.0)
            yield Reading("the other sign of all efforts", "the sign of all efforts", {}, every)
        key = "option.gravity of the model, and how its base stands"
        yield Reading("gravity the other way", key, {}, {}, gravity=-1.0)

    def from_the_world(self) -> Iterator[Reading]:
        """Angles that have the motion of joints before them in them: one, or all."""
        angles = self.angles
        found = {j: predecessor(self.rig.model, j, angles) for j in angles}
        less = {joint: before for joint, before in found.items() if before}
        for group in [[joint] for joint in less] + ([list(less)] if len(less) > 1 else []):
            told = ", ".join(angles[joint] for joint in group)
            formulas = " and ".join(self._formula(j, *less[j]) for j in group)
            own = {joint: less[joint] for joint in group}
            key = f"signals.NAME.columns: a formula as {formulas}"
            yield Reading(f"{told} measured from the world", key, {}, {}, less=own)

    def _formula(self, joint: str, before: str, along: float) -> str:
        """The difference of two joints' columns, as a machine's file may hold it."""
        told, forward = self.rig.description, MjcfForward.of(self.rig)
        names = [forward.position_of(one) for one in (joint, before)]
        signs = {c.joint: c.sign for c in told.compare.values() if c.of == "position" and c.joint}
        one, two = (quoted(told.signals[name].columns[0]) for name in names)
        turned = np.prod([told.signals[name].scale for name in names])
        turned *= signs.get(joint, 1) * signs.get(before, 1) * along
        return f"{one} {'-' if turned > 0.0 else '+'} {two}"

    def _before_gears(self, angles: Mapping[str, str]) -> Iterator[Reading]:
        """Angles of motors, whose gear stands in the model."""
        for actuator in self.sources:
            joint = driven_joint(self.rig.model, actuator)
            gear = abs(float(self.rig.model.actuator(actuator).gear[0]))
            if gear not in (0.0, 1.0) and joint in angles:
                name = f"{angles[joint]} of the motor, before its gear of {gear:g}"
                yield Reading(name, f"the scale of {angles[joint]}", {joint: 1.0 / gear}, {})

    def _from_another_zero(self, angles: Mapping[str, str]) -> Iterator[Reading]:
        """Angles that are zero a quarter or half a turn away."""
        for joint, signal in angles.items():
            if self.rig.description.signals[signal].unit != "rad":
                continue
            for word, turn in TURNS.items():
                name = f"{word} added to {signal}"
                key = f"signals.NAME.offset of {signal}: where it is zero"
                yield Reading(name, key, {}, {}, zeros={joint: turn})

    def _units(self, names: Mapping[str, str]) -> Iterator[tuple[str, float, list[str]]]:
        """Other units, their factors, and who may have them: one signal, or all of one unit."""
        signals = self.rig.description.signals
        units = {name: signals[signal].unit for name, signal in names.items()}
        for unit in dict.fromkeys(units.values()):
            group = [name for name in names if units[name] == unit]
            for word, factor in FACTORS.get(unit, {}).items():
                yield from ((word, 1.0 / factor, [name]) for name in group)
                if len(group) > 1:
                    yield word, 1.0 / factor, group
