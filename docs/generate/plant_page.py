"""plant_page: the plant file, its keys, and every number of VES II."""

from __future__ import annotations

import numpy as np

from ves_twin.plant.parameters import Parameter
from ves_twin.plant.plant import Plant

_HEAD = """# Plant

TOML in `models/`, loaded by `--plant NAME_OR_FILE`, `Plant.load` or the scenario's `plant`. Every number has its unit, what commissioning leaves open,
how it came about and from where; a number without them is refused.

    schema = 1
    name = "ves2"

    [platform.mass]
    value = 60.0                  # a number, a text with a unit, or nested lists
    unit = "kg"
    sd = 0.5                      # one sigma, one for all or one for each value
    low = 1.0                     # bounds; left out: none
    grade = "assumed"             # thesis, derived, calibrated, assumed
    source = "why this number"
    each = "leg"                  # only where each leg has its own: one number or six

A plant that differs in a few numbers names its base:

    schema = 1
    name = "my_rig"
    base = "ves2"
    hydraulic_model = "pressure"  # or "linear"
    fidelity = "fast"             # or "full"

    [parameters]
    "platform.mass" = "65 kg"

    [effects.length_offset."leg.3"]
    offset = 0.001

`ves-twin info --plant my_rig.toml` says what it changes.

## Numbers of ves2

| name | value | unit | sd | grade | source |
|---|---|---|---|---|---|
"""


def plant_page() -> str:
    """Keys by example, then the table of the shipped plant."""
    rows = [_row(parameter) for parameter in Plant.load("ves2").parameters.values()]
    return _HEAD + "\n".join(rows) + "\n"


def _row(p: Parameter) -> str:
    source = _plain(" ".join(p.source.split()))
    cells = (f"`{p.name}`", _number(p.value), _plain(p.unit), _number(p.sd), p.grade, source)
    return f"| {' | '.join(cells)} |"


def _plain(text: str) -> str:
    """Text whose stars are no emphasis and whose bars are no cells."""
    return text.replace("*", "\\*").replace("|", "\\|")


def _number(value: np.ndarray) -> str:
    flat = np.unique(value)
    if flat.size == 1:
        return f"{flat[0]:.6g}"
    return np.array2string(value, formatter={"float_kind": "{:.4g}".format}, max_line_width=10**6)
