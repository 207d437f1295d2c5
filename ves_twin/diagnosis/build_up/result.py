"""BuildUp: what held-out data prove of an extension, as it stands in verdict.json."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

TOGETHER = " + "
"""Between names of causes that only together do what another one does."""


UNFINISHED = "a full fit of what is proved"
"""What is left out where the time ends within it."""


@dataclass(frozen=True)
class Size:
    """A parameter's value and interval, and what the model has; the interval counts model error."""

    value: float
    low: float
    high: float
    unit: str
    nominal: float


SUBLINEAR = frozenset({"stribeck_friction", "quadratic_drag"})
"""Kinds that no machine has less of than none: friction that grows less than in proportion to
speed, as of grease, reads so (two measured arms, TX40 and TIAGo)."""

IMPROPER = SUBLINEAR | {"coulomb_asymmetry", "viscous_asymmetry"}
"""Kinds that are a part of some other friction, and drive their joint where that is too small."""

STRAIGHT = frozenset({"viscous_friction", "coulomb_friction"})
"""Kinds that share such a friction among them where it has no kind of its own."""


def is_sublinear(effect: str, sizes: Sequence[float]) -> bool:
    """Whether a cause is one of SUBLINEAR with a negative first size."""
    return effect in SUBLINEAR and len(sizes) > 0 and sizes[0] < 0.0


@dataclass(frozen=True)
class Beyond:
    """A cause that does as well in the place of a proved one, at sizes beyond its range.

    Attributes:
        label: effect@target.
        parameters: size of each, its range as `low` and `high`.
    """

    label: str
    parameters: Mapping[str, Size]


@dataclass(frozen=True)
class Proved:
    """One extension that is proved to predict better.

    Attributes:
        effect, target: what and where.
        parameters: size of each.
        p: probability of its held-out improvement where there is none, one-sided, all other
            extensions beside it.
        blocks: stretches of time that the improvement was compared on.
        takes: rms error of each channel on held-out data without and with it, of the channels
            where it acts.
        firm: whether the name is the mechanism: no other cause and no few others together do as
            well in its place, it is known apart from the others, what is left shows no law of the
            same motion, and no commissioning error explains it.
        acts_like: causes that do as well in its place on held-out data; or the few, with TOGETHER
            between, whose columns together are its own.
        ended: whether one of its sizes is at an end of its range. The range then says the size: it
            improves the prediction in the place of something else, and is not proved.
        wide: whether an interval alone reaches an end: by itself it is hardly known.
        below_row: whether it is a delay of less than a row of the recordings, which their clock
            explains as well.
        unfollowed: channels where it acts that the extended model still predicts worse than their
            own mean: what makes a simulation out of step smaller improves it.
        spoils: channels where it acts that the extended model predicts worse with it than without.
        rests_on: causes without which its size is less than half. It is not firm where the size of
            one of them ended: a motor that is too strong asked for a heavier wheel.
        bent: whether it is one of STRAIGHT, and one of SUBLINEAR of negative size is proved at its
            place: with it, its size is that of a line through a curve.
        drives: whether the friction of its place would push the joint on with it.
        one_way: whether its joint keeps one direction, and a reversal would tell it from another.
        beyond: causes that would do as well beyond their range, which is assumed: it is not firm.
    """

    effect: str
    target: str
    parameters: Mapping[str, Size]
    p: float
    blocks: int
    takes: Mapping[str, tuple[float, float]]
    firm: bool
    acts_like: tuple[str, ...] = ()
    ended: bool = False
    wide: bool = False
    below_row: bool = False
    unfollowed: tuple[str, ...] = ()
    spoils: tuple[str, ...] = ()
    rests_on: tuple[str, ...] = ()
    bent: bool = False
    drives: bool = False
    one_way: bool = False
    beyond: tuple[Beyond, ...] = ()

    @property
    def label(self) -> str:
        """effect@target."""
        return f"{self.effect}@{self.target}"

    @property
    def share(self) -> float:
        """Largest share that it takes of a channel's rms error on the held-out half."""
        return max(
            (1.0 - after / before for before, after in self.takes.values() if before), default=0.0
        )

    @property
    def sublinear(self) -> bool:
        """Whether it is the shape of another friction."""
        return is_sublinear(self.effect, [size.value for size in self.parameters.values()])

    @property
    def standing_in(self) -> str:
        """What a cause that would drive its joint may be instead; empty if it may be itself."""
        none = IMPROPER | STRAIGHT if self.sublinear else IMPROPER
        other = (n for n in self.acts_like if n.partition("@")[0] not in none)
        return next(other, "") if self.drives else ""

    def beside(self, others: Iterable[Proved]) -> Proved:
        """Itself as firm as the others leave it.

        Not where it is a friction beside which one shows that it is sublinear, nor where it rests
        on one whose size ended.
        """
        others = list(others)
        out = {o.label for o in others if o.ended}
        rests = tuple(name for name in self.rests_on if name in out)
        beside = [o for o in others if o.target == self.target and o.sublinear]
        known = any(next(iter(o.parameters.values())).high < 0.0 for o in beside)
        bent = self.effect in STRAIGHT and known
        firm = self.firm and not (bent or rests)
        return replace(self, rests_on=rests, bent=bent, firm=firm)


@dataclass(frozen=True)
class Left:
    """What stays of a channel on held-out data.

    Attributes:
        rms: of what is left, and of what was there before any extension [unit].
        noise: declared noise on the analysis grid [unit].
        memory: time over which what is left remembers itself [s].
        along: channels that go along with it, with their correlations.
        laws: what a smooth law of a fed-in signal, or of its rate, would still take of the square
            on held-out data; those that pass the false-discovery rate.
    """

    rms: float
    before: float
    unit: str
    noise: float
    memory: float
    along: Mapping[str, float] = field(default_factory=dict)
    laws: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Inseparable:
    """Extensions of which these recordings know only a combination.

    Attributes:
        names: effect@target of each.
        ratio: how much worse the badly known combination is known than the well known one.
    """

    names: tuple[str, ...]
    ratio: float


@dataclass(frozen=True)
class BuildUp:
    """Everything that building up found.

    Attributes:
        proved: extensions, first what takes the largest share of a channel's error.
        tested: how many were put to proof.
        false_discovery_rate: that the proof keeps over those.
        p_limit: largest p that this rate allows those that are proved.
        unproved: those that were put to proof in vain beside them, with their p.
        left: what stays, by channel.
        inseparable: combinations of which only one is known.
    """

    proved: tuple[Proved, ...]
    tested: int
    false_discovery_rate: float
    p_limit: float
    unproved: Mapping[str, float]
    left: Mapping[str, Left]
    inseparable: tuple[Inseparable, ...] = ()
