"""Procedure: an experiment of many runs with one result, as a frozen file like a scenario."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, JsonValue

from ves_twin.scenario.fields import Part
from ves_twin.simulator.outcome import Outcome

if TYPE_CHECKING:
    from ves_twin.plant.plant import Plant

Progress = Callable[[float, str], None]
"""Called with the share done, 0 to 1, and what is being done."""


def part_of(progress: Progress, number: int, parts: int) -> Progress:
    """The progress of part `number`, counted from 0, of a number of equal parts."""
    return lambda share, what: progress((number + share) / parts, what)


@dataclass(frozen=True)
class RunContext:
    """How a procedure is carried out: where its files go, in which world, with which seed.

    `plant` and `seed` are None where the procedure's own stand. `progress` may raise
    KeyboardInterrupt; what is written by then must be whole.
    """

    folder: Path
    plant: Plant | None = None
    seed: int | None = None
    progress: Progress = lambda share, what: None


@dataclass(frozen=True)
class Result:
    """What a procedure found: how it ended, numbers for `summary.json`, lines for a person."""

    outcome: Outcome
    values: dict[str, JsonValue] = field(default_factory=dict)
    lines: tuple[str, ...] = ()


class Procedure(Part, ABC):
    """One experiment of many runs; its options are the fields of the concrete class.

    A file names its class by `procedure = "..."`; its first line is the question.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]{1,64}$")]
    question: Annotated[str, Field(min_length=1)]
    procedure: str
    plant: str = "ves2"

    @abstractmethod
    def carry_out(self, conduct: RunContext) -> Result:
        """Run the experiment; write its files into the folder.

        Raises:
            VesTwinError: options that cannot be carried out.
        """
