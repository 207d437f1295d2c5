"""effects: named deviations of a machine from its description, which diagnosis looks for."""

from ves_twin.effects.actuators import ActuatorDeadband, ActuatorDelay, ActuatorGain
from ves_twin.effects.bodies import (
    BodyInertia,
    BodyMass,
    BodyPlace,
    GravityDirection,
    MassCentre,
    PayloadMass,
)
from ves_twin.effects.couplings import CouplingCoulomb, CouplingInertia, CouplingViscous
from ves_twin.effects.effect import Effect
from ves_twin.effects.friction import (
    FrictionBehindGap,
    LoadFriction,
    QuadraticDrag,
    StribeckFriction,
)
from ves_twin.effects.hydraulics import (
    OilAir,
    PistonLeakage,
    SupplyDroop,
    SupplyPressure,
    ValveDeadband,
    ValveGain,
    ValveLag,
    ValveNull,
)
from ves_twin.effects.joints import (
    Backlash,
    CoulombAsymmetry,
    CoulombFriction,
    CubicSpring,
    ForceOffset,
    JointSpring,
    RotorInertia,
    ViscousAsymmetry,
    ViscousFriction,
)
from ves_twin.effects.programs import (
    CommandLimit,
    FilterEdge,
    LegGain,
    LegRateGain,
    ModelMass,
    ServoGain,
    StaleGravity,
)
from ves_twin.effects.recorder import (
    RecorderCrossTalk,
    RecorderDelay,
    RecorderGain,
    RecorderOffset,
)
from ves_twin.effects.sensors import (
    CrossTalk,
    EncoderOffset,
    SensorDelay,
    SensorDrift,
    SensorGain,
    SensorLag,
    SensorMounting,
    SensorOffset,
    SensorWander,
)
from ves_twin.effects.structure import AnchorPosition, BaseTilt, HoseStiffness, LegBending
from ves_twin.effects.transducers import LengthOffset, LengthScale, TransducerDelay

CableSpring = JointSpring
CylinderViscous = JointViscous = ViscousFriction
DriveDelay = ValveDelay = ActuatorDelay
JointFriction = CoulombFriction
LinkCentre = MassCentre
LinkMass = BodyMass
SensorCrossTalk = CrossTalk
TorqueConstant = ActuatorGain
# names of earlier versions, as registry.RENAMED has them of files

__all__ = [
    "ActuatorDeadband",
    "ActuatorDelay",
    "ActuatorGain",
    "AnchorPosition",
    "Backlash",
    "BaseTilt",
    "BodyInertia",
    "BodyMass",
    "BodyPlace",
    "CommandLimit",
    "CoulombAsymmetry",
    "CoulombFriction",
    "CouplingCoulomb",
    "CouplingInertia",
    "CouplingViscous",
    "CrossTalk",
    "CubicSpring",
    "Effect",
    "EncoderOffset",
    "FilterEdge",
    "ForceOffset",
    "FrictionBehindGap",
    "GravityDirection",
    "HoseStiffness",
    "JointSpring",
    "LegBending",
    "LegGain",
    "LegRateGain",
    "LengthOffset",
    "LengthScale",
    "LoadFriction",
    "MassCentre",
    "ModelMass",
    "OilAir",
    "PayloadMass",
    "PistonLeakage",
    "QuadraticDrag",
    "RecorderCrossTalk",
    "RecorderDelay",
    "RecorderGain",
    "RecorderOffset",
    "RotorInertia",
    "SensorDelay",
    "SensorDrift",
    "SensorGain",
    "SensorLag",
    "SensorMounting",
    "SensorOffset",
    "SensorWander",
    "ServoGain",
    "StaleGravity",
    "StribeckFriction",
    "SupplyDroop",
    "SupplyPressure",
    "TransducerDelay",
    "ValveDeadband",
    "ValveGain",
    "ValveLag",
    "ValveNull",
    "ViscousAsymmetry",
    "ViscousFriction",
]
