"""effects: named deviations of a machine from its description, which diagnosis looks for."""

from ves_twin.effects.actuators import (
    ActuatorAsymmetry,
    ActuatorDeadband,
    ActuatorDelay,
    ActuatorGain,
    ActuatorOffset,
    ActuatorSaturation,
    DriveCrossTalk,
)
from ves_twin.effects.bodies import (
    BodyInertia,
    BodyMass,
    BodyPlace,
    GravityDirection,
    MassCentre,
    Payload,
    PayloadMass,
)
from ves_twin.effects.clock import ClockRate
from ves_twin.effects.couplings import (
    CouplingCoulomb,
    CouplingInertia,
    CouplingSpring,
    CouplingViscous,
)
from ves_twin.effects.effect import Effect
from ves_twin.effects.friction import (
    LoadFriction,
    QuadraticDrag,
    RegularizedFriction,
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
    JointCompliance,
    JointSpring,
    RotorInertia,
    ViscousAsymmetry,
    ViscousFriction,
)
from ves_twin.effects.presliding import DahlFriction, FrictionBehindGap, OneWayLoad
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
from ves_twin.effects.ripple import Ripple
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
from ves_twin.effects.servos import ActuatorLag, ServoDamping, ServoStiffness, ServoStrength
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
    "ActuatorAsymmetry",
    "ActuatorDeadband",
    "ActuatorDelay",
    "ActuatorGain",
    "ActuatorLag",
    "ActuatorOffset",
    "ActuatorSaturation",
    "AnchorPosition",
    "Backlash",
    "BaseTilt",
    "BodyInertia",
    "BodyMass",
    "BodyPlace",
    "ClockRate",
    "CommandLimit",
    "CoulombAsymmetry",
    "CoulombFriction",
    "CouplingCoulomb",
    "CouplingInertia",
    "CouplingSpring",
    "CouplingViscous",
    "CrossTalk",
    "CubicSpring",
    "DahlFriction",
    "DriveCrossTalk",
    "Effect",
    "EncoderOffset",
    "FilterEdge",
    "ForceOffset",
    "FrictionBehindGap",
    "GravityDirection",
    "HoseStiffness",
    "JointCompliance",
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
    "OneWayLoad",
    "Payload",
    "PayloadMass",
    "PistonLeakage",
    "QuadraticDrag",
    "RecorderCrossTalk",
    "RecorderDelay",
    "RecorderGain",
    "RecorderOffset",
    "RegularizedFriction",
    "Ripple",
    "RotorInertia",
    "SensorDelay",
    "SensorDrift",
    "SensorGain",
    "SensorLag",
    "SensorMounting",
    "SensorOffset",
    "SensorWander",
    "ServoDamping",
    "ServoGain",
    "ServoStiffness",
    "ServoStrength",
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
