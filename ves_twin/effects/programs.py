"""Effects of VES II's deployed programs: what runs is not the program that is written.

One program runs all six legs, so its kinds have the target "legs"; a leg whose amplifier is off is
`valve_gain`. The sd is zero: commissioning leaves nothing open in a number of a program.

Kinds of the admittance computer show while the loop is closed over the force sensor. A replay
drives the legs with recorded set-points, and the estimate is recorded, too: it cannot see them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.effects.change import Law, Loop
from ves_twin.effects.effect import Effect
from ves_twin.effects.magnitude import Sign
from ves_twin.effects.row import ALL_LEGS, COMPUTERS, JOINTS, Part, Row
from ves_twin.effects.size import Size

LEG_LOOP = ("leg.length", "valve.command")


@final
@dataclass(frozen=True)
class LegGain(Effect):
    """The leg loops run with another gain: K1 -> (1 + share) K1."""

    share: float = 0.0

    kind = "leg_gain"
    sizes = (Size("share", "1"),)
    source = "thesis 5.2: gains were tuned by hand at the rig"
    proportional = False
    rows = (Row(ALL_LEGS, (0.0, 0.02, 0.5), LEG_LOOP, Loop("legs.gain", Law.SCALE), Part.PROGRAM),)


@final
@dataclass(frozen=True)
class LegRateGain(Effect):
    """The leg loops damp more or less than they should: K2 -> K2 + change, on measured speed."""

    change: float = 0.0

    kind = "leg_rate_gain"
    sizes = (Size("change", "1"),)
    source = "thesis 5.2: K2 beside K1 in the deployed law"
    proportional = False
    rows = (Row(ALL_LEGS, (0.0, 0.01, 0.2), LEG_LOOP, Loop("legs.rate_gain"), Part.PROGRAM),)


@final
@dataclass(frozen=True)
class FilterEdge(Effect):
    """The leg filter's coefficients are those of another edge: f -> (1 + share) f.

    An edge without a filter is refused. The filter at another *place* is no size of anything: that
    is the scenario's `legs.filter`.
    """

    share: float = 0.0

    kind = "filter_edge"
    sizes = (Size("share", "1"),)
    source = "thesis Table 5-1, errata E-43: coefficients copied by hand"
    proportional = False
    rows = (Row(ALL_LEGS, (0.0, 0.05, 0.5), LEG_LOOP, Loop("legs.edge", Law.SCALE), Part.PROGRAM),)


@final
@dataclass(frozen=True)
class CommandLimit(Effect):
    """The valve commands are cut off early: |u| <= 1 / (1 + tightness) in place of 1."""

    tightness: float = 0.0

    kind = "command_limit"
    sizes = (Size("tightness", "1", Sign.POSITIVE),)
    source = "assumed; a limit left in the program, or a converter of less range"
    proportional = False
    rows = (Row(ALL_LEGS, (0.0, 1.0, 9.0), LEG_LOOP, Loop("legs.limit", Law.DIVIDE), Part.PROGRAM),)


@final
@dataclass(frozen=True)
class ServoGain(Effect):
    """A joint's servo runs with another stiffness: K -> (1 + share) K.

    The zero-g reference has the same servo: its arm is this arm, on the base that is meant.
    """

    share: float = 0.0

    kind = "servo_gain"
    sizes = (Size("share", "1"),)
    source = "thesis 2.4.3: gains set in the motion controller; size assumed"
    proportional = False
    rows = (
        Row(
            JOINTS,
            (0.0, 0.02, 0.5),
            ("arm.q", "arm.torque"),
            Loop("servo.stiffness", Law.SCALE),
            Part.PROGRAM,
        ),
    )


@final
@dataclass(frozen=True)
class ModelMass(Effect):
    """Phi and Gamma are those of another mass: M -> (1 + share) M in the deployed model.

    The whole matrix, inertia and coupling with it; the zero-g reference keeps the system that the
    scenario names, so that the emulation error shows it.
    """

    share: float = 0.0

    kind = "model_mass"
    sizes = (Size("share", "1"),)
    source = "thesis eqs 2.4 to 2.6, errata E-2: matrices worked out beforehand"
    rows = (
        Row(COMPUTERS, (0.0, 0.05, 0.5), ("platform.command", "leg.length"), part=Part.COMPUTERS),
    )

    def edit_computers(self, numbers: dict[str, FloatArray]) -> None:
        """Scale the mass matrix.

        Raises:
            InvalidInputError: nothing is emulated.
        """
        if "emulated.mass" not in numbers:
            raise InvalidInputError("effects.model_mass", self.share, "an emulated system")
        numbers["emulated.mass"] *= 1.0 + self.share


@final
@dataclass(frozen=True)
class StaleGravity(Effect):
    """The gravity estimate is older than planned by whole cycles, the nearest to `cycles`."""

    cycles: float = 0.0

    kind = "stale_gravity"
    sizes = (Size("cycles", "1", Sign.POSITIVE),)
    source = "thesis 2.4.2: the estimate comes through shared memory"
    rows = (
        Row(
            COMPUTERS,
            (0.0, 1.0, 20.0),
            ("gravity.estimate", "platform.command"),
            part=Part.COMPUTERS,
        ),
    )

    def edit_computers(self, numbers: dict[str, FloatArray]) -> None:
        """Let the estimate grow older."""
        numbers["gravity.age"] += np.rint(self.cycles)
