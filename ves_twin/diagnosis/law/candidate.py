"""Candidate: a family of laws with numbers that a fit finds, and what is believed of them."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.forms import SHARP, TONE, Form
from ves_twin.diagnosis.model.forward import Hypothesis, Parameter
from ves_twin.diagnosis.model.law_forward import STEP, LawPlace, Variable
from ves_twin.effects.law import Law, LawShape

REACH = 1e9
"""Bound of a law's numbers in their priors' sd: none."""

LENGTHS = (0.08, 0.25, 0.8)
"""Correlation lengths of a table's prior, as shares of the range: what knots resolve to a line."""

MESH_LENGTHS = (0.25, 0.6)
"""The same of a mesh, whose knots are further apart."""

DENSE = 201
"""Knots that a closed form is simulated with, beside those where it bends."""

CLOSE = np.array([0.0, 0.1, 0.3, 0.5, 0.6, 1, 1.5, 2, 3, 4, 5, 6.5, 8, 10, 12, 15, 18, 22, 27, 33])
"""Distances of the close ones, in widths of what is sharp."""

A_PERIOD, MOST = 24, 5000
"""Knots in a period of a tone, which are within 0.3 % of a sine; and at most."""

JITTER = 1e-6
"""Added to a prior's diagonal: its inverse is needed."""


@dataclass(frozen=True)
class Candidate(ABC):
    """A law whose numbers are open.

    Attributes:
        place: where it acts.
        of: on what it depends.
    """

    place: LawPlace
    of: tuple[Variable, ...]

    @property
    @abstractmethod
    def start(self) -> FloatArray:
        """Numbers of no law, or where the search begins (k,)."""

    @property
    @abstractmethod
    def sd(self) -> FloatArray:
        """Prior sd of each number about `mean` (k,); of a smooth prior the expected size."""

    @property
    def mean(self) -> FloatArray:
        """Prior mean of each number (k,)."""
        return np.zeros(len(self.sd))

    @property
    def steps(self) -> FloatArray:
        """Finite differences (k,)."""
        return np.asarray(self.place.step * self.sd)

    @property
    def kernels(self) -> tuple[FloatArray, ...]:
        """Correlations (k, k) of a smooth prior, one for each length; () for independent numbers.

        Its size and its length are found by evidence.
        """
        return ()

    @property
    def chosen(self) -> int:
        """Numbers of the family that were chosen by evidence, and cost odds."""
        return 2 if self.kernels else 0

    @abstractmethod
    def law(self, numbers: FloatArray) -> Law:
        """The law that these numbers are."""

    @property
    def label(self) -> str:
        """place(variables): family."""
        return f"{self.place.name}({', '.join(v.name for v in self.of)})"

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Its numbers as those of a plant; nominal is where the search begins."""
        start, reach = self.start, REACH * self.sd
        return tuple(
            Parameter(f"{self.label} #{n + 1}", self.place.unit, x, x - w, x + w)
            for n, (x, w) in enumerate(zip(start.tolist(), reach.tolist(), strict=True))
        )

    @cached_property
    def hypothesis(self) -> Hypothesis:
        """The law as a cause."""
        names = tuple(p.name for p in self.parameters)
        sizes = tuple(self.sd.tolist())
        return Hypothesis("law", self.label, names, sizes, sizes)


@dataclass(frozen=True)
class Curve(Candidate):
    """A curve that is linear between knots (k,) of the first variable, with a smooth prior."""

    knots: tuple[float, ...]

    @property
    def start(self) -> FloatArray:
        """No law."""
        return np.zeros(len(self.knots))

    @property
    def sd(self) -> FloatArray:
        """The expected size."""
        return np.full(len(self.knots), self.place.scale)

    @property
    def kernels(self) -> tuple[FloatArray, ...]:
        """Matern 3/2."""
        return tuple(matern(np.array(self.knots), length) for length in LENGTHS)


@dataclass(frozen=True)
class Table(Curve):
    """The curve itself."""

    def law(self, numbers: FloatArray) -> Law:
        """A table."""
        names = tuple(v.name for v in self.of)
        values = tuple(numbers.tolist())
        return Law(self.place.name, self.place.kind, LawShape.TABLE, names, (self.knots,), values)


@dataclass(frozen=True)
class Mesh(Candidate):
    """Bilinear on a mesh of two variables, with a smooth prior."""

    knots: tuple[tuple[float, ...], tuple[float, ...]]

    @property
    def start(self) -> FloatArray:
        """No law."""
        return np.zeros(len(self.knots[0]) * len(self.knots[1]))

    @property
    def sd(self) -> FloatArray:
        """The expected size."""
        return np.full(len(self.start), self.place.scale)

    @property
    def kernels(self) -> tuple[FloatArray, ...]:
        """Products of Matern 3/2."""
        first, second = np.array(self.knots[0]), np.array(self.knots[1])
        return tuple(
            np.asarray(np.kron(matern(first, length), matern(second, length)))
            for length in MESH_LENGTHS
        )

    def law(self, numbers: FloatArray) -> Law:
        """A mesh."""
        names = tuple(v.name for v in self.of)
        values = tuple(numbers.tolist())
        return Law(self.place.name, self.place.kind, LawShape.MESH, names, self.knots, values)


@dataclass(frozen=True)
class Closed(Candidate):
    """A sum of closed forms, each with a size and inner numbers."""

    forms: tuple[Form, ...]
    inner: tuple[tuple[float, ...], ...]
    span: tuple[float, float]

    @property
    def start(self) -> FloatArray:
        """Sizes zero, inner numbers as given."""
        return np.concatenate([[0.0, *inner] for inner in self.inner])

    @property
    def mean(self) -> FloatArray:
        """The same."""
        return self.start

    @property
    def sd(self) -> FloatArray:
        """Such that a g(x) has the expected size over the range; inner numbers by their form."""
        x, wide = self._points, self.span[1] - self.span[0]
        found: list[float] = []
        for form, inner in zip(self.forms, self.inner, strict=True):
            rms = float(np.sqrt(np.mean(np.square(form.at(x, wide, *inner)))))
            found.append(self.place.scale / max(rms, 1e-9))
            if form.spread:
                found += [share * wide for share in form.spread]
            else:  # a tone, whose scan knows the frequency to a line and the phase to a radian
                found += [2.0 * np.pi / wide, 1.0][: len(inner)]
        return np.array(found)

    @property
    def steps(self) -> FloatArray:
        """Of inner numbers small: a law is not linear in those."""
        sizes = np.concatenate([[True] + [False] * len(inner) for inner in self.inner])
        return np.asarray(np.where(sizes, self.place.step, STEP) * self.sd)

    @property
    def _points(self) -> FloatArray:
        return np.linspace(*self.span, DENSE)

    def law(self, numbers: FloatArray) -> Law:
        """A table of it, dense where it bends."""
        x, k, terms = self._dense(numbers), 0, []
        wide = self.span[1] - self.span[0]
        total = np.zeros_like(x)
        for form, inner in zip(self.forms, self.inner, strict=True):
            size, own = float(numbers[k]), numbers[k + 1 : k + 1 + len(inner)].tolist()
            total = total + size * form.at(x, wide, *own)
            k += 1 + len(inner)
            terms.append(written(form, size, own))
        names = tuple(v.name for v in self.of)
        table = (tuple(x.tolist()),)
        return Law(
            self.place.name,
            self.place.kind,
            LawShape.TABLE,
            names,
            table,
            tuple(total.tolist()),
            form=" + ".join(terms).replace("+ -", "- "),
        )

    def _dense(self, numbers: FloatArray) -> FloatArray:
        """Even knots, and close ones about zero and about inner places."""
        low, high = self.span
        about, k, dense = [0.0], 0, DENSE
        for form, inner in zip(self.forms, self.inner, strict=True):
            own = numbers[k + 1 : k + 1 + len(inner)].tolist()
            about += own if form.relative else []
            if form is TONE:
                dense = max(dense, int(A_PERIOD * abs(own[0]) * (high - low) / (2.0 * np.pi)))
            k += 1 + len(inner)
        close = SHARP * (high - low) * np.concatenate([-CLOSE[::-1], CLOSE])
        more = np.concatenate([p + close for p in about])
        x = np.unique(np.concatenate([np.linspace(low, high, min(dense, MOST)), more]).round(9))
        return np.asarray(x[(x >= low) & (x <= high)])

    @property
    def label(self) -> str:
        """With its forms."""
        return f"{super().label}: {' + '.join(form.name for form in self.forms)}"


def matern(knots: FloatArray, length: float) -> FloatArray:
    """Matern 3/2 correlations (k, k); the length is a share of the range."""
    x = (knots - knots[0]) / (knots[-1] - knots[0])
    far = np.abs(x[:, None] - x[None]) / length * np.sqrt(3.0)
    return np.asarray((1.0 + far) * np.exp(-far) + JITTER * np.eye(len(knots)))


def written(form: Form, size: float, inner: list[float]) -> str:
    """One term as a formula with its numbers."""
    text = form.formula
    for letter, value in zip("pq", inner, strict=False):
        text = re.sub(rf"\b{letter}\b", f"{value:.4g}", text)
    text = text.replace("- -", "+ ").replace("+ -", "- ")
    return f"{size:.4g}" if form.formula == "1" else f"{size:.4g} {text}"
