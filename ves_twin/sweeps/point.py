"""Point: one run of a sweep, with all that decides its numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.sweeps.key_value import Value


@dataclass(frozen=True)
class Point:
    """One run of a sweep; it travels to the worker as it is.

    Attributes:
        number: place in the sweep, from 0.
        values: varied keys in SI, in the order of the sweep.
        scenario: the validated scenario.
        plant: the world, without the scenario's parameters and effects, which a run adds.
        plant_hash: hash of the world with them.
        run_id: hash of scenario, plant, belief, files that they name, and versions: equal id,
            equal run.
        versions: of everything that shapes the numbers; a worker with others is refused.
    """

    number: int
    values: tuple[Value, ...]
    scenario: Scenario
    plant: Plant
    plant_hash: str
    run_id: str
    versions: Mapping[str, str]
