"""Operation: what the operators do in a run, as a scenario's table."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from ves_twin.control.operation.state import Action, State
from ves_twin.scenario.fields import Part, Seconds, named

BEGINNINGS = tuple(state.value for state in State if state is not State.START)
"""States that a run can begin in; a start is watched, not stood in."""


class OperatorAction(Part):
    """One thing that an operator does, at a time."""

    at: Annotated[Seconds, Field(ge=0)]
    action: Annotated[Action, named("action", [action.value for action in Action])]


class Operation(Part):
    """The state that a run begins in, and what operators do in it.

    In `off` and `sleep` the platform begins with its legs retracted, in the other states at
    `platform.start`, which is also where a ramp to home leads.
    """

    begin: Annotated[State, named("state", BEGINNINGS)] = State.RUN
    actions: tuple[OperatorAction, ...] = ()

    @model_validator(mode="after")
    def _in_the_order_of_time(self) -> Self:
        for one, two in zip(self.actions, self.actions[1:], strict=False):
            if two.at < one.at:
                raise ValueError(
                    f"operation.actions: '{two.action}' at {two.at} s stands after"
                    f" '{one.action}' at {one.at} s"
                )
        return self
