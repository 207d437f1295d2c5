"""effects: named deviations of a rig from its description, which diagnosis looks for."""

from ves_twin.effects.arm import (
    CableSpring,
    EncoderOffset,
    JointFriction,
    JointViscous,
    RotorInertia,
    TorqueConstant,
)
from ves_twin.effects.computers import ModelMass, StaleGravity
from ves_twin.effects.cylinder import CoulombFriction, CylinderViscous, OilAir, PistonLeakage
from ves_twin.effects.deployed import CommandLimit, FilterEdge, LegGain, LegRateGain, ServoGain
from ves_twin.effects.effect import Effect
from ves_twin.effects.force_sensor import (
    SensorCrossTalk,
    SensorDrift,
    SensorGain,
    SensorLag,
    SensorMounting,
)
from ves_twin.effects.geometry import AnchorPosition, BaseTilt, HoseStiffness, LegBending
from ves_twin.effects.payload import LinkCentre, LinkMass, PayloadMass
from ves_twin.effects.supply import SupplyDroop, SupplyPressure
from ves_twin.effects.timing import DriveDelay, SensorDelay, TransducerDelay, ValveDelay
from ves_twin.effects.transducer import LengthOffset, LengthScale
from ves_twin.effects.valve import ValveDeadband, ValveGain, ValveLag, ValveNull

__all__ = [
    "AnchorPosition",
    "BaseTilt",
    "CableSpring",
    "CommandLimit",
    "CoulombFriction",
    "CylinderViscous",
    "DriveDelay",
    "Effect",
    "EncoderOffset",
    "FilterEdge",
    "HoseStiffness",
    "JointFriction",
    "JointViscous",
    "LegBending",
    "LegGain",
    "LegRateGain",
    "LengthOffset",
    "LengthScale",
    "LinkCentre",
    "LinkMass",
    "ModelMass",
    "OilAir",
    "PayloadMass",
    "PistonLeakage",
    "RotorInertia",
    "SensorCrossTalk",
    "SensorDelay",
    "SensorDrift",
    "SensorGain",
    "SensorLag",
    "SensorMounting",
    "ServoGain",
    "StaleGravity",
    "SupplyDroop",
    "SupplyPressure",
    "TorqueConstant",
    "TransducerDelay",
    "ValveDeadband",
    "ValveDelay",
    "ValveGain",
    "ValveLag",
    "ValveNull",
]
