"""Case: one recording ready to be held against a machine in one of its modes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.even_clock import even_clock
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.signals import Signal
from ves_twin.core.types import FloatArray
from ves_twin.data.quality.check import Check
from ves_twin.diagnosis.model.grid import RATE
from ves_twin.diagnosis.record.residuals.noise import (
    Noise,
    NoiseSource,
    measured_noise,
    standing_rows,
)

if TYPE_CHECKING:
    from ves_twin.machines.ves2.emulation_cost import EmulationCost

Traces = Mapping[str, FloatArray]
"""Signal -> rows (n, width)."""


@dataclass(frozen=True, kw_only=True)
class Case(ABC):
    """A recording, what of it is fed in, and what of it is compared.

    Attributes:
        name: for people.
        recording: on an even clock from its first row on.
        inputs: signals that are fed in.
        outputs: signals that are compared.
        absent: signals that would be compared and are missing.
        checks: of the quality gate.
        notes: what was done to the data.
        rows: those that are compared.
        offset: time of the first row in the file [s].
        standstill: recording that tells the noise; None if there is none.
        still: whether a part of the recording in which no set-point changes tells it, if not.
    """

    name: str
    recording: Recording
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    absent: tuple[str, ...]
    checks: tuple[Check, ...]
    notes: tuple[str, ...]
    rows: slice
    offset: float
    standstill: Recording | None = None
    still: bool = False

    @property
    def period(self) -> float:
        """Of the rows [s]."""
        return float(np.median(np.diff(self.recording.time)))

    @property
    def poses(self) -> bool:
        """Whether each row is a pose at rest, and its time only its number."""
        return self.recording.info.log == POSES

    @property
    def imposed(self) -> tuple[str, ...]:
        """Joints that move as recorded while others are integrated."""
        return ()

    @property
    @abstractmethod
    def machine(self) -> str:
        """Name of the machine."""

    @property
    @abstractmethod
    def identity(self) -> str:
        """Hash of the machine."""

    @property
    @abstractmethod
    def mode(self) -> str:
        """What is fed in: "motion", "control", "reference", or "free": nothing."""

    @property
    @abstractmethod
    def signals(self) -> Mapping[str, Signal]:
        """Of inputs and outputs, by name."""

    @property
    @abstractmethod
    def same(self) -> Mapping[str, FloatArray]:
        """Inputs that a programme sets -> how far columns (width,) of one programme may differ.

        Inputs that answer to the run are not among them.
        """

    @property
    def leaders(self) -> Mapping[str, str]:
        """Output -> the input whose columns lead its own, one to one."""
        return {}

    @property
    def rate(self) -> float:
        """Of the analysis grid [Hz]."""
        return RATE

    @property
    def beside(self) -> tuple[str, ...]:
        """Signals that are simulated for the cost alone."""
        return ()

    @abstractmethod
    def simulated(self) -> Traces:
        """What the machine would have recorded, by signal (n, width)."""

    @abstractmethod
    def declared_noise(self) -> dict[str, Noise]:
        """Noise of each column by the machine's numbers; sd zero where they do not tell it."""

    def noise(self) -> dict[str, Noise]:
        """Noise of each compared column: of a standstill if there is one, else declared.

        Raises:
            InvalidInputError: a standstill recording at another rate.
        """
        recording, rows, said = self.recording, slice(0), NoiseSource.STILL
        if self.standstill is not None:
            recording = even_clock(self.standstill, ())
            rows, said = slice(None), NoiseSource.STANDSTILL
            period = float(np.median(np.diff(recording.time)))
            if abs(period / self.period - 1.0) > 0.01:
                here = f"{1.0 / self.period:.4g} Hz as in {self.name}"
                came = f"{1 / period:.4g} Hz"
                raise InvalidInputError("rate of the standstill recording", came, here)
        elif self.still:
            rows = standing_rows(recording, self.same) or slice(0)
        declared, found = self.declared_noise(), {}
        for name in self.outputs:
            for i, column in enumerate(self.signals[name].columns):
                there = name in recording.signals
                values = recording[name][rows, i] if there else np.zeros(0)
                found[column] = measured_noise(values, declared[column], said)
        return found

    def load(self, measured: Traces) -> FloatArray | None:
        """Size of the force (n,) whose halves are regimes of the residual."""
        return None

    def cost(self, time: FloatArray, measured: Traces, expected: Traces) -> EmulationCost | None:
        """What the residual costs an emulation; None where nothing is emulated."""
        return None
