"""further_text: further sensors by what they would tell, for the terminal."""

from __future__ import annotations

from ves_twin.core.quantity import quantity
from ves_twin.diagnosis.experiment.further_channel import Further
from ves_twin.report.diagnosis.words import spoken

MOST = 15
"""Sensors that are printed; all of them are in the JSON."""

PAIRS = 8
"""Pairs that are printed."""


def further_text(further: Further) -> str:
    """What is confused now, and what each further sensor would tell of it."""
    count = len(further.pairs)
    rows = [("one more channel", "its noise", "separation", "newly told apart", "still confused")]
    rows += [
        (
            one.channel,
            quantity(one.sd, one.unit),
            f"{one.sigma:.3g} sigma",
            str(one.told),
            str(one.left),
        )
        for one in further.gained[:MOST]
    ]
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    table = ["  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in rows]
    more = len(further.gained) - MOST
    return "\n".join(
        [
            f"plan      {further.programme}, {len(further.recorded)} columns recorded",
            "rests on  the declared noise and tolerances; noise of sensors that the machine does"
            " not have is assumed",
            f"now       {count} pairs of causes are confused up to some size, {further.never} of"
            f" them at any; all together {further.sigma:.3g} sigma apart",
            *(f"            {spoken(a)} / {spoken(b)}" for a, b in further.pairs[:PAIRS]),
            *([f"            and {count - PAIRS} more (--json has all)"] if count > PAIRS else []),
            "",
            *(f"  {line.rstrip()}" for line in table),
            *([f"  and {more} more (--json has all)"] if more > 0 else []),
        ]
    )
