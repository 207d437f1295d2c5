"""constant_of, words_of_size: efforts of another size than the model needs, and what is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.data.clock.usual_period import is_usual
from ves_twin.machines.mjcf.draft.angles import other_angle
from ves_twin.machines.mjcf.draft.effort_fit import FAR, STRONG, EffortFit
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.milli import ALIKE, THOUSAND

ODD = 50.0
"""Times what the model needs from which on an effort is in another unit, whatever friction does."""

FOREIGN = 1e5
"""Times from which on a column is likely of another quantity: no usual unit is as far off."""

LITTLE = " Where the model needs next to nothing (a balanced wrist), friction does that, too"
"""What is said of an effort that is large and not like that of the model."""


def constant_of(
    log: LogColumns,
    match: Match,
    fit: EffortFit,
    found: list[Match],
    by_inertia: bool,
    noisy: str = "",
) -> tuple[Match, list[str]]:
    """An electrical column with the constant that fits the model, or its own command.

    Args:
        log: the columns.
        match: the column.
        fit: of it.
        found: all columns as they are meant.
        by_inertia: whether inertia alone tells it.
        noisy: what is said where noise is much of what the model needs; empty where it is not.
    """
    if fit.gain <= STRONG and log.is_coarse(match.column):
        coarse = "moves by a few steps of its resolution: no constant is read off it"
        return match, [f"{match.column} {coarse}", *other_angle(log, found, match.spot.joint)]
    if fit.gain <= STRONG and noisy:
        words = f"{match.column}: no constant is read off it: {noisy}"
        return match, [words, *other_angle(log, found, match.spot.joint)]
    scale = 1.0 / fit.slope
    if match.spot.unit == "1" and 1.0 / FAR < abs(scale) / match.prefix < FAR:
        own = float(np.copysign(match.prefix, scale))
        return replace(match, scale=own), [
            f"{match.column} is taken as the command of {match.spot.label} as the model"
            f" has it{', turned' * (scale < 0.0)}; by the model's inertia and weight"
            f" {scale / own:.3g} times it would fit best"
        ]
    unit = match.per
    how = ", turned (or its joint's position counts the other way)" * (scale < 0.0)
    if noisy:
        how += f", and is too large: {noisy}"
    elif by_inertia:
        how += ", by its inertia alone, and is too small by what the rotor adds to that"
    if fit.gain < STRONG and not by_inertia:
        how += f", and explains {fit.gain:.0%} of it beside friction: what the model lacks, as a"
        how += " rotor, is in that number"
    new = replace(match, scale=float(f"{scale:.3g}"))
    said = [
        f"{match.column} is {match.kind}: {abs(scale):.3g} {unit} makes it fit this model{how};"
        f" put {match.asked} there"
    ]
    others = [new if m is match else m for m in found]
    return new, [*said, *other_angle(log, others, match.spot.joint, scale, unit)]


def words_of_size(log: LogColumns, match: Match, fit: EffortFit) -> list[str]:
    """That an effort is of another size than the model's, if it is; of friction no size is."""
    strong, times = fit.strange, abs(fit.slope) if fit.strange else fit.size
    if not (strong or not 1.0 / ODD < times < ODD) or fit.free:
        return []
    if not is_usual(log.period):
        return []
    if not strong and times > ODD and fit.rubs:
        little = "and the model needs next to nothing there: nothing tells its unit"
        return [f"{match.column} is friction, {fit.share:.0%} of it, {little}"]
    turned = ", turned," * (strong and fit.slope < 0.0)
    unit = f" ({_prefixed(match, times)}?)" if strong and _prefixed(match, times) else ""
    return [
        f"{match.column} is {times:.3g} times{turned} what the model needs: another unit{unit},"
        f"{' swapped columns,' * (not 1.0 / FOREIGN < times < FOREIGN)} a gear"
        f"{', a rotor' * (times > 1.0)} or a wrong mass?"
        f"{LITTLE * (not strong and times > ODD)}"
    ]


def _prefixed(match: Match, times: float) -> str:
    """The unit with a prefix that so many times come near to; empty if they come near to none."""
    units = {"m": THOUSAND, "k": 1.0 / THOUSAND}
    near = (p for p, by in units.items() if abs(float(np.log(times / by))) < np.log(ALIKE))
    return next((f"{prefix}{match.unit}" for prefix in near if match.unit in ("N", "N*m")), "")
