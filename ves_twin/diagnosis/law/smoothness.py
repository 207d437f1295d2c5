"""smoothest: size and length of a law's smooth prior by evidence, in a linearisation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.law.candidate import Candidate

SIZES = np.geomspace(0.003, 30.0, 11)
"""Sizes that a law is tried with, in expected ones."""


@dataclass(frozen=True)
class Smoothness:
    """Of a prior c ~ N(0, size^2 K).

    Attributes:
        size: [unit of the law].
        length: number of its kernel among those of the family.
        gain: log evidence over no law [nats].
    """

    size: float
    length: int
    gain: float


def smoothest(
    law: FloatArray, others: FloatArray, z: FloatArray, temper: float, candidate: Candidate
) -> Smoothness:
    """The size and the length of largest evidence.

    With the nuisances marginalised by P = (I + N N')^-1, G = Z'PZ and b = Z'Pz:
    log E = b'(G + (s^2 K)^-1)^-1 b / 2 - log|I + s^2 K G| / 2.

    Args:
        law: whitened columns Z of the law's numbers (samples, k).
        others: whitened columns N of what has a unit prior (samples, m).
        z: whitened residual without law and nuisances (samples,).
        temper: weight of the priors: chi^2 a sample.
        candidate: the family.
    """
    return best_of(*projected(law, others, z, temper), candidate)


def projected(
    law: FloatArray, others: FloatArray, z: FloatArray, temper: float
) -> tuple[FloatArray, FloatArray]:
    """G and b of columns with the nuisances marginalised."""
    factor = cho_factor(others.T @ others + temper * np.eye(others.shape[1]))
    left = law - others @ cho_solve(factor, others.T @ law)
    return np.asarray(law.T @ left / temper), np.asarray(left.T @ z / temper)


def best_of(gram: FloatArray, slope: FloatArray, candidate: Candidate) -> Smoothness:
    """From G and b."""
    best = Smoothness(0.0, 0, -np.inf)
    for number, kernel in enumerate(candidate.kernels):
        root = np.linalg.cholesky(kernel)
        values, vectors = np.linalg.eigh(root.T @ gram @ root)
        squares = np.square(vectors.T @ (root.T @ slope))
        values = np.maximum(values, 0.0)
        for size in SIZES * candidate.place.scale:
            weight = 1.0 + size**2 * values
            gain = 0.5 * float(np.sum(size**2 * squares / weight) - np.sum(np.log(weight)))
            if gain > best.gain:
                best = Smoothness(float(size), number, gain)
    return best
