"""Invertible: a Forward that tells which efforts a measured motion asks for beyond its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol, runtime_checkable

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation, Forward
from ves_twin.effects.law import Law


@runtime_checkable
class Invertible(Forward, Protocol):
    """A `Forward` with inverse dynamics, where its motion is measured and its commands are known.

        missing = M(q) a + c(q, v) + g(q) - command

    is linear in what a model lacks at any loudness, where a simulation is not.
    """

    @property
    def band(self) -> float:
        """Corner [Hz] of the low-pass behind which its motion is differentiated."""

    def effort_unit(self, joint: str) -> str:
        """N or N*m, as a joint slides or turns."""

    def missing(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        measured: Mapping[str, FloatArray],
        as_nominal: bool = False,
        laws: Sequence[Law] = (),
    ) -> tuple[Mapping[str, FloatArray], Mapping[str, FloatArray]] | None:
        """Efforts by joint that a measured motion asks for beyond the plant's, and variables.

        Args:
            programme: what was fed in.
            values: parameter -> value.
            measured: channels (n,) at the programme's rows, smooth.
            as_nominal: as efforts that accelerate the nominal plant so, M_0 M^-1 missing: their
                noise does not fall with the masses, and a plant of none would lack much.
            laws: at work beside those that the plant has.

        Returns:
            None where the channels do not tell the motion, or the motion is what is fed in.
        """
