"""A machine of two joints that is linear in its causes, in a world of coloured model error."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.build_up.halves import Halves, halves_at
from ves_twin.diagnosis.model.forward import Channel, Excitation, Hypothesis, Parameter
from ves_twin.diagnosis.record.preprocess import Dataset, preprocess

PERIOD, ROWS = 0.02, 900
JOINTS = ("a", "b")
KINDS = ("viscous", "coulomb", "offset", "spring", "drag", "rotor", "harmonic")
MASS = Parameter("mass", "kg", 1.0, 0.1, 3.0, sd=0.05)


def shape(kind: str, x: np.ndarray) -> np.ndarray:
    """Effort of one unit of a kind along a motion (n,)."""
    v = np.gradient(x, PERIOD)
    return {
        "viscous": v,
        "coulomb": np.tanh(v / 0.02),
        "offset": np.ones_like(x),
        "spring": x,
        "drag": v * np.abs(v),
        "rotor": np.gradient(v, PERIOD),
        "harmonic": np.sin(5.0 * x),
        "twin": v + 0.02 * np.sin(9.0 * x),
        "gap": np.zeros_like(x),
        "viscous_friction": v,
        "viscous_asymmetry": np.abs(v),
    }[kind]


def gap(x: np.ndarray, width: float) -> np.ndarray:
    """An effort that is not linear in its one size."""
    return np.where(np.abs(x) > 1.0 - width, np.sign(x), 0.0)


@dataclass(frozen=True)
class Linear:
    """Torque of each joint is mass times acceleration and what causes add."""

    kinds: tuple[str, ...] = KINDS
    drive: tuple[str, ...] = ("q",)
    noise: float = 0.001
    couplings: tuple[str, ...] = ()

    @property
    def identity(self) -> str:
        return repr((self.kinds, self.couplings))

    @property
    def channels(self) -> tuple[Channel, ...]:
        return tuple(
            Channel(f"torque.{j}", "torque", k, "N*m", self.noise) for k, j in enumerate(JOINTS)
        )

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        sizes = [
            Parameter(f"{k}@{j}:size", "1", 0.0, -50.0, 50.0) for k in self.kinds for j in JOINTS
        ]
        sizes += [Parameter(f"coupling@{s}:size", "1", 0.0, -50.0, 50.0) for s in self.couplings]
        return (MASS, *sizes)

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        return tuple(
            Hypothesis(k, j, (f"{k}@{j}:size",), (0.001,), (0.8 if k == "gap" else 5.0,))
            for k in self.kinds
            for j in JOINTS
        ) + tuple(
            Hypothesis("coupling", sign, (f"coupling@{sign}:size",), (0.001,), (5.0,))
            for sign in self.couplings
        )

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> np.ndarray:
        rows = np.zeros((len(programme.time), 2))
        for c, joint in enumerate(JOINTS):
            x = programme.drive["q"][:, c]
            rows[:, c] = values.get("mass", 1.0) * 0.2 * shape("rotor", x)
            for kind in self.kinds:
                size = values.get(f"{kind}@{joint}:size", 0.0)
                if kind == "gap":
                    rows[:, c] += gap(x, size) if size else 0.0
                elif size:
                    rows[:, c] += size * shape(kind, x)
        speeds = np.gradient(programme.drive["q"], PERIOD, axis=0)
        for name in self.couplings:  # viscous, on the sum or the difference of both speeds
            ways = np.array([1.0, 1.0 if name == "sum" else -1.0])
            rows += values.get(f"coupling@{name}:size", 0.0) * np.outer(speeds @ ways, ways)
        return rows


class Narrow(Linear):
    """Viscous friction up to 0.1 alone."""

    @property
    def parameters(self):
        return tuple(
            replace(p, low=-0.1, high=0.1) if p.name.startswith("viscous") else p
            for p in super().parameters
        )

    @property
    def hypotheses(self):
        return tuple(
            replace(h, largest=(0.1,)) if h.effect == "viscous" else h for h in super().hypotheses
        )


class Known(Linear):
    """Viscous friction that the model has to 0.05."""

    @property
    def parameters(self):
        return tuple(
            replace(p, sd=0.05) if p.name.startswith("viscous") else p for p in super().parameters
        )


def motion(seed: int) -> Excitation:
    rng = np.random.default_rng(seed)
    t = PERIOD * np.arange(ROWS)
    q = np.stack(
        [
            sum(
                a * np.sin(6.28 * f * t + p)
                for a, f, p in zip(
                    (0.6, 0.3, 0.2), rng.uniform(0.15, 0.9, 3), rng.uniform(0, 6.28, 3), strict=True
                )
            )
            for _ in JOINTS
        ],
        axis=1,
    )
    return Excitation("motion", t, {"q": q}, rate=1.0 / PERIOD)


def recorded(
    plant: Linear, hidden: Mapping[str, float], seed: int, error: float = 0.1
) -> Recording:
    """A record with hidden causes, commissioning errors and coloured model error."""
    rng = np.random.default_rng(seed)
    fed = motion(seed)
    values = {"mass": 1.0 + 0.05 * rng.standard_normal(), **hidden}
    rows = plant.simulate(fed, values)
    colour = lfilter([1.0], [1.0, -0.9], rng.standard_normal((ROWS + 200, 2)), axis=0)[200:]
    rows = rows + error * np.sqrt(1.0 - 0.9**2) * colour
    rows = rows + plant.noise * rng.standard_normal(rows.shape)
    return Recording(fed.time, {**fed.drive, "torque": rows}, RecordingInfo("measured"))


def seen(plant: Linear, record: Recording) -> Dataset:
    return preprocess(plant, [record], rate=1.0 / PERIOD)


def halves(plant: Linear, hidden: Mapping[str, float], seed: int, error: float = 0.1) -> Halves:
    """Two records of one machine, about nominal."""
    one = seen(plant, recorded(plant, hidden, 2 * seed + 1, error))
    two = seen(plant, recorded(plant, hidden, 2 * seed + 2, error))
    return halves_at(one, two, one.runs.origin, plant.hypotheses)


def drawn(rng: np.random.Generator, count: int, kinds=KINDS) -> dict[str, float]:
    """Hidden causes, each with an rms of 0.3 to 1: three to ten times the model error."""
    labels = [f"{k}@{j}:size" for k in kinds for j in JOINTS]
    x = motion(1).drive["q"][:, 0]
    found = {}
    for label in rng.choice(labels, count, replace=False):
        rms = np.sqrt(np.mean(shape(str(label).split("@")[0], x) ** 2))
        found[str(label)] = float(rng.choice([-1, 1]) * rng.uniform(0.3, 1.0) / rms)
    return found
