"""Recipe: what a blind suite is asked to hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.suites.machine import BlindMachine
from ves_twin.suites.truth import Hidden


@dataclass(frozen=True)
class Recipe:
    """Which cases, of which rigs, with what else beside them.

    Attributes:
        machine: a name that `check_machine` knows, or the file of an MJCF machine.
        counts: cases of each sort.
        seed: of everything drawn, and as secret as the key; None for any.
        spread: commissioning errors, in declared sd.
        commissioned: other rigs in order, of the same spread, that are recorded beside the cases.
        background: kinds outside the library that every rig has, with their sizes.
        baseline: whether each rig is recorded before anything is hidden in it, too.
        cut: whether recordings are cut out of a longer motion.
        poor: whether the first recording is one that tells little.
        repaired: whether held-out recordings are of the rig with nothing hidden any more.
        model_error: rms of coloured error that every column of every rig has, of its own.
    """

    machine: str
    counts: Mapping[Hidden, int]
    seed: int | None
    spread: float = 1.0
    commissioned: int = 0
    background: Mapping[str, float] = field(default_factory=dict)
    baseline: bool = False
    cut: bool = False
    poor: bool = False
    repaired: bool = False
    model_error: float = 0.0

    @property
    def programme(self) -> str:
        """Of the first recording of a case."""
        return "poor" if self.poor else "train"

    def rng(self, *part: int) -> np.random.Generator:
        """Draws of one part of the suite.

        Raises:
            InvalidInputError: no seed yet.
        """
        if self.seed is None:
            raise InvalidInputError("seed of a suite", None, "a number (`pinned_recipe` draws one)")
        return np.random.default_rng([self.seed, *part])

    def check(self, machine: BlindMachine) -> None:
        """Refuse what the machine cannot do.

        Raises:
            UnknownNameError: a background that is no kind outside the library.
            InvalidInputError: a size out of range, or a negative number of rigs.
        """
        for kind, size in self.background.items():
            if kind not in machine.outside:
                raise UnknownNameError("kind outside the library", kind, machine.outside)
            if not 0.0 < size <= machine.outside[kind][1]:
                expected = f"above 0 and up to {machine.outside[kind][1]:g}"
                raise InvalidInputError(f"background {kind}", size, expected)
        if self.model_error and not machine.errs:
            expected = "a machine that is fed motion"
            raise InvalidInputError("model error", self.machine, expected)
        if self.commissioned < 0:
            raise InvalidInputError("commissioned rigs", self.commissioned, "0 or more")
        if self.cut and self.baseline:
            raise InvalidInputError("cut", "with a baseline", "one of the two: no cut comes twice")
        if not 0.0 <= self.model_error < 1.0:
            raise InvalidInputError("model error", self.model_error, "0 or more, and below 1")
        if self.counts.get(Hidden.MANY, 0) and not self.model_error:
            raise InvalidInputError("model error", 0, "above 0 where many causes are hidden")
        if not self.spread > 0.0:
            raise InvalidInputError("spread", self.spread, "above 0")
