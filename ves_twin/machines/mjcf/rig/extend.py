"""extended and write_rig: a rig with what a verdict named, as an object and as a file."""

from __future__ import annotations

import os
from pathlib import Path

from ves_twin.core.toml_file import write_toml
from ves_twin.diagnosis.law.finding import SOURCE
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.effects.law_table import put_over
from ves_twin.machines.claimed_law import claimed_laws
from ves_twin.machines.mjcf.rig.description import KIND, SCHEMA, Setting
from ves_twin.machines.mjcf.rig.entry import Entry
from ves_twin.machines.mjcf.rig.load_description import shipped_rigs
from ves_twin.machines.mjcf.rig.machine import Rig


def extended(rig: Rig, verdict: Verdict) -> Rig:
    """The rig with a verdict's causes, and its commissioning numbers as they were tuned beside.

    The held-out gain was measured with both, so that one without the other would not have it.
    """
    values: dict[str, float] = {}
    for cause in verdict.causes:
        at = f"{cause.effect}@{cause.target}"
        values |= {f"{at}:{n.rpartition(':')[2]}": e.value for n, e in cause.parameters.items()}
    values |= {name: e.value for name, e in verdict.tuned.items()}  # fitted beside a law, if any
    settings = {_place(s): s for s in rig.description.parameters}
    present = {kind: dict(t) for kind, t in rig.description.present.items()}
    for entry in rig.entries:
        moved = {m.name: values[entry.name(m)] for m in entry.magnitudes if entry.name(m) in values}
        if not moved:
            continue
        if entry.effect.attribute:
            (value,) = moved.values()
            new = _setting(entry, value, settings)
            settings[_place(new)] = new
        else:
            present.setdefault(entry.effect.kind, {})[entry.effect.target] = moved
    named = [one.scaled(values[one.name]) for one in rig.promoted if one.name in values]
    laws = put_over(rig.description.laws, [*named, *claimed_laws(verdict)])
    told = rig.description.model_copy(
        update={
            "parameters": tuple(settings.values()),
            "present": present,
            "laws": laws,
        }
    )
    return Rig(told, rig.folder, rig.file)


def _place(setting: Setting) -> tuple[str, ...]:
    return setting.body, setting.joint, setting.actuator, setting.tendon, setting.attribute


def _setting(entry: Entry, value: float, there: dict[tuple[str, ...], Setting]) -> Setting:
    """An attribute of the model at a new value; how well it is known stays as it was."""
    name, attribute = entry.effect.setting
    new = Setting.model_validate({"attribute": attribute, str(entry.effect.element): name})
    old = there.get(_place(new), new)
    return old.model_copy(update={"value": value, "source": SOURCE})


def write_rig(rig: Rig, path: Path, note: str = "") -> None:
    """Write what a rig has over the file it was loaded from, as a file that loads again.

    Raises:
        FileAccessError: not writable.
    """
    before = Rig.load(rig.file).description
    shipped = rig.file in shipped_rigs()
    base = rig.file if shipped else os.path.relpath(Path(rig.file), path.parent)
    content: dict[str, object] = {"schema": SCHEMA, "kind": KIND, "base": base}
    changed = [s for s in rig.description.parameters if s not in before.parameters]
    if changed:
        content["parameters"] = [s.model_dump(mode="json", exclude_defaults=True) for s in changed]
    if rig.description.present:
        content["present"] = rig.description.present
    if rig.description.laws:
        content["laws"] = [law.model_dump(mode="json") for law in rig.description.laws]
    write_toml(path, content, note)
