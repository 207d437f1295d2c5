"""findable_sizes and twins: what a recording could show, before any data."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.screen import Screen

TWINS_FROM = 0.95
"""Cosine of two marginalised signatures above which causes are called twins."""

MARGIN = 0.5
"""Added to the threshold's square root [sigma]: found seven times of ten, by a unit normal."""


def findable_sizes(screen: Screen, threshold: float) -> dict[str, float | None]:
    """Smallest size of each cause that this recording would have shown.

    Its d is the square root of the threshold plus MARGIN, in the less visible of its directions;
    None where even the bank's largest size stays below: nothing can be said about that cause.
    """
    goal = float(np.sqrt(threshold)) + MARGIN
    found: dict[str, float | None] = {}
    for h, hypothesis in enumerate(screen.bank.hypotheses):
        rows = screen.bank.entries(h)
        sizes = np.array([screen.bank.sizes[k][0] for k in rows])
        # strong nuisances bend: no departure shows more than its own commissioning sd lets it
        sd = screen.bank.base.runs.sd[screen.bank.base.runs.indices(hypothesis)[0]]
        seen = np.minimum(np.sqrt(screen.power[rows]), np.abs(sizes) / max(sd, 1e-30))
        if len(hypothesis.parameters) == 1:
            ends = [
                crossing(np.abs(sizes[sizes * sign > 0]), seen[sizes * sign > 0], goal)
                for sign in hypothesis.signs
                if np.any(sizes * sign > 0)
            ]
            lost = not ends or any(end is None for end in ends)
            found[hypothesis.label] = None if lost else max(e for e in ends if e is not None)
        else:
            found[hypothesis.label] = _together(screen, h, goal)
    return found


def _together(screen: Screen, number: int, goal: float) -> float | None:
    """Smallest length of a departure of several parameters, in its least visible direction.

    Each entry of the bank is a direction, along which d is taken as proportional to size.
    """
    rows, hypothesis = screen.bank.entries(number), screen.bank.hypotheses[number]
    if not len(rows):
        return None
    sizes = np.array([np.linalg.norm(screen.bank.sizes[k]) for k in rows])
    needed = float(np.max(sizes * goal / np.sqrt(screen.power[rows])))
    return needed if needed < np.linalg.norm(hypothesis.largest) else None


def crossing(sizes: FloatArray, seen: FloatArray, goal: float) -> float | None:
    """Size at which what is seen reaches a goal; None if it does at none of the sizes."""
    order = np.argsort(sizes)
    sizes, seen = sizes[order], np.maximum.accumulate(seen[order])
    if seen[-1] < goal:
        return None
    if seen[0] >= goal:
        return float(sizes[0] * goal / seen[0])  # linear below the smallest
    return float(np.exp(np.interp(np.log(goal), np.log(seen), np.log(sizes))))


def twins(screen: Screen) -> list[tuple[str, str, float]]:
    """Pairs of causes whose signatures look alike at a size just visible, with their cosine."""
    norm = 1.0 / np.sqrt(screen.power)
    cosine = np.abs(screen.gram * np.outer(norm, norm))
    goal = np.abs(np.log(np.sqrt(screen.power) / 10.0))
    picked = []
    for h in range(len(screen.bank.hypotheses)):
        rows = screen.bank.entries(h)
        if len(rows):
            picked.append((h, int(rows[np.argmin(goal[rows])])))
    labels = [hypothesis.label for hypothesis in screen.bank.hypotheses]
    return [
        (labels[a], labels[b], float(cosine[i, j]))
        for n, (a, i) in enumerate(picked)
        for b, j in picked[n + 1 :]
        if cosine[i, j] > TWINS_FROM
    ]
