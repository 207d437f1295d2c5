"""SettledRigs: simulators that stand settled at t = 0, so that an episode begins by a copy."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import Generic, TypeVar

from ves_twin.core.errors import InvalidInputError
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.noise import NoiseStreams
from ves_twin.simulator.recorder import NoSink, Sink
from ves_twin.simulator.simulator import Simulator, Snapshot

KEPT = 8
"""Rigs kept; one takes a few megabytes, and a quarter of a second to build and settle."""

Hand = TypeVar("Hand")


@dataclass(frozen=True)
class SettledRig(Generic[Hand]):
    """A simulator, what commands it, and its state at t = 0."""

    sim: Simulator
    hand: Hand
    snapshot: Snapshot

    def begin(self, seed: int, sink: Sink | None) -> None:
        """Go back to t = 0 with the noise of a seed; rows go to a sink, or nowhere.

        The settling before t = 0 keeps the scenario's own seed, so that it is done once.
        """
        sim = self.sim
        sim.recorder.sink = NoSink() if sink is None else sink
        sim.restore(self.snapshot)
        sim.seed = seed
        sim.rig.noise = NoiseStreams(seed, sim.scenario.run.noise)


class SettledRigs(Generic[Hand]):
    """The last few rigs by plant and scenario."""

    def __init__(self) -> None:
        self._kept: OrderedDict[tuple[str, str, str], SettledRig[Hand]] = OrderedDict()

    def find(self, plant: Plant, scenario: Scenario) -> SettledRig[Hand] | None:
        """The rig of a plant under a scenario, if it is kept."""
        key = _key(plant, scenario)
        if key in self._kept:
            self._kept.move_to_end(key)
        return self._kept.get(key)

    def keep(self, plant: Plant, sim: Simulator, hand: Hand) -> SettledRig[Hand]:
        """Keep a simulator that has just been built.

        Args:
            plant: the plant it was asked for with.
            sim: settled, at t = 0.
            hand: what commands it.

        Raises:
            InvalidInputError: the rig could not stand.
        """
        if sim.outcome is not None:
            came = f"{sim.outcome.value} while settling ({sim.outcome.advice})"
            raise InvalidInputError(f"plant {plant.name}", came, "a rig that stands at its start")
        sim.recorder.drop_references()
        rig = SettledRig(sim, hand, sim.snapshot())
        self._kept[_key(plant, sim.scenario)] = rig
        while len(self._kept) > KEPT:
            self._kept.popitem(last=False)
        return rig


def _key(plant: Plant, scenario: Scenario) -> tuple[str, str, str]:
    return plant.name, plant.hash, scenario.model_dump_json()
