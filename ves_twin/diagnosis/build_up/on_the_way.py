"""on_the_way: of the choices that lead to one of many causes, what is proved of a better one."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import Halves
from ves_twin.diagnosis.build_up.offer import least_left
from ves_twin.diagnosis.build_up.proof import prove


def on_the_way(
    halves: Halves, path: Sequence[Sequence[int]], known: Collection[str]
) -> tuple[int, ...]:
    """Trials that are proved of the choice that predicts held-out rows best, if on the way.

    Where model error is a law of the motion, a long choice describes the fitted half: its causes
    mimic each other on held-out rows, and the proof, which drops one after the other, may end
    without the two that were chosen first (a double pendulum by sweeps: fourteen, none proved,
    where the frictions of both joints are proved alone).

    A proof takes the cube of a choice's length in time, so that the first choices of 1, 2, 4, 8 and
    so on causes are put to it; all of their causes count for the rate, and are among the last
    choice's but for exchanges.

    Args:
        halves: linear about a point.
        path: choices, the last one last.
        known: labels of causes that were put to proof.

    Returns:
        None of them where as much is proved of the last choice.
    """
    regression, held = halves.regression, halves.held
    choices = list(dict.fromkeys(tuple(some) for some in _doubling(path) if some))
    every = {*known, *(regression.trials[n].cause.label for some in choices for n in some)}
    proved, left = dict[tuple[int, ...], tuple[int, ...]](), list[FloatArray]()
    for chosen in choices:
        proof = prove(regression, held, chosen, more=len(every) - len(chosen))
        fit = regression.solve(proof.proved, proof.bench.fit.whitening)
        proved[chosen] = proof.proved
        left.append(replace(proof.bench, fit=fit).residual(proof.proved))
    if not proved:
        return ()
    best = list(proved.values())[least_left(held, regression.quietest, left)]
    return () if set(best) == set(proved.get(tuple(path[-1]), ())) else best


def _doubling(path: Sequence[Sequence[int]]) -> list[Sequence[int]]:
    """The first choices of at least 1, 2, 4, 8 ... causes, and the last one."""
    found, wanted = list[Sequence[int]](), 1
    for chosen in path[:-1]:
        if len(chosen) >= wanted:
            found.append(chosen)
            wanted = 2 * len(chosen)
    return [*found, path[-1]]
