"""SensorChange: what gain, cross-talk and mounting make of a sensor's wrench already simulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

from ves_twin.core.types import Block, FloatArray
from ves_twin.effects.sensors import CrossTalk, SensorGain, SensorMounting
from ves_twin.plant.plant import Plant
from ves_twin.simulator.blocks import PARAMETERS, fill_sensor

KINDS = frozenset({SensorGain.kind, CrossTalk.kind, SensorMounting.kind})
"""Kinds that change the reading and nothing else, as long as no loop is closed over the sensor."""


@dataclass(frozen=True)
class SensorChange:
    """W = S1 S0^-1 (W0 - Z) + Z for a sensor that was zeroed to read Z at rest.

    S = G diag(R, R)' has the signal matrix G and the turn R of the sensor on its plate, about its
    own origin. It, low-pass and zeroing are linear, so the reading of a sensor with S1 follows from
    that of S0 without a run, up to a count.

    Attributes:
        matrix: S1 S0^-1 (6, 6).
    """

    matrix: FloatArray

    @staticmethod
    def between(before: Plant, after: Plant) -> SensorChange:
        """From the sensor of one plant to that of another that differs by KINDS alone."""
        old, new = _signal_matrix(before), _signal_matrix(after)
        return SensorChange(new @ np.linalg.inv(old))

    def apply(self, wrench: FloatArray, at_rest: FloatArray) -> FloatArray:
        """Readings (n, 6) of the changed sensor.

        Args:
            wrench: readings of the other one (n, 6).
            at_rest: Z, what zeroing makes either read before the run; zeros without it (6,).
        """
        return np.asarray((wrench - at_rest) @ self.matrix.T + at_rest)


def without_sensor_kinds(values: Mapping[str, float]) -> dict[str, float]:
    """Named values without those of KINDS."""
    return {name: value for name, value in values.items() if name.split("@")[0] not in KINDS}


def _signal_matrix(plant: Plant) -> FloatArray:
    block: Block = np.zeros(1, PARAMETERS)
    fill_sensor(block[0]["sensor"], plant.parameters, plant.parameters.number("clock.tick"))
    turn = Rotation.identity()
    for effect in plant.effects:
        if isinstance(effect, SensorMounting):
            turn = turn * Rotation.from_rotvec(effect.angle * np.eye(3)[effect.index])
        elif effect.kind in KINDS:
            effect.edit_loop(block[0])
    both = block_diag(turn.as_matrix().T, turn.as_matrix().T)
    return np.asarray(block[0]["sensor"]["gain"] @ both)
