"""account: a plant of VES II in words: grades of its numbers, and what differs from nominal."""

from __future__ import annotations

from ves_twin.core.units import unit_tail
from ves_twin.effects.effect import Effect
from ves_twin.plant.parameters import ParameterTable
from ves_twin.plant.plant import NOMINAL, Plant


def account(plant: Plant) -> dict[str, object]:
    """Identity, grades of its numbers, and every difference from the nominal rig, by title."""
    grades: dict[str, str] = {}
    for parameter in plant.parameters.values():
        count = int(grades.get(parameter.grade.value, "0")) + 1
        grades[parameter.grade.value] = str(count)
    laws = {law.law.label: law.words for law in plant.told_laws}
    nominal = Plant.load(NOMINAL).parameters
    return {
        "plant": plant.name,
        "hash": plant.hash,
        "fidelity": plant.fidelity.value,
        "hydraulics": plant.hydraulics.value,
        "numbers by grade": grades,
        f"differences from {NOMINAL}": _changed(plant.parameters, nominal),
        "effects": {e.label: f"{_values(e)}. {e.meaning()}" for e in plant.effects},
        "numbers that the effects change": _changed(plant.actual, plant.parameters),
        **({"laws": laws} if laws else {}),
    }


def _values(effect: Effect) -> str:
    sizes = effect.magnitudes_of(effect.target)
    return ", ".join(f"{m.name} = {effect.values[m.name]:g}{unit_tail(m.unit)}" for m in sizes)


def _changed(here: ParameterTable, there: ParameterTable) -> dict[str, object]:
    return {
        name: {"nominal": before.tolist(), "here": now.tolist(), "unit": here[name].unit}
        for name, (now, before) in here.differences(there).items()
    }
