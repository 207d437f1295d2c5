"""driving: proved frictions of which the whole would push its joint on, which no friction does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from ves_twin.diagnosis.build_up.result import Proved

BOUNDED = {
    "coulomb_asymmetry": ("coulomb_friction", "level"),
    "viscous_asymmetry": ("viscous_friction", "damping"),
}
"""Kind -> the friction, with its size, that it may take no more of than there is."""

DRY_OR_VISCOUS = tuple(BOUNDED.values())

OTHERS = frozenset(
    {
        "dahl_friction",
        "friction_behind_gap",
        "load_friction",
        "one_way_load",
        "regularized_friction",
        "stribeck_friction",
        "quadratic_drag",
    }
)
"""Further frictions of a joint, beside which nothing is said: they may be the whole."""


def driving(proved: Sequence[Proved], nominal: Mapping[str, float]) -> tuple[Proved, ...]:
    """With those marked, and not firm, whose joint would get energy from its friction.

    Friction that falls with speed, or grows less than in proportion to it, is a part of some other
    one; one that differs by direction is that much more or less of it. Without that other one what
    improves the prediction is no friction: an effort that is read late does, or an offset.

    Args:
        proved: causes with sizes.
        nominal: what the model has of each parameter, by name; a friction that is neither among
            them nor proved is not known, and nothing is said.
    """
    return tuple(
        replace(one, firm=False, drives=True) if _drives(one, proved, nominal) else one
        for one in proved
    )


def _drives(one: Proved, proved: Sequence[Proved], nominal: Mapping[str, float]) -> bool:
    beside = (o for o in proved if o is not one and o.target == one.target)
    if any(o.effect in OTHERS for o in beside):
        return False
    if one.sublinear:
        whole = [_whole(kind, size, one.target, proved, nominal) for kind, size in DRY_OR_VISCOUS]
        return all(value is not None and value <= 0.0 for value in whole)
    if one.effect not in BOUNDED:
        return False
    whole_of = _whole(*BOUNDED[one.effect], one.target, proved, nominal)
    part = next(iter(one.parameters.values())).value
    return whole_of is not None and abs(part) > whole_of


def _whole(
    kind: str, size: str, target: str, proved: Sequence[Proved], nominal: Mapping[str, float]
) -> float | None:
    """A friction of a place, as proved or as the model has it; None where nobody tells."""
    own = (o.parameters[size].value for o in proved if (o.effect, o.target) == (kind, target))
    return next(own, nominal.get(f"{kind}@{target}:{size}"))
