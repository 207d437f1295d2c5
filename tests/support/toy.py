"""A plant that is linear in its parameters, so that every posterior has a closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Channel, Excitation, Hypothesis, Parameter
from ves_twin.diagnosis.settings import Settings

SD = (0.01, 0.05)
PERIOD = 0.01
ROWS = 800

NUISANCES = (
    Parameter("plant.gain", "1", 1.0, 0.0, 2.0, sd=0.02),
    Parameter("plant.slope", "1", 0.0, -5.0, 5.0, sd=0.05),
    Parameter("plant.offset", "1", 0.0, -5.0, 5.0, sd=0.05, per_recording=True),
)
CAUSES = ("friction", "drift", "lag", "bump", "ripple")


def _absent(name: str) -> Parameter:
    return Parameter(f"{name}.size", "1", 0.0, -5.0, 5.0)


def _cause(name: str) -> Hypothesis:
    return Hypothesis(name, "plant", (f"{name}.size",), (0.001,), (1.0,))


GAIN = Hypothesis("gain", "plant", ("plant.gain",), (0.02,), (0.8,))


@dataclass(frozen=True)
class Toy:
    """Channels are gain * u and sums of fixed shapes times parameters."""

    causes: tuple[str, ...] = CAUSES
    with_gain: bool = True
    nuisances: tuple[Parameter, ...] = NUISANCES
    drive: tuple[str, ...] = ("drive.u",)

    @property
    def channels(self) -> tuple[Channel, ...]:
        return tuple(Channel(f"out.{c}", "out", c, "1", sd) for c, sd in enumerate(SD))

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        return (*self.nuisances, *(_absent(name) for name in self.causes))

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        return (*((GAIN,) if self.with_gain else ()), *(_cause(name) for name in self.causes))

    @property
    def identity(self) -> str:
        return repr((self.causes, self.with_gain, self.nuisances))

    def without(self, name: str) -> Toy:
        return replace(self, causes=tuple(c for c in self.causes if c != name))

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> np.ndarray:
        u, time = programme.drive["drive.u"][:, 0], programme.time
        value = {p.name: p.nominal for p in self.parameters} | dict(values)
        fed = u.tobytes(), time.tobytes()
        rows = value["plant.gain"] * u[:, None] * [0.3, 1.0]
        rows = rows + value["plant.slope"] * _speed(*fed) * [0.05, 0.2]
        rows = rows + value["plant.offset"] * np.ones((len(u), 2)) * [1.0, 0.3]
        for name in self.causes:
            rows = rows + value[f"{name}.size"] * _shape(name, *fed)
        return rows


@lru_cache(maxsize=64)
def _speed(u: bytes, time: bytes) -> np.ndarray:
    return np.gradient(np.frombuffer(u), np.frombuffer(time))[:, None]


@lru_cache(maxsize=256)
def _shape(name: str, u: bytes, time: bytes) -> np.ndarray:
    """`shape`, kept: a diagnosis asks for the same programme hundreds of times."""
    return shape(name, np.frombuffer(u), np.frombuffer(time))


def shape(name: str, u: np.ndarray, time: np.ndarray) -> np.ndarray:
    """What one unit of a cause adds (n, 2)."""
    match name:
        case "friction":
            return np.sign(u)[:, None] * [0.5, 1.0]
        case "drift":
            return (time / time[-1])[:, None] ** 2 * [1.0, 0.0]
        case "lag" | "late":  # twins: the same shape
            return np.gradient(np.gradient(u, time), time)[:, None] * [0.02, 0.02]
        case "bump":
            return np.exp(-(((time - 4.0) / 0.5) ** 2))[:, None] * [0.0, 1.0]
        case _:
            return np.sin(2 * np.pi * 3.7 * time)[:, None] * [1.0, -0.5]


def programme(seed: int = 1, amplitude: float = 1.0) -> Excitation:
    rng = np.random.default_rng(seed)
    time = PERIOD * np.arange(ROWS)
    tones = zip(rng.uniform(0.2, 1.5, 4), rng.uniform(0, 6.28, 4), strict=True)
    u = amplitude * sum(np.sin(2 * np.pi * f * time + a) for f, a in tones)
    return Excitation("toy", time, {"drive.u": np.asarray(u)[:, None]})


def record(
    rng: np.random.Generator,
    values: Mapping[str, float] | None = None,
    spread: float = 1.0,
    fed: Excitation | None = None,
    added: np.ndarray | None = None,
    plant: Toy | None = None,
    colour: float | None = None,
) -> Recording:
    """A measured record: nuisances redrawn, noise of another level and colour than declared."""
    fed = programme() if fed is None else fed
    plant = Toy() if plant is None else plant
    value = {p.name: p.nominal for p in plant.parameters}
    for p in NUISANCES:
        value[p.name] += spread * p.sd * rng.standard_normal()
    for name, size in (values or {}).items():
        value[name] = value.get(name, 0.0) + size
    rows = plant.simulate(fed, value)
    drawn, level = rng.uniform(0.0, 0.25), rng.uniform(0.9, 1.12)
    colour = drawn if colour is None else colour
    noise = level * rng.standard_normal((len(rows), 2)) * SD
    for k in range(1, len(noise)):
        noise[k] += colour * noise[k - 1]
    rows = rows + noise + (0.0 if added is None else added)
    signals = {**fed.drive, "out": rows}
    return Recording(fed.time, signals, RecordingInfo("measured"))


QUICK = Settings(nulls=100)

SERIES_DAYS = (0, 3, 7, 10, 14, 17, 21, 24)
"""Days of a series of recordings."""
