"""effects: named deviations of a rig from its description, which diagnosis looks for."""

from ves_twin.effects.arm import (
    CableSpring,
    EncoderOffset,
    JointFriction,
    JointViscous,
    RotorInertia,
    TorqueConstant,
)
from ves_twin.effects.cylinder import CoulombFriction, CylinderViscous, OilAir, PistonLeakage
from ves_twin.effects.effect import Effect
from ves_twin.effects.force_sensor import (
    SensorCrossTalk,
    SensorDrift,
    SensorGain,
    SensorLag,
    SensorMounting,
)
from ves_twin.effects.geometry import AnchorPosition, BaseTilt, HoseStiffness
from ves_twin.effects.payload import LinkCentre, LinkMass, PayloadMass
from ves_twin.effects.supply import SupplyDroop, SupplyPressure
from ves_twin.effects.transducer import LengthOffset, LengthScale
from ves_twin.effects.valve import ValveDeadband, ValveGain, ValveLag, ValveNull

__all__ = [
    "AnchorPosition",
    "BaseTilt",
    "CableSpring",
    "CoulombFriction",
    "CylinderViscous",
    "Effect",
    "EncoderOffset",
    "HoseStiffness",
    "JointFriction",
    "JointViscous",
    "LengthOffset",
    "LengthScale",
    "LinkCentre",
    "LinkMass",
    "OilAir",
    "PayloadMass",
    "PistonLeakage",
    "RotorInertia",
    "SensorCrossTalk",
    "SensorDrift",
    "SensorGain",
    "SensorLag",
    "SensorMounting",
    "SupplyDroop",
    "SupplyPressure",
    "TorqueConstant",
    "ValveDeadband",
    "ValveGain",
    "ValveLag",
    "ValveNull",
]
