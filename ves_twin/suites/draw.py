"""draw_truths: what the cases of a suite hide, spread over causes and over sizes in sigma."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.linearise import Linearisation
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.fit.detectability import detectability
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.whitening import Whitening
from ves_twin.suites.machine import BlindMachine
from ves_twin.suites.truth import Hidden, HiddenCause, Truth

DETECTABILITY = (6.0, 40.0)
"""Sizes in sigma that single causes are drawn from, log-uniform; none is fainter in the end."""

PAIR_DETECTABILITY = (10.0, 40.0)
"""The same for each of two."""

MANY, MANY_DETECTABILITY = (6, 12), (6.0, 60.0)
"""Causes of a case that hides many, and the size of each in sigma of noise and model error."""

ATTEMPTS = 60
"""Causes that are tried before a size in sigma is given up."""

SECANTS = 4
"""Runs at most to find the size of a cause with the d that is asked for."""


@dataclass(frozen=True)
class Detectability:
    """Size in sigma of departures at nominal: d^2 = <s, s>, nuisances marginalised.

    Attributes:
        base: nuisance columns of the programme.
        whitening: noise as declared, or with the error of the model.
    """

    base: Linearisation
    whitening: Whitening

    @property
    def levels(self) -> FloatArray:
        """Rms of each column where nothing departs (c,)."""
        return np.asarray(np.sqrt(np.mean(np.square(self.base.prediction, dtype=float), axis=0)))

    def share(self, cause: HiddenCause) -> float:
        """Rms of what a cause changes, of that of the column where it is largest."""
        change = self.base.runs.one(self.shift(cause)) - self.base.prediction
        return float(np.max(np.sqrt(np.mean(np.square(change, dtype=float), axis=0)) / self.levels))

    def shift(self, cause: HiddenCause) -> FloatArray:
        """Departures of a cause (coordinates,)."""
        runs = self.base.runs
        shift = runs.origin
        for i, axis in enumerate(runs.coordinates):
            shift[i] += cause.departures.get(axis.parameter.name, 0.0)
        return shift

    def linear(self, shift: FloatArray) -> float:
        """D by the columns at nominal: one run; inf where the machine fails at that size."""
        change = self.base.runs.one(shift) - self.base.prediction
        signature = self.whitening.apply(change)
        if not np.all(np.isfinite(signature)):
            return float("inf")
        return float(np.sqrt(max(float(signature @ self.metric.project(signature)), 0.0)))

    def full(self, shift: FloatArray) -> float:
        """D with the commissioning errors fitted by the full forward."""
        return detectability(self.base, self.whitening, shift, rounds=0)

    @cached_property
    def metric(self) -> Metric:
        """Inner product of whitened signals, commissioning errors taken out."""
        return Metric(self.whitening.apply(self.base.columns).T)


def draw_truths(
    machine: BlindMachine,
    counts: Mapping[Hidden, int],
    detectability: Detectability,
    rng: np.random.Generator,
    spread: float,
    progress: Callable[[float, str], None],
) -> list[Truth]:
    """What each case hides, in random order; causes with an alias only as confusable ones.

    Args:
        machine: the machine.
        counts: how many of each sort.
        detectability: of departures.
        rng: of all draws.
        spread: commissioning errors, in declared sd.
        progress: told how far it is.

    Raises:
        InvalidInputError: a machine without causes of that sort.
    """
    sorts = [sort for sort, count in counts.items() for _ in range(count)]
    rng.shuffle(sorts)
    library = machine.forward.hypotheses
    clear = [h for h in library if h.label not in machine.confusable]
    truths = []
    for n, sort in enumerate(sorts):
        progress(n / len(sorts), "sizes in sigma")
        case = f"case-{n + 1:04d}"
        causes: tuple[HiddenCause, ...] = ()
        kind, size = "", 0.0
        match Hidden(sort):
            case Hidden.SINGLE:
                causes = (_cause(clear, detectability, DETECTABILITY, rng),)
            case Hidden.CONFUSABLE:
                group = [h for h in library if h.label in machine.confusable]
                causes = (_cause(group, detectability, DETECTABILITY, rng),)
            case Hidden.PAIR:
                first = _cause(clear, detectability, PAIR_DETECTABILITY, rng)
                rest = [h for h in clear if h.effect != first.effect]
                causes = (first, _cause(rest, detectability, PAIR_DETECTABILITY, rng))
            case Hidden.MANY:
                causes = _many(clear, detectability, rng)
            case Hidden.EDITED:
                kind, size, causes = _edited(machine, detectability, rng)
            case Hidden.OUTSIDE if rng.random() < 0.25:  # leave one out
                causes = (_cause(library, detectability, PAIR_DETECTABILITY, rng),)
            case Hidden.OUTSIDE:
                kind = str(rng.choice(sorted(machine.outside)))
                size = _log_uniform(*machine.outside[kind], rng)
        truths.append(Truth(case, Hidden(sort), causes, kind, size, spread))
    return truths


def _edited(
    machine: BlindMachine, detectability: Detectability, rng: np.random.Generator
) -> tuple[str, float, tuple[HiddenCause, ...]]:
    if not machine.edits:
        raise InvalidInputError("edits to hide", "none", "a machine that is edited")
    kind = str(rng.choice(sorted(machine.edits)))
    edit = machine.edits[kind]
    size = _log_uniform(edit.low, edit.high, rng)
    runs, (label, _, _) = detectability.base.runs, edit.parameter.partition(":")
    names = [axis.parameter.name for axis in runs.coordinates]
    shift = runs.depart(runs.origin, np.array([names.index(edit.parameter)]), np.array([size]))
    effect, _, target = label.partition("@")
    d = detectability.linear(shift)
    return kind, size, (HiddenCause(effect, target, {edit.parameter: size}, d),)


def _many(
    library: Sequence[Hypothesis], detectability: Detectability, rng: np.random.Generator
) -> tuple[HiddenCause, ...]:
    """Different causes, each sized by itself."""
    found: dict[str, HiddenCause] = {}
    for _ in range(int(rng.integers(MANY[0], MANY[1] + 1))):
        rest = [h for h in library if h.label not in found]
        cause = _cause(rest, detectability, MANY_DETECTABILITY, rng)
        found[cause.label] = replace(cause, share=detectability.share(cause))
    return tuple(found.values())


def _cause(
    library: Sequence[Hypothesis],
    detectability: Detectability,
    limits: tuple[float, float],
    rng: np.random.Generator,
) -> HiddenCause:
    if not library:
        raise InvalidInputError("causes to hide", "none", "some of the machine's library")
    for _ in range(ATTEMPTS):
        hypothesis = library[int(rng.integers(len(library)))]
        wanted = _log_uniform(*limits, rng)
        found = _at_detectability(hypothesis, wanted, detectability, rng)
        if found is not None and found.d >= limits[0]:  # commissioning errors, fitted, take some
            return found
    raise InvalidInputError("causes to hide", "all too faint", f"one that reaches d = {limits[0]}")


def _at_detectability(
    hypothesis: Hypothesis, wanted: float, detectability: Detectability, rng: np.random.Generator
) -> HiddenCause | None:
    """The cause at the size whose d is within a tenth of what is wanted; None if out of range."""
    runs = detectability.base.runs
    where = runs.indices(hypothesis)
    low, high = np.array(hypothesis.smallest), np.array(hypothesis.largest)
    sign = rng.choice(hypothesis.signs)
    share = rng.uniform(0.2, 1.0, len(where)) if len(where) > 1 else np.ones(1)
    size = float(np.sqrt(low[0] * high[0]) / high[0])  # of the largest
    for _ in range(SECANTS):
        shift = runs.depart(runs.origin, where, sign * size * share * high)
        d = detectability.linear(shift)
        if abs(np.log(max(d, 1e-6) / wanted)) < 0.1:
            break
        size *= float(np.clip(wanted / max(d, 1e-6), 0.05, 20.0))
        if size > 1.0 or size * high[0] < low[0]:
            return None
    shift = runs.depart(runs.origin, where, sign * size * share * high)
    if not np.isfinite(d):
        return None
    names = hypothesis.parameters
    departures = {name: float(shift[i]) for name, i in zip(names, where, strict=True)}
    return HiddenCause(hypothesis.effect, hypothesis.target, departures, detectability.full(shift))


def _log_uniform(low: float, high: float, rng: np.random.Generator) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
