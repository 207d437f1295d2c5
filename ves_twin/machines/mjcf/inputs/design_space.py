"""MjcfDesignSpace: multisines and releases of an MJCF machine, as points of a box."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.inputs.excitations import BANDS, FADE, HIGHEST, ROWS, drive_of
from ves_twin.machines.mjcf.inputs.inputs import BORNE, Input, inputs_of, range_of, sizes_of, strain
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.started import start_signal
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.description import Mode

TONES = 3
"""Of an input; fewer where there are many inputs."""

TOGETHER = 12
"""Tones of all inputs together: each has three numbers to be optimised."""

SCALINGS = 8
"""Times that inputs are made smaller until their motion keeps the limits."""

SHORT = 0.98
"""Share of a limit that a scaling aims at, so that the next one is rarely needed."""


@dataclass(frozen=True)
class MjcfDesignSpace:
    """Sums of sines with an offset for each input, and where joints are let go from.

    Attributes:
        forward: in the mode in which it is fed.
        inputs: with their limits.
        time: of the rows [s] (n,).
        like: gives what is neither fed in nor let go.
    """

    forward: MjcfForward
    inputs: tuple[Input, ...]
    time: FloatArray
    like: Recording | None = None

    @staticmethod
    def of(
        forward: MjcfForward, seconds: float, like: Recording | None = None
    ) -> MjcfDesignSpace | None:
        """Excitations of a length; None where inputs cannot be bounded, as for the menu."""
        inputs = inputs_of(forward, like)
        told = forward.rig.description
        if not inputs or told.clock.poses:
            return None
        period = 1.0 / (ROWS * told.rate)
        if like is not None and len(like) > 1:
            period = float(like.time[-1] - like.time[0]) / (len(like) - 1)
        time = np.asarray(period * np.arange(round(seconds / period) + 1), float)
        return MjcfDesignSpace(forward, tuple(inputs), time, like)

    @property
    def size(self) -> int:
        """Numbers of a point: of each input frequency, weight, phase of each tone, and offset."""
        return len(self.inputs) * (3 * self._tones + 1) + len(self._released)

    def excitation(self, point: FloatArray, name: str) -> Excitation | None:
        """Inputs and starts of a point in [-1, 1] (size,); None if no size of them is borne.

        They are as large as the point says, or as the limits of `strain` let them be.
        """
        told, rows = self.forward.rig.description, {}
        numbers = iter(np.split(point, np.cumsum(self._widths)[:-1]))
        for one in self.inputs:
            rows[one.signal] = one.rows(self._shape(one, next(numbers)), self.time)
        drive = drive_of(self.forward, rows, self.like)
        for joint, share in zip(self._released, next(numbers), strict=True):
            start = self._start(joint, float(share))
            drive[start_signal(joint)] = np.tile([start, 0.0], (len(self.time), 1))
            name = f"{name}, {joint} let go from {start:.3g} {_unit(self.forward, joint)}"
        for _ in range(SCALINGS):
            made = Excitation(name, self.time, drive, rate=told.rate)
            if self.forward.mode is Mode.MOTION:
                return made
            taken = strain(self.forward, made)
            if taken <= 1.0:
                return made
            factor = max(SHORT / taken, 0.3)
            for one in self.inputs:
                drive[one.signal] = one.rest + factor * (drive[one.signal] - one.rest)
        return None

    @property
    def _tones(self) -> int:
        return max(1, min(TONES, TOGETHER // len(self.inputs)))

    @property
    def _widths(self) -> list[int]:
        return [3 * self._tones + 1] * len(self.inputs) + [len(self._released)]

    @cached_property
    def _released(self) -> tuple[str, ...]:
        """Joints whose start a recording may say."""
        told = self.forward.rig.description
        if self.forward.mode is not Mode.CONTROL:
            return ()
        starts = told.start.items()
        free = (j for j, s in starts if s.position != "measured" and s.told)
        return tuple(j for j in free if sizes_of(self.forward, j)[2] > 0.0)

    def _start(self, joint: str, share: float) -> float:
        """A position within the travel that is borne and within the joint's range."""
        reach = BORNE * sizes_of(self.forward, joint)[2]
        return float(np.clip(share * reach, *range_of(self.forward, joint)))

    def _shape(self, one: Input, numbers: FloatArray) -> FloatArray:
        """Tones and offset (n,), of peak 1 at most, fading in."""
        rate, length = self.forward.rig.description.rate, float(self.time[-1])
        ends = [edge * one.corner for band in BANDS.values() for edge in band]
        low, high = np.minimum([min(ends), max(ends)], HIGHEST * rate)
        shape = np.full(len(self.time), numbers[-1])
        for frequency, weight, phase in numbers[:-1].reshape(-1, 3):
            tone = low * (high / low) ** (0.5 * (frequency + 1.0))
            shape += 0.5 * (weight + 1.0) * np.sin(2.0 * np.pi * tone * self.time + np.pi * phase)
        shape *= np.minimum(self.time / (FADE * length), 1.0) ** 2
        return np.asarray(shape / max(1.0, float(np.max(np.abs(shape)))))


def _unit(forward: MjcfForward, joint: str) -> str:
    return joint_units(forward.rig.model, joint)[0]
