"""pendulum_menu: what a pendulum could do next."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.forward import Excitation
from ves_twin.machines.pendulum.forward import START, STEP

SECONDS = 4.0
"""Length of a programme [s]."""

TONES = 5
"""Of a multisine."""

FADE = 0.25
"""Time in which a torque fades in [s]: from rest it begins with none."""

MENU: Mapping[str, tuple[float, tuple[float, float], float]] = {
    "multisine, other phases": (0.25, (0.2, 2.5), 0.0),
    "small multisine": (0.1, (0.2, 2.5), 0.0),
    "slow multisine": (0.4, (0.1, 0.5), 0.0),
    "quick multisine": (1.2, (2.5, 8.0), 0.0),
    "let go from 0.1 rad": (0.0, (0.2, 2.5), 0.1),
    "let go from 0.6 rad": (0.0, (0.2, 2.5), 0.6),
    "let go from 1.2 rad": (0.0, (0.2, 2.5), 1.2),
    "let go from 0.6 rad into a multisine": (0.3, (0.2, 2.5), 0.6),
}
"""Name -> amplitude of a tone [N m], band [Hz], angle that it is held at before [rad]. None swings
beyond a right angle: near the top a motion tells rounding errors, and no cause."""


def pendulum_menu() -> tuple[Excitation, ...]:
    """Torque and start of every entry; the same each time."""
    return tuple(_programme(n, name) for n, name in enumerate(MENU))


def _programme(number: int, name: str) -> Excitation:
    amplitude, band, angle = MENU[name]
    time = np.asarray(STEP * np.arange(round(SECONDS / STEP)), float)
    torque = amplitude * _multisine(time, band, np.random.default_rng([7, number]))
    torque *= np.minimum(time / FADE, 1.0)
    start = np.tile([angle, 0.0], (len(time), 1))
    return Excitation(name, time, {"joint.torque": torque[:, None], START.name: start})


def _multisine(time: FloatArray, band: tuple[float, float], rng: np.random.Generator) -> FloatArray:
    tones = zip(rng.uniform(*band, TONES), rng.uniform(0.0, 2.0 * np.pi, TONES), strict=True)
    return np.asarray(sum(np.sin(2.0 * np.pi * f * time + phase) for f, phase in tones))
