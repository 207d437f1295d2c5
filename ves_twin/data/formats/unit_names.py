"""unit_names: units as laboratories write them, and the unit that a column's name tells."""

from __future__ import annotations

import re

SPELLINGS = {
    "°": "deg",
    "degrees": "deg",
    "degree": "deg",
    "radians": "rad",
    "Nm": "N*m",
    "N.m": "N*m",
    "N-m": "N*m",
    "N·m": "N*m",
    "N m": "N*m",
    "mNm": "mN*m",
    "kNm": "kN*m",
    "Nmm": "mN*m",
    "N*mm": "mN*m",
    "N.mm": "mN*m",
    "Ncm": "cN*m",
    "N*cm": "cN*m",
    "rev": "turn",
    "revs": "turn",
    "turns": "turn",
    "revolutions": "turn",
    "rev/s": "turn/s",
    "rps": "turn/s",
    "sec": "s",
    "secs": "s",
    "seconds": "s",
    "msec": "ms",
    "usec": "us",
    "µs": "us",
    "µm": "um",
    "volt": "V",
    "volts": "V",
    "deg_s": "deg/s",
    "rad_s": "rad/s",
    "radps": "rad/s",
    "degps": "deg/s",
    "dps": "deg/s",
    "m_s": "m/s",
    "mm_s": "mm/s",
    "m_s2": "m/s^2",
    "m/s2": "m/s^2",
    "°/s": "deg/s",
    "°C": "degC",
    "-": "1",
}
"""Spelling -> unit that the unit library knows."""

TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
"""Units of time in seconds."""

_KNOWN = (
    *("m", "mm", "cm", "um", "nm", "in", "rad", "mrad", "deg", "turn"),
    *("N", "kN", "mN", "N*m", "mN*m", "cN*m", "kN*m", "Pa", "kPa", "MPa", "bar", "psi"),
    *("V", "mV", "A", "mA", "W", "K", "degC", "Hz", "rpm", "kg", "g", "%", "1", "counts"),
    *("m/s", "mm/s", "rad/s", "deg/s", "turn/s", "m/s^2", "rad/s^2", "deg/s^2"),
    *TIME,
)
_IN_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[({](?P<unit>[^\[\](){}]*)[\])}]\s*$")
_BEHIND_SLASH = re.compile(r"^(?P<name>.*?)\s+/\s*(?P<unit>\S+)$")
_BEHIND_BAR_RATE = re.compile(r"^(?P<name>.+)_(?P<unit>[A-Za-z°µ]+_s2?)$")
_BEHIND_BAR = re.compile(r"^(?P<name>.+)_(?P<unit>[A-Za-z°µ]+)$")
_PATTERNS = (_IN_BRACKETS, _BEHIND_SLASH, _BEHIND_BAR_RATE, _BEHIND_BAR)


def spelled(unit: str) -> str:
    """A unit as the unit library spells it."""
    unit = unit.strip()
    return SPELLINGS.get(unit, unit)


def is_unit(text: str) -> bool:
    """Whether a text is a unit that laboratories use."""
    return spelled(text) in _KNOWN


def unit_of_name(name: str) -> str:
    """The unit that a column's name gives: "x [mm]", "x (mm)", "x / mm", "x_mm"; else empty."""
    for pattern in _PATTERNS:
        match = pattern.match(name)
        if match and is_unit(match["unit"]) and match["unit"]:
            return spelled(match["unit"])
    return ""


def bare_name(name: str) -> str:
    """The name without the unit that it gives."""
    for pattern in _PATTERNS:
        match = pattern.match(name)
        if match and is_unit(match["unit"]):
            return match["name"].strip()
    return name
