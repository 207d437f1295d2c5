"""effects_line: every kind of effect, in wider ranges where a log asks for more than is usual."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco

from ves_twin.effects.bodies import LOAD
from ves_twin.machines.mjcf.draft.check import Checked
from ves_twin.machines.mjcf.draft.estimates import two_digits
from ves_twin.machines.mjcf.draft.spots import Quantity
from ves_twin.machines.mjcf.draft.toml_text import toml_text
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.rig.places import carries

HEAVY = 1.4
"""Times what the model needs from which on a body's usual range, half of its mass, may be short."""

DELAY, ROWS = 0.05, 3.0
"""Largest delay that effects have by themselves [s], and rows of a log that one may be at least: at
10 Hz 50 ms are less than a row."""

WIDER = 2.0
"""Times a constant effort that the log shows which its range holds."""


def effects_line(check: Checked, model: mujoco.MjModel, period: float) -> str:
    """The line of a file.

    A body's mass is in a wider range where its joint asks for more than that. On the last body of
    an arm a load is, where the efforts ask for more than it has: as a mass of that body a tool puts
    off the masses of those before it (a measured arm, 0.5 kg at 5 cm). So are delays of a slow log,
    and a constant effort that the model lacks.

    Args:
        check: what the log says.
        model: of the machine.
        period: of the log's rows [s].
    """
    own = [*_bodies(check, model), *_delays(check, period)]
    own += [
        (f'"force_offset", on = [{toml_text(joint)}], largest = "{most:g} {unit}"', joint)
        for joint, size in check.offsets.items()
        for most, unit in [(two_digits(WIDER * size), _unit(model, joint))]
    ]
    told = "".join(f"{{ kind = {words} }}, " for words, _ in own)
    why = "every one that the model has a place for"
    names = list(dict.fromkeys(name for _, name in own if name))
    why += f"; {', '.join(names)}: by the efforts in the log" * bool(names)
    why += "; delays: some rows of a slow log" * any("delay" in words for words, _ in own)
    return f'effects = [{told}{{ kind = "*", on = ["*"] }}]   # {why}'


def _bodies(check: Checked, model: mujoco.MjModel) -> Iterator[tuple[str, str]]:
    heavy, loaded = dict[str, float](), dict[str, float]()
    for joint, times in check.times.items():
        body = int(model.joint(joint).bodyid[0])
        known = model.body(body).name and model.body_mass[body] > 0.0
        if times > HEAVY and known and not carries(model, body):
            heavy[model.body(body).name] = 2.0 * (times - 1.0) * float(model.body_mass[body])
    for name, load in check.lifts.items():
        if load.heavier:
            loaded[name] = load.most
        elif load.most > LOAD * float(model.body(name).mass[0]):
            heavy[name] = load.most
    for kind, some in (("payload", loaded), ("body_mass", heavy)):
        for name, most in some.items():
            on = toml_text(name)
            yield f'"{kind}", on = [{on}], largest = "{two_digits(most):g} kg"', name


def _delays(check: Checked, period: float) -> Iterator[tuple[str, str]]:
    efforts = (m for m in check.found if m.spot.quantity is Quantity.EFFORT)
    names = list(dict.fromkeys(m.spot.name for m in efforts))
    if ROWS * period > DELAY and names:
        on = toml_text(names)
        yield f'"actuator_delay", on = {on}, largest = "{two_digits(ROWS * period):g} s"', ""


def _unit(model: mujoco.MjModel, joint: str) -> str:
    return "N" if joint_units(model, joint)[0] == "m" else "N*m"
