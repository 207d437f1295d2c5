"""Claim: one quantitative statement of the thesis, from models/thesis/claims.toml."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import Annotated

from pydantic import Field, ValidationError

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.refusal import refusal
from ves_twin.core.resources import find_resource
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.scenario.fields import Part, named
from ves_twin.thesis.tolerance import Numbers, Tolerance

SCHEMA = 1


class Kind(StrEnum):
    """What sort of statement a claim is; an input is given to the twin and proves nothing."""

    INPUT = "input"
    DERIVED = "derived"
    SIMULATION = "simulation"
    EXPERIMENT = "experiment"
    RULE = "rule"


Text = Annotated[str, Field(min_length=1)]


class Claim(Part):
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
    where: Text
    chapter: Text
    quantity: Text
    printed: Text
    unit: Text
    kind: Annotated[Kind, named("kind of claim", [kind.value for kind in Kind])]
    value: Numbers = ()
    corrected: Numbers = ()
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


def _claim(name: str, entry: object, path: Path) -> Claim:
    if not isinstance(entry, Mapping):
        raise InvalidInputError(f"{path.name}: {name}", entry, "a table")
    try:
        return Claim.model_validate({"id": name, **entry})
    except ValidationError as error:
        raise refusal(error, f"{path.name}: {name}", Claim) from None
