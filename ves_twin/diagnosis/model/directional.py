"""Directional: a Forward that tells which causes are one where a part moves one way alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, runtime_checkable

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation, Forward

Moment = tuple[Excitation, Mapping[str, float]]
"""A programme, and the values of parameters in it."""

Visited = Callable[[Excitation, Mapping[str, float]], Mapping[str, FloatArray]]
"""What moves along a programme (n,), by name, as `LawForward` tells it."""


@runtime_checkable
class Directional(Forward, Protocol):
    """A `Forward` that knows which of its kinds are told apart by a reversal alone.

    Whether they are offered as causes does not matter: who leaves one out knows the other no
    better.
    """

    def one_way_twins(
        self, labels: Sequence[str], moments: Sequence[Moment], visited: Visited | None = None
    ) -> Mapping[str, tuple[str, ...]]:
        """Labels of causes that nothing in recordings tells from some, by the label of each.

        Args:
            labels: of causes, at work or not.
            moments: of every recording, fitted and held out.
            visited: what moves; as the forward itself simulates it if None.
        """
