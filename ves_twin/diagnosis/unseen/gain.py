"""Gain: what an extension takes away on recordings that it has not seen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

WORSE = 1.5
"""Growth of a channel's error that no other makes up for, and that a forecast is never forgiven."""

WORSE_IN_ALL = 1.25
"""Mean growth (geometric) of all channels' errors from which on nothing is gained. A law of a
measured pendulum took 70 % of z^2 away, and left 32 % more N m; of blind pendulums right causes
left up to 13 % more, as starts and offsets of each recording are not tuned there."""

GROWN = 0.01
"""Growth of a channel's rms error that counts: less is told by no record of minutes."""

FALLS = 0.9
"""Bare error that is left, in the mean of all channels, from which what is proved one by one is
accepted: z^2 counts fast errors most where slow ones are what a model gets wrong (TIAGo's
arm: 29 to 71 % less at every joint, and 16 % more of z^2)."""

BENT_AWAY = 1.5
"""Times the held-out error of the model as given, in the mean of all channels or in one, from which
a tuned one is no model of the machine any more: 2.0 where a crane's main cause was missing, 1.5 at
the position of a servo whose speed it predicted better. What tolerances mimic of a small fault
makes less, and each recording draws some of them anew."""


@dataclass(frozen=True)
class Gain:
    """Share of the excess error that an extension takes away on held-out recordings.

    Attributes:
        share: (before - after) / (before - floor), the floor of mean z^2 being 1, or less where
            channels are quieter than declared by more than their level may follow; None where
            the nominal model has no excess to take away.
        low, high: interval over stretches of time.
        before, after: mean z^2 of the nominal and of the extended model, each with its
            commissioning errors tuned on the first recordings.
        without: mean z^2 of the extended model with the causes taken out again, all else as tuned;
            None if nobody asked.
        given: rms error of each channel [its unit] by the model as it was given, nothing tuned.
        errors: rms error of each channel [its unit] by the nominal and by the extended model, as
            tuned on the first recordings and nothing tuned here.
    """

    share: float | None
    low: float | None
    high: float | None
    before: float
    after: float
    errors: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    without: float | None = None
    given: Mapping[str, float] = field(default_factory=dict)

    @property
    def lost(self) -> bool:
        """Whether no channel is predicted better than by the model as it was given.

        Of two swinging arms with a wrong mass a spring took 6 % from what tuning had left, and left
        both worse than their owner's own model.
        """
        pairs = [(after, self.given.get(name, 0.0)) for name, (_, after) in self.errors.items()]
        return bool(pairs) and all(after >= given > 0.0 for after, given in pairs)

    @property
    def over(self) -> Mapping[str, tuple[float, float]]:
        """The errors, over the model as it was given where its tuning predicts far worse.

        In all channels together, or in one of them. Tolerances that are bent for a missing cause
        may fit hardly anything: a crane's trolley was off by 0.18 m as given, by 0.54 m tuned, and
        a gain over that says nothing.
        """
        given = [self.given.get(name, 0.0) for name in self.errors]
        tuned = [before for before, _ in self.errors.values()]
        if not tuned or not all(np.isfinite(x) and x > 0.0 for x in (*given, *tuned)):
            return self.errors
        worse = np.log(tuned) - np.log(given)
        bent = (worse >= np.log(BENT_AWAY)) | (np.mean(worse) >= np.log(BENT_AWAY))
        if not np.any(bent):
            return self.errors
        bases = np.where(bent, np.minimum(given, tuned), tuned).tolist()
        pairs = zip(self.errors.items(), bases, strict=True)
        return {name: (base, after) for (name, (_, after)), base in pairs}

    @property
    def told(self) -> Mapping[str, tuple[float, float]]:
        """The errors over the better of both models that there are without an extension.

        In each channel: by the model as it was given, which is what its owner has, or as tuned.
        """
        found = {}
        for name, (tuned, after) in self.over.items():
            given = self.given.get(name, 0.0)
            found[name] = (min(given, tuned) if given > 0.0 else tuned, after)
        return found

    @property
    def passed(self) -> bool:
        """The gate for writing an extended plant: the whole interval is a gain, by the causes.

        Bare errors must not say otherwise (`grown`). Where a fault was repaired meanwhile,
        commissioning errors that were bent to mimic it do worse than the fault's own model, and
        that one worse than the same without the fault.
        """
        return self.low is not None and self.low > 0.0 and self.by_causes and not self.grown

    @property
    def grown(self) -> bool:
        """Whether bare errors grow: all together, as a product, and one channel's by half.

        Or the mean of all by WORSE_IN_ALL. What is carried over, and what each recording begins
        with, may be so uncertain that z^2 forgives much: a pendulum's errors grew by 46 and 94 %
        beside a gain of 50 % in z^2.
        """
        ratios = [after / before for before, after in self.over.values() if before > 0.0]
        if not ratios:
            return False
        mean = float(np.exp(np.mean(np.log(np.maximum(ratios, 1e-300)))))
        return mean > WORSE_IN_ALL or (mean > 1.0 and max(ratios) > WORSE)

    @property
    def fallen(self) -> bool:
        """Whether the bare error of every channel falls or stays, and a tenth goes in the mean."""
        ratios = [after / before for before, after in self.over.values() if before > 0.0]
        return bool(ratios) and max(ratios) <= 1.0 and float(np.mean(ratios)) < FALLS

    @property
    def by_causes(self) -> bool:
        """Whether the same model without the causes does worse."""
        return self.without is None or self.after < self.without

    @property
    def unconfirmed(self) -> bool:
        """Whether the held-out recordings speak against the causes.

        Where they show no excess that could be gained, a cause that is there still predicts them
        better, by d^2 of its own loudness there, and one that was fitted to noise as much worse.
        """
        return self.after > self.before if self.share is None else not self.passed

    @property
    def worse(self) -> tuple[str, ...]:
        """Channels that the extended model predicts worse than the model without the extension."""
        limit = 1.0 + GROWN
        return tuple(n for n, (before, after) in self.over.items() if after > limit * before)

    @property
    def carries_on(self) -> bool:
        """The gate for a forecast: a gain, and no channel's bare error grows by half.

        A drift carried on is so uncertain that z^2 alone would forgive it.
        """
        grown = any(after > WORSE * before for before, after in self.over.values())
        return self.passed and not grown
