"""probabilities: how sure one cause is against its rivals, given the library."""

from __future__ import annotations

import numpy as np

from ves_twin.diagnosis.fit.refine import Fit


def probabilities(fits: list[Fit], allowance: float, odds: float) -> tuple[list[Fit], list[float]]:
    """The fits that cannot be ruled out, most probable first, with their probabilities.

    The evidence of a fit is exp(-chi^2 / 2) times, for each free parameter, the integral of a
    normal likelihood of its sd over the prior: log-uniform in size between the hypothesis's
    smallest and largest, equal over its signs. Hypotheses are equally probable before the record.
    Differences of chi^2 within what the model may be wrong by count as none.

    Args:
        fits: rivals, of equal numbers of causes.
        allowance: chi^2 that the model's own error is worth.
        odds: a fit less probable than the best by more than this is dropped.
    """
    least = min(fit.chi2 for fit in fits)
    logs = np.array([-0.5 * max(fit.chi2 - least - allowance, 0.0) + _occam(fit) for fit in fits])
    # among equals within the allowance the smaller chi^2 goes first
    order = sorted(range(len(fits)), key=lambda i: (-round(float(logs[i]), 1), fits[i].chi2))
    kept = [i for i in order if logs[i] > logs[order[0]] - np.log(odds)]
    weights = np.exp(logs[kept] - logs[kept[0]])
    return [fits[i] for i in kept], [float(w) for w in weights / np.sum(weights)]


def _occam(fit: Fit) -> float:
    """Ln of the integral of prior times likelihood, relative to its peak, parameter by parameter.

    Where the record hardly shows a size the prior's 1 / size is no constant beneath the likelihood,
    so the integral is taken on a grid, over the hypothesis's signs and sizes.
    """
    total, n = 0.0, 0
    for cause in fit.causes:
        for smallest, largest in zip(cause.smallest, cause.largest, strict=True):
            size, sd = float(fit.sizes[n]), float(np.sqrt(fit.covariance[n, n]))
            span = np.log(largest / smallest) * len(cause.signs)
            parts = [_integral(sign * size, sd, smallest, largest) for sign in cause.signs]
            total += float(np.log(max(sum(parts) / span, 1e-300)))
            n += 1
    return total


def _integral(size: float, sd: float, smallest: float, largest: float) -> float:
    """Integral of exp(-((x - size) / sd)^2 / 2) / x from the smallest to the largest x."""
    near = np.clip(size + sd * np.linspace(-6.0, 6.0, 241), smallest, largest)
    grid = np.unique(np.concatenate([np.geomspace(smallest, largest, 200), near]))
    return float(np.trapezoid(np.exp(-0.5 * ((grid - size) / sd) ** 2) / grid, grid))
