"""write_plant: a plant as a file that loads again, what differs from a shipped one."""

from __future__ import annotations

from pathlib import Path

from ves_twin.core.toml_file import write_toml
from ves_twin.effects.registry import effects_table
from ves_twin.plant.parameters import SCHEMA
from ves_twin.plant.plant import Plant


def write_plant(plant: Plant, path: Path, note: str = "", name: str = "") -> None:
    """Write a plant; what was there is replaced only when the new file is whole.

    Args:
        plant: changed numbers, effects and laws over the shipped plant of its form and fidelity.
        path: a .toml file.
        note: comment on the first lines.
        name: of the plant; that of the file if left out.

    Raises:
        FileAccessError: not writable.
    """
    content: dict[str, object] = {"schema": SCHEMA, "name": name or path.stem, "base": plant.base}
    changes, effects = plant.changes(), effects_table(plant.effects)
    content |= {"parameters": changes} if changes else {}
    content |= {"effects": effects} if effects else {}
    laws = [law.model_dump(mode="json") for law in plant.told_laws]
    content |= {"laws": laws} if laws else {}
    write_toml(path, content, note)
