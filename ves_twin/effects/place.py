"""Place: a target of an effect with the typical sizes that sizes of effects follow from."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.effects.element import Element


@dataclass(frozen=True)
class Place:
    """A target with the typical sizes that sizes of effects follow from.

    Attributes:
        element: what it is.
        name: as the file has it: "axis", "motor", "tool.x", "wrist.force.3".
        hinge: whether a joint turns rather than slides.
        effort, speed, travel: typical at a joint [N or N m, m/s or rad/s, m or rad]; of an
            actuator the command that this effort takes, of a servo the travel.
        stiffness: of the spring of a joint or tendon in the model, or of a position servo
            [N/m or N m/rad].
        gain: of an actuator in the model.
        lag: time constant of the filter that an actuator's command passes in the model [s].
        unit: of a signal, or of an actuator's command.
        span: typical range of a signal [its unit].
        mass: of a body [kg].
        carries: whether a body is the last of an arm, and may carry what nobody declared.
        begin, end, terms: stretch that drift shapes span, and their count.
    """

    element: Element
    name: str
    hinge: bool = False
    effort: float = 0.0
    speed: float = 0.0
    travel: float = 0.0
    stiffness: float = 0.0
    gain: float = 1.0
    lag: float = 0.0
    unit: str = "1"
    span: float = 0.0
    mass: float = 0.0
    carries: bool = False
    begin: float = 0.0
    end: float = 1.0
    terms: int = 4
