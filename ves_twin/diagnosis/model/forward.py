"""Forward: what a diagnosis needs of a plant: parameters in, channels out."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Protocol

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.grid import RATE

LEVELS = 5
"""Sizes of a one-parameter hypothesis in the bank: a factor of 2 to 4 apart, which the amplitude
of the screen (0.35 to 2.8) bridges."""


@dataclass(frozen=True)
class Channel:
    """One measured column that is compared.

    Attributes:
        name: name in the verdict, for instance "joint.angle".
        signal: signal of a recording that holds it.
        column: column of that signal, from 0.
        unit: its unit.
        sd: declared sd of one sample's noise [unit].
        corner: of the second-order low-pass that the noise went through [Hz]; white if None.
        settling: rows this early [s] tell nothing: how dry friction holds a rig that stands is
            chance, in the rig and in its simulation.
    """

    name: str
    signal: str
    column: int
    unit: str
    sd: float
    corner: float | None = None
    settling: float = 0.0


@dataclass(frozen=True)
class Parameter:
    """One number of the plant that may differ from its nominal value.

    Attributes:
        name: for instance "link.mass".
        unit: SI unit.
        nominal: the value the model has.
        low, high: bounds.
        sd: how well commissioning knows it; 0 where it is known, or absent by declaration.
        per_recording: drawn anew for each recording, for instance an initial angle.
        additive: adds the same to the channels for each unit of it, whatever all else is.
        component: one of a vector, so that at zero the others may say all.
    """

    name: str
    unit: str
    nominal: float
    low: float
    high: float
    sd: float = 0.0
    per_recording: bool = False
    additive: bool = False
    component: bool = False

    def __post_init__(self) -> None:
        if not (self.low <= self.nominal <= self.high and self.low < self.high and self.sd >= 0):
            expected = "low <= nominal <= high, low < high, sd >= 0"
            raise InvalidInputError(f"parameter {self.name}", self, expected)


@dataclass(frozen=True)
class Hypothesis:
    """One named cause: parameters that leave their nominal values together.

    Attributes:
        effect: kind, for instance "coulomb_friction".
        target: where, for instance "joint" or "leg.3".
        parameters: names of the parameters it moves.
        smallest: smallest departure of interest of each [unit of the parameter].
        largest: largest departure that is plausible.
        signs: directions that are physical: (1,), (-1,) or (-1, 1).
        source: where sizes come from.
        linear: its trace is proportional to its size over the whole range, so that the column of
            its own tolerance, scaled, stands for every size in the bank.
        transient: its sizes belong to the recorded stretch of time, as the shape of a drift does;
            it may be filled in between recordings and says nothing of what comes later.
        starts: departures for the bank where parameters say nothing one by one, as the gap of a
            friction that has no level; () makes them of the sizes.
    """

    effect: str
    target: str
    parameters: tuple[str, ...]
    smallest: tuple[float, ...]
    largest: tuple[float, ...]
    signs: tuple[int, ...] = (-1, 1)
    source: str = ""
    linear: bool = False
    transient: bool = False
    starts: tuple[tuple[float, ...], ...] = ()

    @property
    def label(self) -> str:
        """effect@target, as in the verdict."""
        return f"{self.effect}@{self.target}"

    @property
    def kind(self) -> tuple[str, str]:
        """Effect, and the sort of part that has it: ("valve_null", "leg") for "leg.3"."""
        return self.effect, self.target.split(".")[0]

    def departures(self) -> FloatArray:
        """Finite sizes for the bank (k, parameters), never all zero.

        Geometric from twice the smallest to 0.8 of the largest: the ends of the range are reached
        by scaling. Two parameters: three sizes of each and of all combinations; more: of each
        alone.
        """
        if self.starts:
            return np.asarray(self.starts, dtype=float)
        count = LEVELS if len(self.parameters) == 1 else 3
        axes = []
        for smallest, largest in zip(self.smallest, self.largest, strict=True):
            sizes = np.geomspace(2.0 * smallest, 0.8 * largest, count)
            axes.append(np.concatenate([sign * sizes for sign in self.signs]))
        if len(axes) == 1:
            return np.asarray(axes[0][:, None])
        if len(axes) > 2:
            return np.concatenate(
                [np.outer(axis, row) for axis, row in zip(axes, np.eye(len(axes)), strict=True)]
            )
        points = np.array(list(product(*[np.concatenate([[0.0], axis]) for axis in axes])))
        return np.asarray(points[np.any(points != 0.0, axis=1)])


@dataclass(frozen=True)
class Excitation(ReadOnly):
    """What was fed into the plant: drive signals on one clock.

    Attributes:
        name: for people.
        time: equidistant times [s] (n,); of poses at rest only their order.
        drive: signal name -> values (n, width).
        poses: each row is a pose at rest, with noise of its own.
        rate: of the analysis grid [Hz].
    """

    name: str
    time: FloatArray
    drive: Mapping[str, FloatArray]
    poses: bool = False
    rate: float = RATE

    @cached_property
    def identity(self) -> str:
        """Hash of the clock and of everything fed in."""
        digest = hashlib.sha256(np.ascontiguousarray(self.time).tobytes())
        if self.poses or self.rate != RATE:
            digest.update(repr((self.poses, self.rate)).encode())
        for name in sorted(self.drive):
            digest.update(name.encode() + np.ascontiguousarray(self.drive[name]).tobytes())
        return digest.hexdigest()[:16]

    @property
    def period(self) -> float:
        """Time between rows [s]."""
        return float(self.time[-1] - self.time[0]) / (len(self.time) - 1)

    @staticmethod
    def of(
        recording: Recording, drive: tuple[str, ...], name: str = "", rate: float = RATE
    ) -> Excitation:
        """What a recording says was fed in; poses at rest have `POSES` as the clock of their rows.

        Raises:
            UnknownNameError: a drive signal that is not recorded.
            InvalidInputError: rows that are not equidistant.
        """
        steps = np.diff(recording.time)
        poses = recording.info.log == POSES
        if poses and len(steps):
            fed = {signal: recording[signal] for signal in drive}
            return Excitation(name, recording.time, fed, True, rate)
        if len(steps) < 2 or np.ptp(steps) > 0.01 * np.mean(steps):
            expected = (
                "equidistant rows; window in the machine's file or experiment, or rate in a map"
            )
            raise InvalidInputError("recording time", _uneven(recording.time), expected)
        fed = {signal: recording[signal] for signal in drive}
        return Excitation(name, recording.time, fed, False, rate)


def _uneven(time: FloatArray) -> str:
    """What is wrong with times (n,) [s] that are not equidistant."""
    if len(time) < 3:
        return f"{len(time)} rows"
    steps = np.diff(time)
    usual = float(np.median(steps))
    worst = int(np.argmax(np.abs(steps - usual)))
    return f"a step of {steps[worst]:.3g} s after {time[worst]:.4g} s, of {usual:.3g} s as a rule"


class Forward(Protocol):
    """A plant as the diagnosis sees it. Values are picklable: runs go to other processes."""

    @property
    def identity(self) -> str:
        """Changes with anything that changes a prediction; part of the key of a cached bank."""

    @property
    def drive(self) -> tuple[str, ...]:
        """Signals of a recording that are fed in."""

    @property
    def channels(self) -> tuple[Channel, ...]:
        """What is compared."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Everything that may differ; those with sd > 0 are the nuisances."""

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """The library of causes."""

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> FloatArray:
        """Noise-free channels (n, channels) at the programme's rows; NaN if the plant fails there.

        Args:
            programme: what is fed in.
            values: parameter -> value; a name left out is nominal. Within bounds.
            refined: with half the integration step, which shows what the step is worth.
        """


def check_forward(forward: Forward) -> None:
    """Raise UnknownNameError or InvalidInputError on a library that names what does not exist."""
    names = {p.name: p for p in forward.parameters}
    for hypothesis in forward.hypotheses:
        for name in hypothesis.parameters:
            if name not in names:
                raise UnknownNameError(f"parameter of {hypothesis.label}", name, names)
            if names[name].per_recording:
                raise InvalidInputError(hypothesis.label, name, "a parameter of the plant itself")
