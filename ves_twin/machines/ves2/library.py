"""The library of VES II: effects as parameters and hypotheses, and parameters back as a plant."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Hypothesis, Parameter
from ves_twin.effects.effect import Effect
from ves_twin.effects.hydraulics import ValveNull
from ves_twin.effects.law_table import CAUSE as LAW
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.recorder import LENGTHS
from ves_twin.effects.registry import EFFECTS, build_effect
from ves_twin.machines.ves2.slow_noise import MODES
from ves_twin.plant.fidelity import ABSENT_EFFECTS, Fidelity
from ves_twin.plant.hydraulics import Hydraulics
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario

UNSEEN = frozenset({"model_mass", "stale_gravity"})
"""Kinds that act on the admittance computer, above where a replay cuts the loop."""

OPEN_NUMBERS = (
    "platform.mass",
    "platform.com_height",
    "leg.rod_mass",
    "leg.bending_stiffness",
    "leg.bending_damping",
    "hydraulics.full_speed",
    "chamber.conductance",
    "chamber.bulk_modulus",
    "chamber.dead_volume",
    "chamber.viscous",
)
"""Numbers of the whole rig that commissioning leaves open, with the sd of the plant's table."""

SIGNS = {Sign.BOTH: (-1, 1), Sign.POSITIVE: (1,), Sign.NEGATIVE: (-1,)}

AXES = ("fx", "fy", "fz", "mx", "my", "mz")
OFFSET = "zero@sensor."
"""Prefix of what zeroing leaves on an axis of a recording."""

WANDER = "wander@sensor."
"""Prefix of a mode of the sensor's slow noise on an axis of a recording, in its own sd."""


def places(plant: Plant) -> Iterator[tuple[type[Effect], str]]:
    """Every kind of effect that a plant can have, on every target, part by part."""
    rows = [(kind, row) for kind in EFFECTS.values() for row in kind.rows]
    for kind, row in sorted(rows, key=lambda place: place[1].part):
        if kind.kind in UNSEEN:
            continue
        if plant.fidelity is Fidelity.FAST and kind.kind in ABSENT_EFFECTS:
            continue
        if plant.hydraulics is Hydraulics.LINEAR and row.pressure:
            continue
        for target in row.targets:
            yield kind, target


def idle_kinds(scenario: Scenario) -> frozenset[str]:
    """Kinds that act on a part that a scenario does not use."""
    filtered = scenario.legs.filter is not FilterPlace.NONE
    return frozenset() if filtered else frozenset({"filter_edge"})


def ruled_out(effect: str, target: str, misread: Collection[int]) -> bool:
    """Whether the valves' own commands speak against a cause.

    Args:
        effect: of the cause.
        target: of the cause.
        misread: legs, from 1, whose logged lengths are not what the leg program read.
    """
    if EFFECTS[effect].row_of(target).change == LENGTHS:
        return int(target.split(".")[2]) not in misread
    return effect == ValveNull.kind and int(target.split(".")[1]) in misread


def parameters_of(plant: Plant) -> tuple[Parameter, ...]:
    """The size of every effect, nominal where the plant has it, else zero."""
    present = {(e.kind, e.target): e.values for e in plant.effects}
    found = []
    for kind, target in places(plant):
        for m in kind.magnitudes_of(target):
            nominal = present.get((kind.kind, target), {}).get(m.name, 0.0)
            name = _name(kind.kind, target, m.name)
            # a nuisance moves to both sides of a one-sided bound only as far as it has room
            found.append(Parameter(name, m.unit, nominal, m.low, m.high, m.sd))
    return tuple(found)


def table_parameters(plant: Plant) -> tuple[Parameter, ...]:
    """Numbers of the whole rig with the sd of the table, as factors about one."""
    found = []
    for name in OPEN_NUMBERS:
        entry = plant.parameters[name]
        idle = name.startswith("chamber.") and plant.hydraulics is Hydraulics.LINEAR
        bending = name.startswith("leg.bending") and plant.fidelity is Fidelity.FAST
        if idle or bending:
            continue
        sd = float(np.max(entry.sd / np.abs(entry.value)))
        found.append(Parameter(f"table@{name}", "1", 1.0, 0.2, 5.0, sd))
    return tuple(found)


def offset_parameters(plant: Plant) -> tuple[Parameter, ...]:
    """What zeroing leaves on each axis, anew for each recording: the sensor's slow part."""
    sds = plant.parameters.array("sensor.wander")
    units = ("N", "N", "N", "N*m", "N*m", "N*m")
    return tuple(
        Parameter(f"{OFFSET}{axis}", unit, 0.0, -50.0, 50.0, 1.5 * float(sd), True, True)
        for axis, unit, sd in zip(AXES, units, sds, strict=True)
    )


def wander_parameters() -> tuple[Parameter, ...]:
    """Modes of the sensor's slow noise, anew for each recording: too slow for the whitening."""
    return tuple(
        Parameter(f"{WANDER}{axis}.{mode + 1}", "1", 0.0, -10.0, 10.0, 1.0, True, True)
        for axis in AXES
        for mode in range(MODES)
    )


def hypotheses_of(plant: Plant, exclude: frozenset[str] = frozenset()) -> tuple[Hypothesis, ...]:
    """One cause for each magnitude of each effect; a tilt leans any way, so its two go together."""
    found = []
    for kind, target in places(plant):
        if kind.kind in exclude:
            continue
        row, sizes = kind.row_of(target), kind.magnitudes_of(target)
        groups: list[tuple[Magnitude, ...]] = [(m,) for m in sizes]
        if kind.kind == "base_tilt":
            groups = [sizes]
        for group in groups:
            found.append(
                Hypothesis(
                    effect=kind.kind,
                    target=target,
                    parameters=tuple(_name(kind.kind, target, m.name) for m in group),
                    smallest=tuple(m.smallest for m in group),
                    largest=tuple(m.largest for m in group),
                    signs=SIGNS[group[0].sign],
                    source=row.source,
                    linear=kind.proportional,
                )
            )
    return tuple(found)


def with_departures(plant: Plant, values: Mapping[str, float]) -> tuple[Plant, FloatArray]:
    """A plant with named values, and the offsets (6,) [N, N m] that its wrench is read with.

    Modes of the slow noise and laws are no part of either.
    """
    sizes: dict[tuple[str, str], dict[str, object]] = {}
    factors: dict[str, object] = {}
    offsets = np.zeros(6)
    for name, value in values.items():
        if name.startswith((WANDER, f"{LAW}@")):
            continue
        if name.startswith(OFFSET):
            offsets[AXES.index(name.removeprefix(OFFSET))] = value
        elif name.startswith("table@"):
            number = name.removeprefix("table@")
            if value != 1.0:
                factors[number] = plant.parameters.array(number) * value
        else:
            kind, rest = name.split("@")
            target, magnitude = rest.split(":")
            sizes.setdefault((kind, target), {})[magnitude] = value
    effects = [build_effect(kind, target, found) for (kind, target), found in sizes.items()]
    return plant.with_values(factors).extended(*effects), offsets


def _name(kind: str, target: str, magnitude: str) -> str:
    return f"{kind}@{target}:{magnitude}"
