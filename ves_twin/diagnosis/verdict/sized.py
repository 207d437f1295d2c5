"""sized, is_ended, is_dead, is_below_row: sizes of what is proved, and what ranges say of names."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from ves_twin.diagnosis.build_up.result import BuildUp, Proved, Size
from ves_twin.diagnosis.verdict.cause import Cause, Estimate

NEAR = 0.1
"""Share of an interval within which its size is at an end of its range: bounds hold it there."""


def sized(
    built: BuildUp,
    causes: Sequence[Cause],
    ends: Mapping[str, tuple[float, float]],
    row: float = 0.0,
    components: Collection[str] = (),
) -> tuple[Proved, ...]:
    """What is proved with its sizes.

    Firm only where it passes the test by itself, too, no commissioning error explains it either,
    and no interval holds the value that the model has already: a shape that is known so little is
    not known by name; of a vector one size must be away from it. Nor where an interval reaches an
    end of its range, which then says the size in place of the record, nor a delay below a row,
    which the clock of the recordings may have, nor a kind of SUBLINEAR that is less than none; and
    as others leave it (`Proved.beside`). What full simulation fits to nothing is left out: its
    column improved the prediction, its effect does not.

    Args:
        built: what is proved.
        causes: with sizes.
        ends: of the range of each parameter.
        row: from one row of the recordings to the next [s].
        components: parameters that are one of a vector.
    """
    named = {f"{cause.effect}@{cause.target}": cause for cause in causes}
    found = []
    for one in built.proved:
        cause = named[one.label]
        if all(e.value == e.nominal for e in cause.parameters.values()):
            continue
        sizes = {
            name: Size(e.value, e.low, e.high, e.unit, e.nominal)
            for name, e in cause.shortened.parameters.items()
        }
        away = {n: not e.low <= e.nominal <= e.high for n, e in cause.parameters.items()}
        known = any(away.values()) and all(away[n] for n in away if n not in components)
        known = known and one.p <= built.false_discovery_rate  # many that are sure raise its limit
        ended = any(is_ended(e, *ends[name]) for name, e in cause.parameters.items())
        wide = not ended and any(_reaches(e, *ends[name]) for name, e in cause.parameters.items())
        below = any(is_below_row(name, e, row) for name, e in cause.parameters.items())
        firm = one.firm and cause.firm and known and not (ended or wide or below)
        told = replace(one, parameters=sizes, ended=ended, wide=wide, below_row=below)
        found.append(replace(told, firm=firm and not told.sublinear))
    return tuple(one.beside(found) for one in found)


def is_ended(size: Estimate, low: float, high: float) -> bool:
    """Whether a size is at an end of its range, by the width of its interval."""
    near = NEAR * (size.high - size.low)
    return _reaches(size, low, high) and not low + near < size.value < high - near


def is_dead(size: Estimate) -> bool:
    """Whether a gain is none at all, as of a motor that is off: that end is no assumption."""
    return size.unit == "1" and abs(size.value) < NEAR * abs(size.nominal)


def _reaches(size: Estimate, low: float, high: float) -> bool:
    """Whether an interval reaches an end of the range that is not what the model has already."""
    return (size.low <= low < size.nominal) or (size.high >= high > size.nominal)


def is_below_row(name: str, size: Estimate, row: float) -> bool:
    """Whether this is a delay that may be less than a row: the near end of its interval is."""
    near = min(abs(size.low - size.nominal), abs(size.high - size.nominal))
    return name.rpartition(":")[2] == "delay" and near < row
