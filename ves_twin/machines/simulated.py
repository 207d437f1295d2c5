"""Simulated: what an answer that was found by efforts is worth in held-out motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ves_twin.core.recording.recording import Recording
from ves_twin.machines.machine import Machine
from ves_twin.machines.rms_left import rms_left


@dataclass(frozen=True)
class Simulated:
    """Rms errors of each channel [its unit], each recording from its measured start.

    Attributes:
        errors: channel -> by the model as given, by the extended machine.
        units: of the channels.
    """

    errors: Mapping[str, tuple[float, ...]]
    units: Mapping[str, str]

    @staticmethod
    def of(
        given: Machine, extended: Machine, held_out: Sequence[Recording], rate: float
    ) -> Simulated | None:
        """None where nothing was held out.

        Args:
            given: the machine as its file has it.
            extended: with what was found.
            held_out: recordings that were not fitted.
            rate: of the analysis [Hz].
        """
        if not held_out:
            return None
        return Simulated(*rms_left((given.forward, extended.forward), held_out, rate))
