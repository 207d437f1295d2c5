"""Screen: rank the hypotheses by what the best scaled signature would explain."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.diagnosis.bank.inner import inner
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.bank.prewhitened import Prewhitened
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary
from ves_twin.diagnosis.record.whitening import Whitening

AMPLITUDE = (0.35, 2.8)
"""How far a signature may be scaled: beyond, the size next to it in the bank is nearer."""


@dataclass(frozen=True)
class Candidate:
    """A hypothesis as the screen sees it.

    Attributes:
        hypothesis: number in the bank's library.
        score: chi^2 that its best scaled signature takes away.
        sizes: the departure that does.
    """

    hypothesis: int
    score: float
    sizes: FloatArray


@dataclass(frozen=True)
class Screen:
    """The bank as one record's noise and nuisances see it.

    Attributes:
        bank: the signatures.
        whitening: of this record.
        extra: whitened directions that are free besides the nuisances (samples, k): the
            parameters of a cause that is fitted already.
        shaped: the bank before this record's colour and level; made here if None.
    """

    bank: SignatureLibrary
    whitening: Whitening
    extra: FloatArray | None = None
    shaped: Prewhitened | None = None

    @cached_property
    def _shaped(self) -> Prewhitened:
        return self.shaped or Prewhitened(self.bank, self.whitening)

    @cached_property
    def metric(self) -> Metric:
        """Nuisances of the bank's base, and the extra directions with no prior to speak of."""
        columns = self._shaped.columns(self.whitening)
        if self.extra is not None:
            norm = np.linalg.norm(self.extra, axis=0)
            columns = np.concatenate([columns, 1e3 * self.extra / np.maximum(norm, 1e-9)], axis=1)
        return Metric(columns)

    @cached_property
    def _kinds(self) -> tuple[IntArray, IntArray]:
        """Shapes that entries have, by the bank's numbers, and which of them each has."""
        used, place = np.unique(self.bank.shape, return_inverse=True)
        return used, place

    @cached_property
    def _shapes(self) -> FloatArray:
        """Those, whitened (samples, shapes): columns of the base, then the bent ones."""
        used, count = self._kinds[0], len(self.bank.base.columns)
        columns = self.metric.columns[:, used[used < count]]
        bent = self._shaped.bent(self.whitening)[:, used[used >= count] - count]
        return np.concatenate([columns, bent], axis=1)

    def shape(self, entry: int) -> FloatArray:
        """Whitened shape of an entry (samples,); its factor makes it the signature."""
        return np.asarray(self._shapes[:, self._kinds[1][entry]])

    @cached_property
    def _reduced(self) -> FloatArray:
        """What the nuisances can explain of the shapes, in coordinates of their own (k, shapes)."""
        return self.metric.reduced(self._shapes)

    @cached_property
    def gram(self) -> FloatArray:
        """<s_j, s_k> (entries, entries)."""
        gram = inner(self._shapes, self._shapes) - self._reduced.T @ self._reduced
        which, factor = self._kinds[1], self.bank.factor
        return np.asarray(gram[np.ix_(which, which)] * np.outer(factor, factor))

    def match(self, z: FloatArray) -> FloatArray:
        """<s_k, z> of each entry with a whitened residual (samples,)."""
        along = self._shapes.T @ self.metric.project(z)
        return np.asarray(along[self._kinds[1]] * self.bank.factor)

    @cached_property
    def power(self) -> FloatArray:
        """d^2 of each entry: its size in sigma, squared."""
        power = np.sum(self._shapes**2, axis=0) - np.sum(self._reduced**2, axis=0)
        return np.asarray(np.maximum(power[self._kinds[1]] * self.bank.factor**2, 1e-12))

    def suspects(self, z: FloatArray) -> list[Candidate]:
        """Every hypothesis at its best size, by falling score.

        The score is max over a of 2 a <s, z> - a^2 <s, s>, a within AMPLITUDE.

        Args:
            z: whitened residual about the bank's base (samples,).
        """
        match = self.match(z)
        amplitude = np.clip(match / self.power, *AMPLITUDE)
        score = 2.0 * amplitude * match - amplitude**2 * self.power
        best = []
        for h in range(len(self.bank.hypotheses)):
            rows = self.bank.entries(h)
            if len(rows):
                k = int(rows[np.argmax(score[rows])])
                sizes = amplitude[k] * self.bank.sizes[k]
                best.append(Candidate(h, float(score[k]), sizes))
        return sorted(best, key=lambda suspect: -suspect.score)

    def pairs(
        self, z: FloatArray, count: int, amplitude: tuple[float, float] = AMPLITUDE
    ) -> list[tuple[Candidate, Candidate]]:
        """The best pairs of hypotheses, by closed-form fit of every two signatures.

        Args:
            z: whitened residual about the bank's base.
            count: how many pairs, each pair of hypotheses once.
            amplitude: how far each signature may be scaled.
        """
        match, g = self.match(z), self.gram
        p = self.power
        det = p[:, None] * p - g**2
        det = np.where(det < 1e-3 * p[:, None] * p, np.inf, det)
        a = (p * match[:, None] - g * match) / det
        score = a * match[:, None] + a.T * match
        low, high = amplitude
        bad = (a < low) | (a > high) | (self.bank.owner[:, None] == self.bank.owner)
        score = np.triu(np.where(bad | bad.T, -np.inf, score), 1)
        found: dict[tuple[int, int], tuple[Candidate, Candidate]] = {}
        for flat in np.argsort(-score, axis=None):
            i, j = divmod(int(flat), len(p))
            if score[i, j] <= 0.0 or len(found) == count:
                break
            key = (int(self.bank.owner[i]), int(self.bank.owner[j]))
            if key not in found:
                first = Candidate(key[0], float(score[i, j]), a[i, j] * self.bank.sizes[i])
                second = Candidate(key[1], float(score[i, j]), a[j, i] * self.bank.sizes[j])
                found[key] = (first, second)
        return list(found.values())
