"""Evaluation: what the twin gives for a claim, before it is judged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.thesis.claim import Claim
    from ves_twin.thesis.context import Context


@dataclass(frozen=True)
class Evaluation:
    """The twin's values for a claim, in the claim's unit.

    Attributes:
        values: what was computed; empty where only something happened.
        holds: whether a condition beside the values came out; None where there is none.
        note: what was measured and how, and why it differs if it does.
        runs: commands of the simulations behind it.
    """

    values: tuple[float, ...] = ()
    holds: bool | None = None
    note: str = ""
    runs: tuple[str, ...] = ()


@dataclass(frozen=True)
class NotBuilt:
    """The twin lacks something that would answer; `needs` says what."""

    needs: str


@dataclass(frozen=True)
class NotTestable:
    """No twin can answer; `reason` says why."""

    reason: str


@dataclass(frozen=True)
class NotRun:
    """Left out of a quick scorecard: only the full run tells; `reason` says what it takes."""

    reason: str


Evaluator = Callable[["Context", "Claim"], Evaluation | NotRun]
"""Computes the twin's values for a claim by running code or simulations; never judges."""

Found = Evaluation | NotBuilt | NotTestable | NotRun
"""What there is to say of a claim."""

Answer = Evaluator | NotBuilt | NotTestable
