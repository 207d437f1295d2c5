"""SignalBus: every signal of the rig at this instant; a row of a recording is a copy of it."""

from __future__ import annotations

import numpy as np

from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray

BOARD = np.dtype([(signal.field, np.float64, signal.width) for signal in SIGNALS.values()])
"""One float per column of every signal, in the order of the table of signals."""

WIDTH = BOARD.itemsize // 8

SLICES: dict[str, slice] = {}
"""Signal name -> its columns in a row."""
for _signal in SIGNALS.values():
    _start = BOARD.fields[_signal.field][1] // 8  # type: ignore[index]
    SLICES[_signal.name] = slice(_start, _start + _signal.width)


class SignalBus:
    """The signals by name; kernels write through `block`, Python through the views."""

    def __init__(self) -> None:
        self.block = np.zeros(1, BOARD)
        self.row: FloatArray = self.block.view(np.float64)
        self.views = {name: self.row[columns] for name, columns in SLICES.items()}

    def __getitem__(self, name: str) -> FloatArray:
        return self.views[name]

    def read_only(self, name: str) -> FloatArray:
        """A live view that its holder cannot write."""
        view = self.row[SLICES[name]]
        view.setflags(write=False)
        return view
