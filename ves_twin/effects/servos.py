"""Effects of a position servo of MuJoCo: stiffness kp, damping kv, all of it, and its lag."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

from ves_twin.core.errors import InvalidInputError
from ves_twin.effects import change
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.effects.row import Anywhere
from ves_twin.effects.size import DAMPING, STIFFNESS, Size

if TYPE_CHECKING:
    import mujoco

SLOWEST = 0.3
"""Time constant kv / kp of a slow servo [s]: assumed, hobby servos take 0.1 to 0.2 s for 60 deg."""

QUICKEST = 0.005
"""Time constant that a fit does not go below [s], unless the model does: no log of set-points shows
less."""

SOFTEST = 0.001
"""Share of its kp that a servo has at least: none pushes away from where it is told to be, and one
without any is no servo."""

WEAKEST = 0.1
"""Share of its strength that a servo has at least: a tenth is another servo."""


def _of_servo(kind: str, place: Place) -> Place:
    if not place.stiffness:
        expected = "a position servo that is fed its set-points (drive.mode control)"
        raise InvalidInputError(f"target of {kind}", place.name, expected)
    return place


@final
@dataclass(frozen=True)
class ServoStiffness(Effect):
    """A position servo pulls harder or weaker than the model says: kp -> kp + stiffness.

    The effort of a servo is kp (u - q) - kv v, u its set-point. Datasheets of hobby servos and of
    drives with loops of their own have no kp.
    """

    stiffness: float = 0.0

    kind = "servo_stiffness"
    sizes = (Size("stiffness", STIFFNESS),)
    proportional = False
    anywhere = Anywhere(
        Element.ACTUATOR,
        lambda p: 3.0 * p.stiffness,
        attribute=change.SERVO_STIFFNESS,
        source="assumed; no datasheet has it: up to four times as stiff",
    )

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Stiffness with its range; raises InvalidInputError of another drive."""
        return super().magnitudes_at(_of_servo(cls.kind, place))

    def least(self, nominal: float) -> float:
        """A thousandth of it."""
        return SOFTEST * nominal


@final
@dataclass(frozen=True)
class ServoDamping(Effect):
    """A position servo brakes harder, or less, than the model says: kv -> kv + damping.

    Of a joint whose speed alone is known it is viscous friction by another name.
    """

    damping: float = 0.0

    kind = "servo_damping"
    sizes = (Size("damping", DAMPING, Sign.POSITIVE),)
    proportional = False
    anywhere = Anywhere(
        Element.ACTUATOR,
        lambda p: SLOWEST * p.stiffness,
        attribute=change.SERVO_DAMPING,
        source="assumed; no datasheet has it",
    )

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Damping with its range; raises InvalidInputError of another drive."""
        return super().magnitudes_at(_of_servo(cls.kind, place))


@final
@dataclass(frozen=True)
class ServoStrength(Effect):
    """A position servo gives more, or less, of all: kp, kv and force limits x (1 + share).

    Its effort is (1 + s)(kp (u - q) - kv v) within (1 + s) of its limits and its joint's: another
    gear, motor or supply than the model's, or a stall torque that was guessed.
    """

    share: float = 0.0

    kind = "servo_strength"
    sizes = (Size("share", "1"),)
    proportional = False
    anywhere = Anywhere(
        Element.ACTUATOR, 3.0, 0.02, source="assumed: another gear, up to four times as strong"
    )

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """The share with its range; raises InvalidInputError of another drive."""
        return super().magnitudes_at(_of_servo(cls.kind, place))

    def least(self, nominal: float) -> float:
        """All but a tenth of it gone."""
        return WEAKEST - 1.0

    def edit_model(self, model: mujoco.MjModel) -> None:
        """Scale what it pulls and brakes with, and where that ends."""
        at = model.actuator(self.target).id
        for numbers in (model.actuator_gainprm, model.actuator_biasprm):
            numbers[at, :3] *= 1.0 + self.share
        model.actuator_forcerange[at] *= 1.0 + self.share
        model.jnt_actfrcrange[model.actuator_trnid[at, 0]] *= 1.0 + self.share


@final
@dataclass(frozen=True)
class ActuatorLag(Effect):
    """A command passes a slower, or quicker, filter than the model says: tau -> tau + time.

    MuJoCo's `filter` and `filterexact`: tau da/dt = u - a, and the actuator acts by a.
    """

    time: float = 0.0

    kind = "actuator_lag"
    sizes = (Size("time", "s"),)
    proportional = False
    anywhere = Anywhere(
        Element.ACTUATOR,
        lambda p: max(3.0 * p.lag, 0.1),
        attribute=change.LAG,
        source="assumed; no datasheet has it: up to four times as slow",
    )

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """The lag with its range; raises InvalidInputError where the model has none."""
        if not place.lag:
            expected = "an actuator of dyntype filter or filterexact (drive.mode control)"
            raise InvalidInputError(f"target of {cls.kind}", place.name, expected)
        return super().magnitudes_at(place)

    def least(self, nominal: float) -> float:
        """QUICKEST, or what the model has."""
        return min(QUICKEST, nominal)

    def edit_model(self, model: mujoco.MjModel) -> None:
        """The slower filter; no quicker than the model's step, as `filter` is explicit."""
        if self.time:
            super().edit_model(model)
            at = change.LAG.entry(model, self.target)
            model.actuator_dynprm[at] = max(float(model.actuator_dynprm[at]), model.opt.timestep)
