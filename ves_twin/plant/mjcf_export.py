"""mjcf_of: a plant as one plain MJCF file, and what such a file cannot carry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ves_twin.core.mjcf_export import MjcfExport
from ves_twin.plant.assembly import assemble, compile_model
from ves_twin.plant.plant import Plant

POINT_INERTIA = 1e-9
"""Inertia [kg m^2] given to point masses: MuJoCo writes no mass of a body that has none."""

NEVER = (
    "valves, cylinders, oil and supply: an actuator of a leg is a plain motor and takes the"
    " cylinder's force in N",
    "transducers and encoders: their noise, resolution, offsets and periods",
    "the chain of the force sensor: low-pass, calibration, cross-talk, noise, drift; the sensors"
    " force and torque give what acts on the sensor's plate, in MuJoCo's sign",
    "the computers: leg loops, admittance, gravity compensation, the arm's joint servo, their rates"
    " and delays",
    "units, tolerances, grades and sources of the numbers",
)
"""What no MJCF file of the rig has."""


def mjcf_of(plant: Plant) -> MjcfExport:
    """The rig at home with its legs' motors at rest, without anything of this package around it.

    Masses, inertias, joints, closures, dry friction and damping are the plant's, at MJCF's seven
    digits. A change counts as carried if the file differs without it.

    Raises:
        InvalidInputError: numbers that no rigid body can have.
    """
    body = _xml(plant)
    carried: list[str] = []
    lost: list[str] = []
    for name, without in _without(plant):
        (carried if _xml(without) != body else lost).append(name)
    title = f"{plant.name}, exported by ves_twin; plant hash {plant.hash}."
    return MjcfExport.of(title, body, carried, lost, NEVER)


def _xml(plant: Plant) -> str:
    spec = assemble(plant, plant.parameters.number("clock.tick"))
    model = compile_model(spec)
    for body in spec.bodies:
        if body.explicitinertial and body.mass > 0.0 and not np.any(body.inertia):
            body.ipos = model.body(body.name).ipos
            body.inertia = np.full(3, POINT_INERTIA)
    compile_model(spec)
    return str(spec.to_xml())


def _without(plant: Plant) -> Iterator[tuple[str, Plant]]:
    """Every change of a plant by name, and the plant without it."""
    for effect in plant.effects:
        rest = tuple(e for e in plant.effects if e is not effect)
        yield effect.label, replace(plant, effects=rest)
    for law in plant.told_laws:
        others = tuple(one for one in plant.told_laws if one is not law)
        yield f"law {law.law.label}", replace(plant, told_laws=others)
    base = Plant.load(plant.base).parameters
    for name in plant.changes():
        yield name, plant.with_values({name: base.array(name)})
