"""Claim: one quantitative statement of the thesis, from models/thesis/claims.toml."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.resources import find_resource
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.thesis.tolerance import Comparison, Tolerance

SCHEMA = 1


class Kind(StrEnum):
    """What sort of statement a claim is; an input is given to the twin and proves nothing."""

    INPUT = "input"
    DERIVED = "derived"
    SIMULATION = "simulation"
    EXPERIMENT = "experiment"
    RULE = "rule"


@dataclass(frozen=True)
class Claim:
    """One statement and what reproducing it asks.

    Attributes:
        id: C001 to C132.
        where: section, table, equation or figure.
        chapter: chapter number or appendix letter.
        quantity: what is stated.
        printed: the value as the thesis prints it.
        unit: unit of the values; one for all, or one for each group.
        kind: what sort of statement it is.
        value: the printed value as numbers in `unit`; empty where the thesis has words.
        corrected: what it must be by the errata; empty where the print is right.
        tolerance: what reproduces it; None where the thesis has words only.
        in_kind: what still says the same in words.
        errata: errata that touch it.
        calibrated_on: numbers of the twin that were tuned on it; empty if none.
        figure: figure that shows it, for instance "fig-5-12".
    """

    id: str
    where: str
    chapter: str
    quantity: str
    printed: str
    unit: str
    kind: Kind
    value: tuple[float, ...] = ()
    corrected: tuple[float, ...] = ()
    tolerance: Tolerance | None = None
    in_kind: Tolerance | None = None
    errata: tuple[str, ...] = ()
    calibrated_on: str = ""
    figure: str = ""

    @property
    def expected(self) -> tuple[float, ...]:
        """What the twin is held against: the printed value, or what the errata make of it."""
        return self.corrected or self.value

    @property
    def counts(self) -> bool:
        """Whether it counts in the score: neither an input nor used in calibration."""
        return self.kind is not Kind.INPUT and not self.calibrated_on


def load_claims(name_or_path: str = "claims") -> dict[str, Claim]:
    """Every claim by id, in the order of the thesis.

    Args:
        name_or_path: a file of models/thesis/, or a path to one.

    Raises:
        VesTwinError: the file is missing, or holds something that is no claim.
    """
    path = find_resource("claims file", "models/thesis", name_or_path)
    content, _ = read_toml("claims file", path)
    check_schema(content, path, SCHEMA)
    return {name: _claim(name, entry, path) for name, entry in content.items() if name != "schema"}


_TEXTS = ("where", "chapter", "quantity", "printed", "unit")
_KEYS = {
    *_TEXTS,
    *("kind", "value", "corrected", "tolerance", "in_kind", "errata", "calibrated_on", "figure"),
}


def _claim(name: str, entry: Any, path: Path) -> Claim:
    if not isinstance(entry, Mapping):
        raise InvalidInputError(f"{path.name}: {name}", entry, "a table")
    for key in entry:
        if key not in _KEYS:
            raise UnknownNameError(f"key of {name}", key, _KEYS)
    for key in _TEXTS:
        if not isinstance(entry.get(key), str) or not entry[key]:
            raise InvalidInputError(f"{path.name}: {name}.{key}", entry.get(key), "a text")
    if entry.get("kind") not in set(Kind):
        raise UnknownNameError(f"kind of {name}", str(entry.get("kind")), set(Kind))
    return Claim(
        id=name,
        **{key: entry[key] for key in _TEXTS},
        kind=Kind(entry["kind"]),
        value=_numbers(entry.get("value", ()), f"{name}.value"),
        corrected=_numbers(entry.get("corrected", ()), f"{name}.corrected"),
        tolerance=_tolerance(entry.get("tolerance"), f"{name}.tolerance"),
        in_kind=_tolerance(entry.get("in_kind"), f"{name}.in_kind"),
        errata=tuple(map(str, entry.get("errata", ()))),
        calibrated_on=str(entry.get("calibrated_on", "")),
        figure=str(entry.get("figure", "")),
    )


def _tolerance(entry: Any, what: str) -> Tolerance | None:
    if entry is None:
        return None
    if not isinstance(entry, Mapping) or entry.get("kind") not in set(Comparison):
        raise InvalidInputError(what, entry, f"a table with kind = {', '.join(Comparison)}")
    bounds = {key: _numbers(entry[key], what)[0] for key in ("low", "high") if key in entry}
    return Tolerance(Comparison(entry["kind"]), _numbers(entry.get("limit", ()), what), **bounds)


def _numbers(value: Any, what: str) -> tuple[float, ...]:
    items = value if isinstance(value, list | tuple) else [value]
    if any(isinstance(item, bool) or not isinstance(item, int | float) for item in items):
        raise InvalidInputError(what, value, "a number or a list of numbers")
    return tuple(float(item) for item in items)
