"""with_further: an MJCF machine with every sensor that it could have."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ves_twin.machines.mjcf.inputs.inputs import sizes_of
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.parts.joint_units import joint_units
from ves_twin.machines.mjcf.parts.probe import Probe
from ves_twin.machines.mjcf.rig.column import Column
from ves_twin.machines.mjcf.rig.description import Compared, Mode
from ves_twin.machines.mjcf.rig.places import SINGLE

PREFIX = "further "
"""Of their signals: none belongs to a computer of the machine, whose delays are its own."""

FINE = 1e-3
"""Sd of one row, in typical sizes, where the machine has no like sensor: of a usual encoder."""

COARSE = 1e-2
"""The same of efforts, forces and accelerations: of a usual strain gauge."""

GRAVITY = 9.81
"""Acceleration that accelerometers are sized by [m/s^2]. Source: standard gravity, rounded."""


def with_further(forward: MjcfForward) -> MjcfForward:
    """The machine with sensors of position, speed and effort of joints, force and acceleration.

    Of every hinge and slide with typical sizes that moves by itself, each on a clock of its own:
    a second encoder, too. Force and acceleration of every site; efforts of joints that have
    actuators. Noise is that of a like sensor of the machine, else FINE or COARSE.
    """
    told = forward.rig.description
    probes, signals, compared = [], dict(told.signals), dict(told.compare)
    for name, column, at, probe in _candidates(forward):
        signals[name], compared[name] = column, at
        probes += [probe] if probe else []
    rig = replace(
        forward.rig,
        description=told.model_copy(update={"signals": signals, "compare": compared}),
        probes=tuple(probes),
    )
    return MjcfForward(rig, forward.mode)


def _candidates(forward: MjcfForward) -> Iterator[tuple[str, Column, Compared, Probe | None]]:
    model = forward.rig.model
    driven = {forward.joint_of(a) for a in forward.rig.description.drive.actuators}
    driven |= {c.joint for c in forward.rig.description.controllers.values()}
    efforts = []
    for number in range(model.njnt):
        joint = model.joint(number).name
        if int(model.jnt_type[number]) not in SINGLE or joint in forward.imposed:
            continue
        effort, speed, travel = sizes_of(forward, joint)
        units = joint_units(model, joint)
        efforts.append(effort)
        moves = forward.mode is not Mode.MOTION
        for of, unit, size in (("position", units[0], travel), ("speed", units[1], speed)):
            if moves and size > 0.0:
                sd = _like(forward, joint, of) or FINE * size
                yield _one(f"{of} of {joint}", 1, unit, sd, Compared(joint=joint, of=of), None)  # type: ignore[arg-type]
        if moves and joint in driven and effort > 0.0:
            unit = "N*m" if units[0] == "rad" else "N"
            probe = Probe("effort", joint)
            yield _probed(f"effort of {joint}", unit, COARSE * effort, probe)
    if forward.mode is Mode.MOTION:
        return
    weight = float(model.body_subtreemass[0]) * GRAVITY
    for number in range(model.nsite):
        site = model.site(number).name
        if site:
            yield _probed(f"force at {site}", "N", COARSE * weight, Probe("force", site))
            probe = Probe("acceleration", site)
            yield _probed(f"acceleration of {site}", "m/s^2", COARSE * GRAVITY, probe)


def _probed(
    what: str, unit: str, sd: float, probe: Probe
) -> tuple[str, Column, Compared, Probe | None]:
    return _one(what, probe.width, unit, sd, Compared(sensor=probe.name), probe)


def _one(
    what: str, width: int, unit: str, sd: float, at: Compared, probe: Probe | None
) -> tuple[str, Column, Compared, Probe | None]:
    columns = tuple(f"{what} {k + 1}" for k in range(width))
    column = Column(columns=columns, unit=unit, noise=sd, source="assumed")
    return f"{PREFIX}{what}", column, at, probe


def _like(forward: MjcfForward, joint: str, of: str) -> float:
    """Sd of the machine's own sensor of the same sort at a joint; 0 if it has none."""
    for channel in forward.channels:
        at = forward.compared[channel.signal]
        if at.joint == joint and at.of == of:
            return channel.sd
    return 0.0
