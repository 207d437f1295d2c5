"""exit_code: how a command ended, as the number that the shell sees."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.simulator.outcome import Outcome

DONE, BAD_INPUT, ENDED_EARLY, OUT_OF_TOLERANCE, INTERRUPTED = 0, 2, 3, 4, 130
"""Exit codes."""


def exit_code(outcome: Outcome) -> int:
    """Code of how a run or a procedure ended."""
    return {"completed": DONE, "interrupted": INTERRUPTED}.get(outcome.value, ENDED_EARLY)
