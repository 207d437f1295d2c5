"""effects_of: the effects that a verdict on VES II names."""

from __future__ import annotations

from ves_twin.diagnosis.verdict.cause import Cause
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.effects.effect import Effect
from ves_twin.effects.law_table import CAUSE as LAW
from ves_twin.effects.registry import build_effect
from ves_twin.machines.ves2.filter_place import EFFECT as FILTER_PLACE


def effects_of(verdict: Verdict) -> tuple[Effect, ...]:
    """The effects that a verdict names, at their estimated sizes; none where it names none.

    A filter at another place is no part of a plant: that is the scenario's `legs.filter`. A law is
    no effect.
    """
    if not verdict.verdict.names_a_plant:
        return ()
    return tuple(effect_of(c) for c in verdict.causes if c.effect not in (FILTER_PLACE, LAW))


def effect_of(cause: Cause) -> Effect:
    """The effect that a cause names, at its estimated size."""
    sizes = {name: estimate.value for name, estimate in cause.parameters.items()}
    return build_effect(cause.effect, cause.target, sizes)
