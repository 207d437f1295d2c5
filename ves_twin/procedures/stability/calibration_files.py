"""write_fit: a calibration as JSON, as a plant file and as entries for models/*.toml."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ves_twin.core.json_text import json_text
from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import write_whole
from ves_twin.plant.plant import Plant
from ves_twin.plant.write_plant import write_plant
from ves_twin.procedures.stability.feasible import Feasible

SOURCE = "docs/calibration.md"


@dataclass(frozen=True)
class Fit:
    """What a calibration found.

    Attributes:
        plant: the plant it started from.
        names: of the fitted numbers (p).
        start: values before (p,).
        values: values after (p,).
        spread: half the range over which all claims hold, the others fixed; nan if one does not.
        claims: value of each claim at the fit.
        region: margins and sensitivities at the fit.
        history: worst margin of each accepted round.
        at_ends: worst margin at both ends of each number's range, measured.
    """

    plant: Plant
    names: tuple[str, ...]
    start: FloatArray
    values: FloatArray
    spread: FloatArray
    claims: Mapping[str, float]
    region: Feasible
    history: tuple[float, ...]
    at_ends: Mapping[str, list[float]]


def write_fit(fit: Fit, bounds: Mapping[str, str], folder: Path) -> list[str]:
    """Write `calibration.json`, `plant.toml` and `entries.toml`; lines for a person.

    Args:
        fit: what was found.
        bounds: bounds of each claim as text.
        folder: an existing folder.
    """
    region = fit.region
    conflicts = region.conflicts()
    content = {
        "plant": fit.plant.name,
        "claims": {n: {"value": v, "bounds": bounds[n]} for n, v in fit.claims.items()},
        "numbers": {
            name: {
                "start": float(fit.start[i]),
                "value": float(fit.values[i]),
                "spread": None if np.isnan(fit.spread[i]) else float(fit.spread[i]),
                "worst_margin_at_ends": fit.at_ends.get(name),
            }
            for i, name in enumerate(fit.names)
        },
        "worst_margin_of_each_round": list(fit.history),
        "margins": dict(zip(region.names, region.margins.tolist(), strict=True)),
        "sensitivities": {
            n: dict(zip(fit.names, row, strict=True))
            for n, row in zip(region.names, region.jacobian.tolist(), strict=True)
        },
        "conflicts": [{"one": a, "other": b, "cosine": c} for a, b, c in conflicts],
    }
    text = json_text(content)
    write_whole(folder / "calibration.json", text + "\n")
    write_plant(_fitted(fit), folder / "plant.toml", name=f"{fit.plant.name}_calibrated")
    write_whole(folder / "entries.toml", _entries(fit))
    return [*_claim_lines(fit, bounds), "", *_number_lines(fit), "", *_conflict_lines(conflicts)]


def _fitted(fit: Fit) -> Plant:
    """The plant with the fitted numbers, in the four digits that they deserve."""
    return fit.plant.with_values({name: float(f"{value:.4g}") for name, value in _of_plant(fit)})


def _entries(fit: Fit) -> str:
    blocks = []
    for name, value in _of_plant(fit):
        parameter = fit.plant.parameters[name]
        spread = fit.spread[fit.names.index(name)]
        sd = float(np.max(parameter.sd)) if np.isnan(spread) else float(spread)
        low = f"low = {parameter.low:g}\n" if np.isfinite(parameter.low) else ""
        blocks.append(
            f'[{name}]\nvalue = {value:.4g}\nunit = "{parameter.unit}"\nsd = {sd:.2g}\n{low}'
            f'grade = "calibrated"\nsource = "{SOURCE}"\n'
        )
    return "\n".join(blocks)


def _of_plant(fit: Fit) -> list[tuple[str, float]]:
    pairs = zip(fit.names, fit.values.tolist(), strict=True)
    return [(n, v) for n, v in pairs if n in fit.plant.parameters]


def _claim_lines(fit: Fit, bounds: Mapping[str, str]) -> list[str]:
    lines = ["  claim                      value   asked            margin"]
    for name, value in fit.claims.items():
        own = [
            m for n, m in zip(fit.region.names, fit.region.margins, strict=True)
            if n.rsplit(" ", 1)[0] == name
        ]  # fmt: skip
        lines.append(f"  {name:24s} {value:7.3f}   {bounds[name]:16s} {min(own):+6.2f}")
    return lines


def _number_lines(fit: Fit) -> list[str]:
    lines = ["  number                         start      fitted    +- range   margins at its ends"]
    for i, name in enumerate(fit.names):
        ends = fit.at_ends.get(name)
        shown = "" if ends is None else f"{ends[0]:+.2f}, {ends[1]:+.2f}"
        lines.append(
            f"  {name:26s} {fit.start[i]:10.4g}  {fit.values[i]:10.4g}  {fit.spread[i]:10.2g}"
            f"   {shown}"
        )
    return lines


def _conflict_lines(conflicts: list[tuple[str, str, float]]) -> list[str]:
    lines = ["  what pulls against what (cosine of the margins' gradients)"]
    lines += [f"  {a:26s} {b:26s} {cosine:+.2f}" for a, b, cosine in conflicts]
    return lines
