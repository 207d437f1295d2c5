"""Carried: what is left on held-out recordings of what a plain MJCF file has of an answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import Recording
from ves_twin.machines.machine import Machine
from ves_twin.machines.rms_left import rms_left


@dataclass(frozen=True)
class Carried:
    """Rms errors of each channel [its unit] on held-out recordings, nothing fitted to them.

    Attributes:
        lacking: what of the extended machine is not written as MJCF.
        errors: channel -> by the model as given, by the extended machine, by its MJCF.
        units: of the channels.
    """

    lacking: tuple[str, ...] = ()
    errors: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    @staticmethod
    def of(
        given: Machine, extended: Machine, held_out: Sequence[Recording], rate: float
    ) -> Carried | None:
        """None where the file has all of it, none can be written, or nothing was held out.

        Args:
            given: the machine as its file has it.
            extended: with what was found.
            held_out: recordings that were not fitted.
            rate: of the analysis [Hz].
        """
        try:
            part, lacking = extended.as_mjcf()
        except VesTwinError:  # MuJoCo cannot write it: the command says so
            return None
        if part is None or not held_out:
            return None
        machines = given.forward, extended.forward, part.forward
        return Carried(lacking, *rms_left(machines, held_out, rate))

    @property
    def worse(self) -> tuple[str, ...]:
        """Channels that the MJCF predicts worse than the model as given."""
        return tuple(name for name, (given, _, part) in self.errors.items() if not part <= given)
