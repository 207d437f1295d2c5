"""Channels: the named columns of an environment's observations or actions, with unit and bounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.types import FloatArray, SingleArray


@dataclass(frozen=True)
class Channel:
    """A group of columns of one kind.

    Attributes:
        name: of a signal where it is one, for instance "platform.pose".
        units: unit of each column.
        low: smallest value of each column in its unit (n,); a reading below it reads as it.
        high: largest value of each column (n,).
        meaning: what it is.
    """

    name: str
    units: tuple[str, ...]
    low: FloatArray
    high: FloatArray
    meaning: str

    @staticmethod
    def within(
        name: str, units: tuple[str, ...], limit: FloatArray | float, meaning: str
    ) -> Channel:
        """A channel with bounds of both signs, limit (n,) or a single number for all columns."""
        high = np.broadcast_to(np.asarray(limit, float), (len(units),)).copy()
        return Channel(name, units, -high, high, meaning)

    @property
    def width(self) -> int:
        """Number of columns."""
        return len(self.units)

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names, numbered from 1; a single one without a number."""
        if self.width == 1:
            return (self.name,)
        return tuple(f"{self.name}.{i + 1}" for i in range(self.width))


class Channels:
    """Channels side by side as one vector.

    Attributes:
        channels: in the order of the columns.
        slices: name -> its columns.
        low: smallest values (n,).
        high: largest values (n,).
    """

    def __init__(self, *channels: Channel) -> None:
        self.channels = channels
        ends = np.cumsum([0, *(c.width for c in channels)])
        self.slices = {
            c.name: slice(int(a), int(b))
            for c, a, b in zip(channels, ends[:-1], ends[1:], strict=True)
        }
        self.low = np.concatenate([c.low for c in channels])
        self.high = np.concatenate([c.high for c in channels])

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns."""
        return tuple(name for c in self.channels for name in c.columns)

    @property
    def width(self) -> int:
        """Number of columns."""
        return len(self.low)

    def vector(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """The columns (n,) of values by name, each held within its bounds."""
        row = np.concatenate([values[name] for name in self.slices])
        _hold(row, self.low, self.high)
        return row

    def split(self, vector: FloatArray) -> dict[str, FloatArray]:
        """Values by name from a vector (n,)."""
        return {name: vector[columns] for name, columns in self.slices.items()}

    def shares(self, vector: FloatArray) -> SingleArray:
        """A vector (n,) in its units as shares of the bounds: -1 at `low`, 1 at `high`."""
        middle, half = (self.high + self.low) / 2.0, (self.high - self.low) / 2.0
        return np.asarray(np.clip((vector - middle) / half, -1.0, 1.0), np.float32)

    def physical(self, shares: FloatArray | SingleArray) -> FloatArray:
        """The vector (n,) in its units whose `shares` these are, to single precision."""
        middle, half = (self.high + self.low) / 2.0, (self.high - self.low) / 2.0
        return np.asarray(middle + half * np.asarray(shares, float))

    def table(self) -> str:
        """A Markdown table: columns, unit, bounds, meaning."""
        rows = ["| columns | name | unit | from | to | what |", "|---|---|---|--:|--:|---|"]
        for c in self.channels:
            span = self.slices[c.name]
            where = f"{span.start}" if c.width == 1 else f"{span.start}-{span.stop - 1}"
            unit = ", ".join(dict.fromkeys(c.units))
            ends = (", ".join(dict.fromkeys(f"{v:.4g}" for v in side)) for side in (c.low, c.high))
            low, high = ends
            rows.append(f"| {where} | `{c.name}` | {unit} | {low} | {high} | {c.meaning} |")
        return "\n".join(rows)


@compiled
def _hold(row: FloatArray, low: FloatArray, high: FloatArray) -> None:
    """Hold a row within its bounds; what is no number stays none."""
    for i in range(len(row)):
        if row[i] < low[i]:
            row[i] = low[i]
        elif row[i] > high[i]:
            row[i] = high[i]
