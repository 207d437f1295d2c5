"""Trial: one way in which a cause may act, and trials_at: all of them about a point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.bank.rungs import rungs
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.runs import Progress, Runs, silent

STRAIGHT = 0.01
"""Relative change of a column between two sizes up to which a cause counts as linear: a tenth of
the errors of size that model error leaves on any of the measured machines."""

REACH = 0.8
"""Share of its largest size at which a linear cause's column is computed."""

SMALL = 0.04
"""Share of its largest size at which that column is checked."""


@dataclass(frozen=True)
class Trial:
    """A cause at sizes up to a factor: columns that are added with free amplitudes.

    Attributes:
        cause: of the library.
        sizes: departures of its parameters at amplitude one (p,).
        wide: whether each parameter has a column of its own; else one column for all together.
        positive: whether only positive amplitudes are physical.
        bent: whether its column holds near its sizes alone.
    """

    cause: Hypothesis
    sizes: tuple[float, ...]
    wide: bool = False
    positive: bool = False
    bent: bool = False

    @property
    def width(self) -> int:
        """Columns."""
        return len(self.sizes) if self.wide else 1

    @property
    def points(self) -> list[tuple[float, ...]]:
        """Departures of its parameters, one for each column."""
        if not self.wide:
            return [self.sizes]
        return [tuple(row) for row in np.diag(self.sizes)]

    def departures(self, amplitudes: FloatArray) -> FloatArray:
        """Departures of its parameters at amplitudes (width,)."""
        return np.asarray(np.array(self.sizes) * amplitudes)


@dataclass(frozen=True)
class Library:
    """Causes, and what an earlier look at them told.

    Attributes:
        causes: all of them.
        bent: labels of those that were not linear: every size has a column of its own.
        straight: labels of those that were: one run tells each column, unless a bent one is at
            work there, which may bend them.
        fewer: whether bent ones have the middle or the ends of their sizes alone, where runs are
            dear.
    """

    causes: Sequence[Hypothesis]
    bent: frozenset[str] = frozenset()
    straight: frozenset[str] = frozenset()
    fewer: bool = False

    @staticmethod
    def after(causes: Sequence[Hypothesis], trials: Sequence[Trial], fewer: bool) -> Library:
        """What trials about a point with nothing at work tell of a library."""
        bent = frozenset(trial.cause.label for trial in trials if trial.bent)
        straight = frozenset(trial.cause.label for trial in trials if not trial.bent)
        return Library(causes, bent, straight, fewer)

    def sizes(self, cause: Hypothesis) -> FloatArray:
        """Departures at which a bent cause is simulated (m, parameters)."""
        if not self.fewer:
            return cause.departures()
        crowd = sum(other.kind == cause.kind for other in self.causes)
        return rungs(cause, crowd)[0]


def columns_of(
    runs: Runs,
    point: FloatArray,
    trials: Sequence[Trial],
    progress: Progress = silent,
    known: SingleArray | None = None,
) -> list[SingleArray]:
    """What each trial adds to the channels about a point: (width, rows, c) each.

    A cause that has departures at the point is taken out first: its column runs from absent to
    present, so that the same trial stands for it before and after it is fitted.

    Args:
        runs: of the recordings.
        point: departures (coordinates,).
        trials: whose columns are computed.
        progress: told how far it is.
        known: channels at the point (rows, c), where they are known already.
    """
    shifts: dict[bytes, FloatArray] = {}

    def place(shift: FloatArray) -> bytes:
        key = shift.tobytes()
        shifts.setdefault(key, shift)
        return key

    pairs = []
    for trial in trials:
        where = runs.indices(trial.cause)
        without = runs.depart(point, where, np.zeros(len(where)))
        ends = [runs.depart(point, where, np.array(sizes)) for sizes in trial.points]
        pairs.append([(place(there), place(without)) for there in ends])
    stacks = {} if known is None else {point.tobytes(): known}
    asked = [key for key in shifts if key not in stacks]
    rows = runs.many([shifts[key] for key in asked], progress, "what each cause would change")
    stacks |= dict(zip(asked, rows, strict=True))
    return [np.stack([stacks[a] - stacks[b] for a, b in ends]) for ends in pairs]


def trials_at(
    runs: Runs,
    point: FloatArray,
    library: Library | Sequence[Hypothesis],
    present: Sequence[Trial] = (),
    progress: Progress = silent,
) -> tuple[list[Trial], list[SingleArray]]:
    """Every way each cause may act about a point, with its columns.

    A cause whose columns at two sizes are proportional has one trial; one whose parameters add up
    has a column for each; any other has a trial for each of its bank sizes.

    Args:
        runs: of the recordings.
        point: departures (coordinates,).
        library: the causes; what an earlier look told of them is not probed again.
        present: trials that are fitted at the point: kept as they are.
        progress: told how far it is.
    """
    library = library if isinstance(library, Library) else Library(library)
    new = [cause for cause in library.causes if cause.label not in library.bent]
    straight = library.straight
    if any(trial.cause.label in library.bent for trial in present):
        straight = frozenset()
    known = [cause.label in straight for cause in new]
    looked = [_probes(runs, c)[: 1 if told else 3] for c, told in zip(new, known, strict=True)]
    columns = columns_of(runs, point, [one for some in looked for one in some], progress)
    here = {trial.cause.label for trial in present}
    rounding = np.finfo(np.float32).eps * np.linalg.norm(runs.one(point), axis=0)
    trials: list[Trial] = []
    found: list[SingleArray] = []
    curved = [cause for cause in library.causes if cause.label in library.bent]
    for cause, told, probes in zip(new, known, looked, strict=True):
        shown, columns = columns[: len(probes)], columns[len(probes) :]
        linear = told or (not cause.starts and _is_linear(probes, shown, rounding))
        if linear and cause.label not in here:
            trials.append(probes[0])
            found.append(shown[0])
        elif not linear:
            curved.append(cause)
    sizes = [(cause, _within(runs, cause, row)) for cause in curved for row in library.sizes(cause)]
    bank = [Trial(cause, row, positive=True, bent=True) for cause, row in sizes]
    rest = list(dict.fromkeys([*bank, *present]))
    stacks = [*found, *columns_of(runs, point, rest, progress)]
    every = [*trials, *rest]
    sound = [n for n, stack in enumerate(stacks) if np.all(np.isfinite(stack)) and np.any(stack)]
    return [every[n] for n in sound], [stacks[n] for n in sound]


def _probes(runs: Runs, cause: Hypothesis) -> tuple[Trial, Trial, Trial]:
    """Large, small, and large with all parameters together: whether a cause is linear."""
    sign = 1.0 if 1 in cause.signs else -1.0
    largest = sign * np.array(cause.starts[0] if cause.starts else cause.largest)
    wide, positive = len(largest) > 1 and not cause.starts, len(cause.signs) == 1
    large, small = (_within(runs, cause, share * largest) for share in (REACH, SMALL))
    return (
        Trial(cause, large, wide, positive),
        Trial(cause, small, wide, positive),
        Trial(cause, large, False, positive),
    )


def _within(runs: Runs, cause: Hypothesis, sizes: FloatArray) -> tuple[float, ...]:
    """Sizes within the bounds of the parameters."""
    where = runs.indices(cause)
    return tuple(np.clip(sizes, runs.low[where], runs.high[where]).tolist())


def _is_linear(probes: Sequence[Trial], shown: Sequence[SingleArray], rounding: FloatArray) -> bool:
    """Whether columns follow their sizes, and those of several parameters add up.

    To rounding: of a hand's inertia, 0.5 mN m of torques of 40 N m, columns were bent by that, and
    bent ones have no range: it was proved at 64 times the end of its own.
    """
    (large, small, _), (one, two, joint) = probes, shown
    if not all(np.all(np.isfinite(stack)) for stack in shown) or 0.0 in small.sizes:
        return False
    ratio = np.array(large.sizes) / np.array(small.sizes)
    factor = ratio[:, None, None] if large.wide else ratio[0]
    size = STRAIGHT * float(np.linalg.norm(one))

    def beyond(off: SingleArray, times: float) -> float:
        """What is left of each channel beyond rounding, all of them together."""
        left = np.linalg.norm(off.reshape(-1, off.shape[-1]), axis=0)
        return float(np.linalg.norm(np.maximum(left - times * rounding, 0.0)))

    follows = beyond(one - factor * two, float(np.max(ratio))) <= size
    return follows and beyond(np.sum(one, axis=0) - joint[0], float(len(one))) <= size
