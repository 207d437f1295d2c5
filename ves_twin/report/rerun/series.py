"""Series: what is plotted: every signal of a recording and the differences that matter."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.report.colours import MEASURED, REFERENCE, Colour, rgb
from ves_twin.report.rerun.colours import axis_colours, pale

SHOWN_UNITS = {"m": (1e3, "mm"), "rad": (1e3, "mrad"), "Pa": (1e-5, "bar"), "1": (1.0, "-")}
"""SI unit -> factor and unit in a plot; other units are shown as they are."""

KEPT_IN_SI = frozenset({"arm.command", "arm.q", "truth.arm_q"})
"""Angles of whole turns, that milliradians would make hard to read."""

PREFIXES = {
    "sensor.wrench": "sensor ",
    "gravity.estimate": "gravity ",
    "truth.wrench": "true ",
    "arm.command": "command ",
    "arm.q": "encoder ",
    "truth.arm_q": "true ",
}
"""Words before the axis, for signals that share a plot."""

PALE = frozenset({"gravity.estimate", "arm.command"})
"""Signals drawn in the lighter shade of their axis, behind what is compared with them."""

GROUPS = {"m": "position", "rad": "angles", "N": "force", "N*m": "moment"}
"""Unit -> entity below a signal whose axes have more than one unit."""

EMULATED_FROM = ("truth.pose", "platform.pose")
"""Signals that tell the emulated base motion, the best first."""


@dataclass(frozen=True)
class Series:
    """Lines of one entity.

    Attributes:
        entity: path in the file.
        names: name of each line, with its unit.
        colours: colour of each line.
        values: rows of the recording -> values in the units of the names (n, lines).
    """

    entity: str
    names: tuple[str, ...]
    colours: tuple[Colour, ...]
    values: Callable[[slice], FloatArray]


def series_of(recording: Recording) -> tuple[Series, ...]:
    """Every signal of a recording as lines, then what is derived from them.

    Lengths are shown in mm and small angles in mrad; the arm's joint angles stay in rad.
    """
    found = [s for name in recording.signals for s in _signal_series(recording, name)]
    return (*found, *_base_motion(recording), *_errors(recording))


def shown(name: str, unit: str) -> tuple[float, str]:
    """Factor from SI and unit in a plot, of one column of a signal."""
    if name in KEPT_IN_SI:
        return 1.0, unit
    return SHOWN_UNITS.get(unit, (1.0, unit))


def emulated_signal(recording: Recording) -> str | None:
    """Name of the signal that tells the emulated base motion, if the recording has one."""
    return next((name for name in EMULATED_FROM if name in recording.signals), None)


def _signal_series(recording: Recording, name: str) -> list[Series]:
    signal = recording.info.signal(name)
    units = tuple(dict.fromkeys(signal.units))
    result = []
    for unit in units:
        columns = [i for i, u in enumerate(signal.units) if u == unit]
        factor, label = shown(name, unit)
        entity = f"signals/{name}" if len(units) == 1 else f"signals/{name}/{_group(unit)}"
        colours = axis_colours(len(columns))
        result.append(
            Series(
                entity,
                tuple(f"{PREFIXES.get(name, '')}{signal.axes[i]} [{label}]" for i in columns),
                tuple(map(pale, colours)) if name in PALE else colours,
                _columns(recording[name], columns, factor),
            )
        )
    return result


def _group(unit: str) -> str:
    """Last part of an entity; the viewer's paths take words only: m_per_s, m_per_s_2."""
    return GROUPS.get(unit) or re.sub(r"\W+", "_", unit.replace("/", "_per_"))


def _columns(
    values: FloatArray, columns: list[int], factor: float
) -> Callable[[slice], FloatArray]:
    return lambda rows: factor * values[rows][:, columns]


def _base_motion(recording: Recording) -> list[Series]:
    """Base motion per axis, beside the zero-g reference (or the command), and the error."""
    source = emulated_signal(recording)
    if source is None:
        return []
    pose = SIGNALS[source]
    reference = "reference.pose" if "reference.pose" in recording.signals else "platform.command"
    words = ["emulated" if reference == "reference.pose" else "platform"]
    sources = [recording[source]]
    if reference in recording.signals:
        words.append("zero-g reference" if reference == "reference.pose" else "command")
        sources.append(recording[reference])
    colours = (rgb(MEASURED), rgb(REFERENCE))[: len(sources)]
    result = []
    for i, (axis, unit) in enumerate(zip(pose.axes, pose.units, strict=True)):
        factor, label = shown(source, unit)
        names = tuple(f"{word} {axis} [{label}]" for word in words)
        result.append(Series(f"base_motion/{axis}", names, colours, _beside(sources, i, factor)))
    if reference == "reference.pose":
        result += _differences(recording, "base_motion/error", source, reference)
    return result


def _beside(sources: list[FloatArray], column: int, factor: float) -> Callable[[slice], FloatArray]:
    return lambda rows: factor * np.column_stack([s[rows, column] for s in sources])


def _errors(recording: Recording) -> list[Series]:
    """What the loops leave over: the legs, the arm's servo, and the wrench beyond gravity."""
    pairs = (
        ("legs/error", "leg.command", "leg.length"),
        ("arm/error", "arm.command", "arm.q"),
        ("dynamic_wrench", "sensor.wrench", "gravity.estimate"),
    )
    return [
        series
        for entity, minuend, other in pairs
        if {minuend, other} <= set(recording.signals)
        for series in _differences(recording, entity, minuend, other)
    ]


def _differences(recording: Recording, entity: str, minuend: str, other: str) -> list[Series]:
    """Minuend less the other signal, one entity per unit, angles in mrad even for joints."""
    signal = SIGNALS[minuend]
    units = tuple(dict.fromkeys(signal.units))
    first, second = recording[minuend], recording[other]
    result = []
    for unit in units:
        columns = [i for i, u in enumerate(signal.units) if u == unit]
        factor, label = SHOWN_UNITS.get(unit, (1.0, unit))
        result.append(
            Series(
                entity if len(units) == 1 else f"{entity}/{_group(unit)}",
                tuple(f"{signal.axes[i]} [{label}]" for i in columns),
                axis_colours(len(columns)),
                _difference(first, second, columns, factor),
            )
        )
    return result


def _difference(
    first: FloatArray, second: FloatArray, columns: list[int], factor: float
) -> Callable[[slice], FloatArray]:
    return lambda rows: factor * (first[rows] - second[rows])[:, columns]
