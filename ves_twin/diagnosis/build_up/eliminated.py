"""Eliminated: plain squares of trials, the nuisances at their best whatever is chosen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from ves_twin.core.types import FloatArray


@dataclass(frozen=True)
class Eliminated:
    """Squares that amplitudes t of trials leave of each channel, with nuisances n = b - B t.

    For weights w of channels and a prior p of every amplitude, with the products G_c = X'X,
    g_c = X'y of channel c and H = sum_c w_c G_c + p I,

        b = H_nn^-1 g_n,  B = H_nn^-1 H_nt,
        |y - X (n, t)|^2 = power_c - 2 slope_c't + t'gram_c t.

    Some hundred trials are tried beside each other under one weighting, and the starts of a log in
    many pieces are as many nuisances.

    Attributes:
        weights: w (c,).
        prior: p.
        gram: (c, k, k).
        slope: (c, k).
        power: (c,).
        offset: b (nuisances,).
        back: B (nuisances, k).
        own: p B'B, what nuisances cost (k, k).
        pull: p B'b (k,).
    """

    weights: FloatArray
    prior: float
    gram: FloatArray
    slope: FloatArray
    power: FloatArray
    offset: FloatArray
    back: FloatArray
    own: FloatArray
    pull: FloatArray

    @staticmethod
    def of(
        products: tuple[FloatArray, FloatArray, FloatArray],
        nuisances: int,
        weights: FloatArray,
        prior: float,
    ) -> Eliminated:
        """Eliminate.

        Args:
            products: of each channel G (c, k, k), g (c, k) and y'y (c,), nuisances first.
            nuisances: how many.
            weights: of the squares of each channel (c,).
            prior: weight of the squares of amplitudes.
        """
        gram, cross, power = products
        n = nuisances
        inner = np.tensordot(weights, gram[:, :n, :n], axes=1) + prior * np.eye(n)
        along = np.tensordot(weights, gram[:, :n, n:], axes=1)
        factor = cho_factor(inner)
        offset, back = cho_solve(factor, weights @ cross[:, :n]), cho_solve(factor, along)
        beside = gram[:, :n, :n] @ back  # G_nn B (c, n, k)
        mixed = back.T @ gram[:, :n, n:]
        left = gram[:, n:, n:] - mixed - mixed.transpose(0, 2, 1) + back.T @ beside
        there = cross - gram[:, :, :n] @ offset  # g - G u, u the nuisances alone
        slope = there[:, n:] - there[:, :n] @ back
        quiet = power - (cross[:, :n] + there[:, :n]) @ offset
        own, pull = prior * back.T @ back, prior * back.T @ offset
        return Eliminated(weights, prior, left, slope, quiet, offset, back, own, pull)

    def serves(self, weights: FloatArray, prior: float) -> bool:
        """Whether it was made for these."""
        return prior == self.prior and np.array_equal(weights, self.weights)

    def fit(self, at: np.ndarray, scale: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Amplitudes of nuisances and chosen columns in prior sd, and what is left of each channel.

        Args:
            at: the columns, from 0 behind the nuisances.
            scale: prior sd of each.
        """
        both = np.outer(scale, scale)
        gram, slope = self.gram[:, at[:, None], at] * both, self.slope[:, at] * scale
        hessian = np.tensordot(self.weights, gram, axes=1) + self.own[np.ix_(at, at)] * both
        hessian += self.prior * np.eye(len(at))
        shares = np.linalg.solve(hessian, self.weights @ slope + self.pull[at] * scale)
        left = self.power - 2.0 * slope @ shares + gram @ shares @ shares
        nuisances = self.offset - self.back[:, at] @ (scale * shares)
        return np.concatenate([nuisances, shares]), left
