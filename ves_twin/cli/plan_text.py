"""plan_text: a plan for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from ves_twin.core.quantity import UNSURE, quantity
from ves_twin.diagnosis.experiment.aliases import Lookalike
from ves_twin.diagnosis.experiment.plan import Plan, Prospect
from ves_twin.report.diagnosis.words import spoken

MOST = 12
"""Look-alikes that are printed; all of them are in the JSON."""


def plan_text(plan: Plan) -> str:
    """What can be found and from which size on, what cannot, and what would be confused."""
    found = [p for p in plan.prospects if p.smallest is not None]
    lost = [p for p in plan.prospects if p.smallest is None]
    signals = dict.fromkeys(name.rstrip("0123456789").rstrip(".") for name in plan.channels)
    lines = [
        f"plan      {plan.programme}, {plan.seconds:.1f} s, {len(plan.channels)} columns"
        f" of {', '.join(signals)}",
        "rests on  the declared noise and the declared tolerances",
        f"detected  means a score above {plan.threshold:.1f}, {_null(plan)}",
        "",
        f"{len(found)} of {len(plan.prospects)} causes would be found, seven times of ten, from"
        " this size on; below the last column's size it may be a tolerance",
        *_table(found),
    ]
    if lost:
        lines += [
            "",
            "such a recording could say nothing about",
            *(f"  {line}" for line in _grouped(lost)),
        ]
    lines += ["", *_confused(plan.lookalikes)]
    return "\n".join(lines)


def _null(plan: Plan) -> str:
    if plan.null == "simulated":
        return "which simulated machines in order hardly ever reach"
    return "which white noise hardly ever reaches; machines in order may ask for more"


def _table(found: Sequence[Prospect]) -> list[str]:
    rows = [("cause", "where", "smallest size", "tolerance", "called a fault from")]
    for (effect, unit), group in groupby(found, key=lambda p: (p.effect, p.unit)):
        some = list(group)
        rows.append(
            (
                effect.replace("_", " "),
                _places([p.target for p in some]),
                _span([p.smallest for p in some], unit),
                _span([p.sd or None for p in some], unit),
                _span([p.firm for p in some], unit),
            )
        )
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return [
        "  " + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def _places(targets: Sequence[str]) -> str:
    if len(targets) < 3:
        return ", ".join(targets)
    return f"{targets[0]} ... {targets[-1]}"


def _span(values: Sequence[float | None], unit: str) -> str:
    known = sorted(value for value in values if value is not None)
    if not known:
        return UNSURE
    low, high = quantity(known[0], unit), quantity(known[-1], unit)
    return low if low == high else f"{low} to {high}"


def _grouped(lost: Sequence[Prospect]) -> list[str]:
    return [
        f"{effect.replace('_', ' ')} at {', '.join(p.target for p in group)}"
        for effect, group in groupby(lost, key=lambda p: p.effect)
    ]


def _confused(pairs: Sequence[Lookalike]) -> list[str]:
    if not pairs:
        return ["no two causes would be taken for one another"]
    ranked = sorted(pairs, key=lambda pair: pair.beyond is not None)
    lines = [f"{len(pairs)} pairs of a cause and what it would be taken for, and up to which size"]
    for pair in ranked[:MOST]:
        size = "at any size" if pair.beyond is None else f"up to {quantity(pair.beyond, pair.unit)}"
        lines.append(f"  {spoken(pair.cause)} for {spoken(pair.other)}, {size}")
    if len(pairs) > MOST:
        lines.append(f"  and {len(pairs) - MOST} more (--json has all)")
    return lines
