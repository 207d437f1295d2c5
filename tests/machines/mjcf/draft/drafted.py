"""drafted, changed, scales: a log with other columns, and what `new` makes of it."""

from __future__ import annotations

from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.mjcf.rig.machine import Rig


def drafted(arm, log, rate=None):
    found = draft(arm, [log], arm.with_name("my.toml"), rate)
    arm.with_name("my.toml").write_text(found.text)
    return found, Rig.load(str(arm.with_name("my.toml")))


def changed(columns, **new):
    return {name: new.get(name, values) for name, values in columns.items()}


def scales(rig):
    return {n: c.scale for n, c in rig.description.signals.items()}
