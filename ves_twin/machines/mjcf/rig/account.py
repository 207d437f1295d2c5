"""account: an MJCF machine in words: its model's numbers that its file changes, what acts on it."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco

from ves_twin.core.units import unit_tail
from ves_twin.effects.effect import Effect
from ves_twin.effects.place import Place
from ves_twin.machines.mjcf.rig.machine import Rig


def account(rig: Rig) -> dict[str, object]:
    """Identity, numbers over those of the model's file, effects and laws at work, by title."""
    numbers = dict(changed_numbers(rig))
    effects = {e.label: f"{_sizes(e, place)}. {e.meaning()}" for e, place in rig.effects_at({})}
    laws = {law.law.label: law.words for law in rig.description.laws}
    return {
        "machine": rig.description.name,
        "hash": rig.identity,
        "model": str(rig.folder / rig.description.model),
        "numbers over those of the model": numbers,
        "effects": effects,
        **({"laws": laws} if laws else {}),
    }


def changed_numbers(rig: Rig) -> Iterator[tuple[str, str]]:
    """Every number of the model that the machine's file gives another value, with both."""
    path = rig.folder / rig.description.model
    model = mujoco.MjModel.from_xml_path(str(path))
    for entry in rig.entries:
        effect = entry.effect
        if not effect.attribute:
            continue
        before, (now,) = effect.present(model), entry.nominal
        if now != before:
            name, attribute = effect.setting
            unit = unit_tail(entry.magnitudes[0].unit)
            yield f"{attribute} of {effect.element} {name}", f"{before:.6g} -> {now:.6g}{unit}"


def _sizes(effect: Effect, place: Place) -> str:
    sizes = effect.magnitudes_at(place)
    return ", ".join(f"{m.name} = {effect.values[m.name]:.6g}{unit_tail(m.unit)}" for m in sizes)
