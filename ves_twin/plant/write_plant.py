"""write_plant: a plant as a file that loads again, what differs from a shipped one."""

from __future__ import annotations

import json
from pathlib import Path

from ves_twin.core.whole_file import write_whole
from ves_twin.effects.registry import effects_table
from ves_twin.plant.parameters import SCHEMA
from ves_twin.plant.plant import Plant


def write_plant(plant: Plant, path: Path, note: str = "", name: str = "") -> None:
    """Write a plant; what was there is replaced only when the new file is whole.

    Args:
        plant: changed numbers and effects over the shipped plant of its form and fidelity.
        path: a .toml file.
        note: comment on the first lines.
        name: of the plant; that of the file if left out.

    Raises:
        FileAccessError: not writable.
    """
    lines = [f"# {line}" for line in note.splitlines()]
    lines += [
        f"schema = {SCHEMA}",
        f"name = {json.dumps(name or path.stem)}",
        f'base = "{plant.base}"',
    ]
    changes = plant.changes()
    if changes:
        lines += ["", "[parameters]"]
        lines += [f"{json.dumps(key)} = {json.dumps(value)}" for key, value in changes.items()]
    for kind, targets in effects_table(plant.effects).items():
        for target, values in targets.items():
            lines += ["", f"[effects.{kind}.{json.dumps(target)}]"]
            lines += [f"{key} = {value!r}" for key, value in values.items()]
    write_whole(path, "\n".join(lines) + "\n")
