"""SweepPlan: every point of a sweep, checked before the first one runs, and what it is."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.core.resources import find_resource
from ves_twin.effects.registry import parse_effects
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.plant import Plant
from ves_twin.scenario.motions import SetpointMotion
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.simulate import versions
from ves_twin.sweeps.draw import draw_points
from ves_twin.sweeps.key_value import Value, key_value
from ves_twin.sweeps.point import Point
from ves_twin.sweeps.variation import MOST_VALUES, Variation

SCHEMA = 1
"""Version of the identity file."""


@dataclass(frozen=True)
class SweepPlan:
    """A sweep that can be carried out.

    Attributes:
        scenario: the scenario without the varied keys.
        keys: varied key -> unit of its values, "" where they have none.
        points: every run.
        identity: what the sweep is: scenario, varied keys, seed, plant, versions. Rows of another
            identity are never mixed with its own.
    """

    scenario: Scenario
    keys: Mapping[str, str]
    points: tuple[Point, ...]
    identity: Mapping[str, object]


def plan_sweep(
    scenario: str,
    vary: Sequence[str],
    settings: Mapping[str, object] | None = None,
    plant: Plant | None = None,
    number: int = 0,
    seed: int | None = None,
) -> SweepPlan:
    """A plan, every point of it validated.

    Args:
        scenario: a name or a TOML file.
        vary: "KEY=V1,V2,..." or a range, see `Variation.parse`.
        settings: keys changed in every point.
        plant: the world of every point; the scenario's own if left out.
        number: random points; 0 for the grid.
        seed: of the noise of every point and of the draws; the scenario's own if left out.

    Raises:
        VesTwinError: a key or value that cannot be used, by its first point; nothing has run.
    """
    if not 0 <= number <= MOST_VALUES:
        raise InvalidInputError("--random", number, f"1 to {MOST_VALUES} points")
    variations = _variations(vary, plant)
    common = {**(settings or {}), **({} if seed is None else {"run.seed": seed})}
    base = Scenario.load(scenario, common)
    chosen = base.run.seed if seed is None else seed

    def resolve(key: str, value: object) -> Value:
        one = Scenario.load(scenario, {**common, key: value})
        return key_value(one, _world(one, plant), key)[0]

    drawn = draw_points(variations, number, chosen, resolve)
    keys: dict[str, str] = {}
    points = []
    for k, changes in enumerate(drawn):
        point, units = _point(k, Scenario.load(scenario, {**common, **changes}), plant, changes)
        points.append(point)
        keys |= {key: unit for key, unit in units.items() if unit or key not in keys}
    identity = {
        "schema": SCHEMA,
        "scenario": base.name,
        "settings": base.model_dump_json(),
        "vary": {variation.key: variation.text for variation in variations},
        "random": number,
        "seed": chosen,
        "plant_hash": _world(base, plant).hash,
        "versions": dict(versions()),
        "points": len(points),
        "points_hash": _digest(*(point.run_id for point in points)),
    }
    return SweepPlan(base, keys, tuple(points), identity)


def _variations(vary: Sequence[str], plant: Plant | None) -> list[Variation]:
    variations = [Variation.parse(text) for text in vary]
    if not variations:
        raise InvalidInputError("--vary", None, "one key or more, as in legs.gain=8,12,16")
    seen: set[str] = set()
    for variation in variations:
        if variation.key in seen:
            raise InvalidInputError("--vary", variation.key, "each key once")
        if variation.key == "plant" and plant is not None:
            raise InvalidInputError("--vary", "plant, and --plant", "one of them")
        seen.add(variation.key)
    return variations


def _point(
    number: int, scenario: Scenario, plant: Plant | None, changes: Mapping[str, object]
) -> tuple[Point, dict[str, str]]:
    world = _world(scenario, plant)
    found = {key: key_value(scenario, world, key) for key in changes}
    point = Point(
        number=number,
        values=tuple(value for value, _ in found.values()),
        scenario=scenario,
        plant=plant or Plant.load(scenario.plant),
        plant_hash=world.hash,
        run_id=_digest(
            scenario.model_dump_json(), world.hash, *_named(scenario), json.dumps(versions())
        ),
        versions=dict(versions()),
    )
    return point, {key: unit for key, (_, unit) in found.items()}


def _world(scenario: Scenario, plant: Plant | None) -> Plant:
    """The plant with the scenario's parameters and effects."""
    world = (plant or Plant.load(scenario.plant)).with_values(scenario.parameters)
    return world.extended(*parse_effects(scenario.effects))


def _named(scenario: Scenario) -> tuple[str, ...]:
    """What the files and models that a scenario names hold now."""
    emulated, gravity, arm = scenario.platform.emulated, scenario.gravity, scenario.arm
    parts = [Plant.load(scenario.belief).hash]
    if emulated is not None:
        parts.append(EmulatedSystem.load(emulated).identity)
    if gravity.file is not None:
        learned = gravity.method == "learned"
        kind, folder = "gravity.file", "models/gravity"
        path = Path(gravity.file) if learned else find_resource(kind, folder, gravity.file)
        parts.append(_bytes_hash(path))
    played = [("operator file", arm.operator)]
    if isinstance(motion := scenario.platform.motion, SetpointMotion):
        played.append(("set-point file", motion.file))
    for kind, file in played:
        if file is not None:
            parts.append(_bytes_hash(find_resource(kind, "scenarios/data", file, ".csv")))
    return tuple(parts)


def _bytes_hash(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise FileAccessError(f"{path}: {error.strerror}") from None


def _digest(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]
