"""LawFinding: what a search for a law found, as it stands in verdict.json."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.effects.law import WITHIN, joints_of

LAW = "a law"
"""What a search for one is called, or begins with, where time leaves it out."""

RUBS = "sign(speed) times a curve of position"
"""Form of a dry friction that depends on where a joint stands."""


@dataclass(frozen=True)
class LawNumber:
    """One number of a closed form, with its 90 % interval."""

    name: str
    value: float
    low: float
    high: float


@dataclass(frozen=True)
class LawRival:
    """Another law that was fitted.

    Attributes:
        label: place, variables, family.
        form: formula; empty of a table.
        behind: log odds by which it is less probable than the best [nats].
        adequate: whether it leaves noise.
    """

    label: str
    form: str
    behind: float
    adequate: bool


@dataclass(frozen=True)
class LawFinding:
    """A law, or the place and the variable where one is missing.

    Attributes:
        claimed: whether it is a law; else only the best place and variables.
        reason: why it is not claimed, one sentence; empty where it is.
        place: joint or channel.
        kind: "effort" or "reading".
        of: variables, by name.
        units: of the variables, then of the law.
        shape: table, mesh, stop, play or hold.
        form: formula; empty of a table.
        numbers: of the closed form.
        knots, values: as it is simulated.
        band: places, and low and high ends of the 90 % band there; of a form with what a smooth
            departure from it may be; () without one.
        seen: ends of each variable in the recordings.
        points: variable and effort or reading that the recordings ask for, and its sd.
        transient: whether it depends on time, and says nothing of other times.
        nats: log odds over no law.
        misfit, misfit_limit: largest cell score that it leaves, and that noise may.
        further: log odds of a further law beside it, over what the simulation's error allows.
        also: what else it could be, and what was tried, the nearest first.
        gain: on held-out recordings; None if there were none.
        part: whether it is of what proved causes leave, and is no explanation of all of it.
    """

    claimed: bool
    reason: str
    place: str
    kind: str
    of: tuple[str, ...]
    units: tuple[str, ...]
    shape: str
    form: str
    numbers: tuple[LawNumber, ...]
    knots: tuple[tuple[float, ...], ...]
    values: tuple[float, ...]
    band: tuple[tuple[float, ...], ...]
    seen: tuple[tuple[float, float], ...]
    points: tuple[tuple[float, ...], ...]
    transient: bool
    nats: float
    misfit: float
    misfit_limit: float
    further: float
    also: tuple[LawRival, ...]
    gain: Gain | None
    part: bool = False

    @property
    def words(self) -> str:
        """The law in words: "effort at joint against its speed, -0.02 |x| x"."""
        told = {"play": "play", "hold": "rows that repeat", "stop": "a stop"}
        what = told.get(self.shape, f"an {self.kind}" if self.kind == "effort" else "a reading")
        along = " and ".join(map(_spoken, self.of, self.units, [self.place] * len(self.of)))
        where = f"{what} {'at' if self.kind == 'effort' else 'of'} {named(self.place)}"
        said = f"{where} that depends on {along}" if self.shape in ("table", "mesh") else where
        return f"{said}: {self.form}" if self.form else said

    @property
    def curve(self) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
        """Places and values along the first variable, where that is all there is to draw.

        Of a dry friction of position the values are those at positive speed.
        """
        if self.shape == "mesh" and self.form == RUBS:
            return self.knots[0], self.values[len(self.knots[1]) - 1 :: len(self.knots[1])]
        return (self.knots[0], self.values) if self.shape == "table" else None

    @property
    def refusal(self) -> str:
        """Why a machine with it is only a candidate; empty where it passed on held-out data."""
        return "" if self.gain is not None else "there were no held-out recordings to prove it on"


def named(place: str) -> str:
    """A place as a person says it: two joints together, or against one another."""
    joints = joints_of(place)
    if len(joints) == 1:
        return place
    (one, _), (two, sign) = joints
    return f"{one} and {two}{' together' if sign > 0.0 else ', against one another,'}"


def _spoken(variable: str, unit: str, place: str) -> str:
    """A variable as a person says it."""
    what, _, name = variable.partition("@")
    if what == "time":
        return "time"
    name, _, width = name.partition(WITHIN)
    if width:
        return f"where {name} stands within a play of {width} {unit}"
    joints = joints_of(name)
    if len(joints) == 2:
        return f"the {'sum' if joints[1][1] > 0.0 else 'difference'} of their {what}s"
    return f"its {what}" if name == place or place.startswith(name) else f"{what} of {name}"
