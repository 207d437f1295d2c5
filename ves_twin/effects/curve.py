"""Curve: an effect by which an actuator gives another effort of the command, whatever came before.

Its `edit_command` works on each row by itself.
"""

from __future__ import annotations

from abc import ABC
from dataclasses import dataclass

from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import Effect


@dataclass(frozen=True)
class Curve(Effect, ABC):
    """A kind whose closed loop needs no earlier commands."""

    def edit_row(self, command: FloatArray, time: FloatArray, row: int) -> float:
        """That of one row."""
        return float(self.edit_command(command[row : row + 1], time)[0])
