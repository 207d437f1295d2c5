"""given_scenario and given_plant: what a user gave, by name, file or as it is."""

from __future__ import annotations

from ves_twin.core.errors import InvalidInputError
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario


def given_scenario(given: object) -> Scenario:
    """A scenario; raises InvalidInputError for anything else than a name, a file or a Scenario."""
    if isinstance(given, Scenario):
        return given
    if isinstance(given, str):
        return Scenario.load(given)
    raise InvalidInputError("scenario", given, "a name, a file or a Scenario")


def given_plant(given: object) -> Plant:
    """A plant; raises InvalidInputError for anything else than a name, a file or a Plant."""
    if isinstance(given, Plant):
        return given
    if isinstance(given, str):
        return Plant.load(given)
    raise InvalidInputError("plant", given, "a name, a file or a Plant")
