"""current_label and others: names in files of suites, as they were when those were made."""

from __future__ import annotations

from ves_twin.effects.registry import label_of_today

_NUMBERS = {
    "joint.damping": "viscous_friction@joint:damping",
    "joint.friction": "coulomb_friction@joint:level",
    "joint.stiffness": "joint_spring@joint:stiffness",
    "joint.armature": "rotor_inertia@joint:inertia",
    "link.mass": "body_mass@link:mass",
    "drive.gain": "actuator_gain@drive:gain",
    "sensor.delay": "sensor_delay@joint:delay",
    "command.delay": "actuator_delay@drive:delay",
    "encoder.bias": "sensor_offset@joint.angle.1:offset",
    "drive.offset": "force_offset@joint:offset",
    "start.angle": "start@joint:position",
    "start.rate": "start@joint:speed",
}

_CAUSES = {
    "viscous_damping@joint": "joint.damping",
    "joint_stiffness@joint": "joint.stiffness",
    "link_mass@link": "link.mass",
    "torque_gain@drive": "drive.gain",
    "delay@sensor": "sensor.delay",
    "delay@command": "command.delay",
    "encoder_offset@sensor": "encoder.bias",
}

AGAINST_MOTION = "drive.offset"
"""It drove the joint; a `force_offset` is against its motion."""


def current_label(label: str) -> str:
    """effect@target as the library has it today."""
    if label in _CAUSES:  # the pendulum before it was an MJCF machine
        return _NUMBERS[_CAUSES[label]].partition(":")[0]
    return label_of_today(label)


def current_size(name: str, value: float) -> tuple[str, float]:
    """A parameter and its value as the library has them today."""
    today = _NUMBERS.get(name) or label_of_today(name)
    return today, -value if name == AGAINST_MOTION else value


def current_name(said: str) -> str:
    """effect@target:size as the library has it today."""
    label, _, number = said.rpartition(":")
    return f"{current_label(label)}:{current_size(number, 0.0)[0].rpartition(':')[2]}"


def current_excitation(name: str) -> str:
    """A programme of the menu as it is called today."""
    return name.replace(" rad", " of the travel")
