"""Context: the world in which claims are evaluated, with every simulation run only once."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from shlex import quote
from typing import Any

from ves_twin.core.recording.recording import Recording
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.simulate import simulate


class Models(StrEnum):
    """Which form of a model is used where the thesis's own is in error (errata)."""

    THESIS = "thesis"
    CORRECTED = "corrected"


@dataclass(frozen=True)
class Run:
    """A simulation and the command that repeats it."""

    recording: Recording
    command: str


@dataclass(frozen=True)
class Context:
    """What evaluators share.

    Attributes:
        plant: the world.
        quick: shorter simulations, so that all claims take less than two minutes; what would come
            out otherwise in a shorter one is not run (`NotRun`).
        models: which form of the emulated models is used where there are two.
        plant_name: what `--plant` must say to get this plant; empty for the nominal one.
    """

    plant: Plant
    quick: bool = False
    models: Models = Models.THESIS
    plant_name: str = ""
    _kept: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def run(self, scenario: str, changes: Mapping[str, object] | None = None) -> Run:
        """A scenario with some keys changed, on this plant; run once, then kept.

        Raises:
            VesTwinError: the scenario cannot be built.
        """
        changes = dict(changes or {})
        command = self._command(scenario, changes)
        loaded = Scenario.load(scenario, changes)
        run: Run = self.once(command, lambda: Run(simulate(loaded, self.plant), command))
        return run

    def once(self, key: str, make: Callable[[], Any]) -> Any:
        """What `make` gives, made at the first call with this key."""
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]

    def _command(self, scenario: str, changes: Mapping[str, object]) -> str:
        words = ["ves-twin run", scenario]
        words += ["--set " + quote(f"{key}={_text(value)}") for key, value in changes.items()]
        if self.plant_name:
            words.append(f"--plant {self.plant_name}")
        return " ".join(words)


def _text(value: object) -> str:
    """A value as `--set KEY=VALUE` reads it."""
    return value if isinstance(value, str) else _inline(value)


def _inline(value: object) -> str:
    """A value in TOML, on one line."""
    if isinstance(value, Mapping):
        return "{" + ",".join(f"{key}={_inline(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ",".join(map(_inline, value)) + "]"
    return json.dumps(value)
