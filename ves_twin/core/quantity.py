"""quantity: an SI number as a person reads it: three digits and a prefix."""

from __future__ import annotations

import math

from ves_twin.core.units import PLAIN

PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n"))

UNSURE = "-"
"""What stands for a number that is not there."""


def quantity(value: float | None, unit: str, figures: int = 3) -> str:
    """A number with its unit and a prefix such as "0.31 mm"; "-" for none.

    Args:
        value: in `unit`.
        unit: SI unit; a product such as N*m takes the prefix on its first factor. Powers and
            products of kilograms take none.
        figures: significant digits.
    """
    if value is None or not math.isfinite(value):
        return UNSURE
    if unit in PLAIN:
        return f"{value:.{figures}g}"
    size = abs(value)
    if size == 0.0:
        return f"0 {_shown(unit)}"
    if unit == "kg" and size < 0.9995:
        value, unit, size = 1e3 * value, "g", 1e3 * size
    first = unit.split("/")[0].split("*")[0]
    if first.startswith("kg") or "^" in first:
        return f"{value:.{figures}g} {_shown(unit)}"
    factor, prefix = next(((f, p) for f, p in PREFIXES if size >= 0.9995 * f), PREFIXES[-1])
    if prefix == "k" and unit.startswith("N") and size < 1e4:
        return f"{value:.{max(figures, 4)}g} {_shown(unit)}"  # 1500 N reads better than 1.5 kN
    return f"{value / factor:.{figures}g} {prefix}{_shown(unit)}"


def digits(value: float | None, form: str = ".3g") -> str:
    """A number without unit; "-" for none."""
    return UNSURE if value is None or not math.isfinite(value) else format(value, form)


def percent(share: float | None) -> str:
    """A share as percent with two digits; "-" for none."""
    if share is None or not math.isfinite(share):
        return UNSURE
    if abs(share) >= 0.995:
        return f"{100.0 * share:.0f} %"
    return f"{100.0 * share:.2g} %" if abs(share) >= 1e-4 else "< 0.01 %"


def shares(*values: float | None) -> list[str]:
    """Shares as percent, all with as many decimals as tell them from one another and from one."""
    there = [v for v in values if v is not None and math.isfinite(v)]
    for decimals in range(4):
        told = [f"{100.0 * v:.{decimals}f}" for v in there]
        clear = len(set(told)) == len({round(v, 5) for v in there})
        whole = f"{100:.{decimals}f}"
        if clear and all(t != whole or v >= 1.0 for t, v in zip(told, there, strict=True)):
            break
    return [
        UNSURE if v is None or not math.isfinite(v) else f"{100.0 * v:.{decimals}f} %"
        for v in values
    ]


def _shown(unit: str) -> str:
    return unit.replace("*", " ")
