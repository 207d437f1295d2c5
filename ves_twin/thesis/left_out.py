"""plant_without: the rig calibrated without one claim, for an honest prediction of it.

A claim that the twin's numbers were tuned on proves nothing. What does is the value that a rig
tuned on all *other* claims predicts for it. The calibration writes such a rig for each claim as
models/thesis/left_out/CLAIM.toml, a plant file with a base and the values that differ.
"""

from __future__ import annotations

from collections.abc import Callable

from ves_twin.core.resources import resource_folder
from ves_twin.plant.plant import Plant

FOLDER = "thesis/left_out"

PlantWithout = Callable[[str], Plant | None]
"""Claim id -> the rig calibrated without it, or None where that has not been done."""


def plant_without(claim: str) -> Plant | None:
    """The rig that the calibration found without a claim; None if it has not been run.

    Raises:
        VesTwinError: its file is no plant.
    """
    path = resource_folder("models") / FOLDER / f"{claim}.toml"
    return Plant.load(str(path)) if path.is_file() else None
