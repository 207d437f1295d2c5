"""Blocks: parameters and state of the whole compiled loop as two structured arrays."""

from __future__ import annotations

import numpy as np

from ves_twin.control import arm_servo, leg_loop
from ves_twin.control.belief import Belief
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import Block
from ves_twin.plant.hydraulics import fill_chambers, refuse_idle
from ves_twin.plant.layout import Layout
from ves_twin.plant.parameters import ParameterTable
from ves_twin.plant.physics import (
    chambers,
    cylinder,
    delay,
    force_sensor,
    supply,
    transducer,
    valve,
)
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Legs
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.codes import SLOW

CLOCKS = np.dtype(
    [
        ("tick", np.float64),
        ("substeps", np.int64),
        ("leg", np.int64),
        ("amplifier", np.int64),
        ("admittance", np.int64),
        ("log", np.int64),
    ]
)
"""tick [s]; physics steps in a tick; periods of the clocks in ticks."""

LIMITS = np.dtype([("stroke", np.float64)])
"""stroke: travel from home at which a leg hits its end [m]."""

HOME = np.dtype([("position", np.float64, 3)])
"""position: origin of the top frame at home, inertial [m]."""

NOISE = np.dtype(
    [("encoder_count", np.float64, 3), ("torque", np.float64, 3), ("pressure", np.float64)]
)
"""Counts of the encoders [rad]; noise sd of drive currents [N m] and manifold gauge [Pa]."""

DRIVE = np.dtype([("torque_gain", np.float64, 3), ("encoder_offset", np.float64, 3)])
"""torque_gain: torque applied per torque recorded; encoder_offset: reading less the angle [rad]."""

LAYOUT = np.dtype(
    [
        ("slide_at", np.int64, 6),
        ("speed_at", np.int64, 6),
        ("slide_home", np.float64, 6),
        ("bends", np.int64),
        ("bending_qpos", np.int64, 12),
        ("platform_qpos", np.int64),
        ("platform_dof", np.int64),
        ("arm_qpos", np.int64, 3),
        ("arm_dof", np.int64, 3),
        ("leg_ctrl", np.int64, 6),
        ("arm_ctrl", np.int64, 3),
        ("wrench_sensor", np.int64),
    ]
)
"""What the loop needs of `Layout`; of bending_qpos the first `bends` are used."""

PARAMETERS = np.dtype(
    [
        ("clock", CLOCKS),
        ("layout", LAYOUT),
        ("home", HOME),
        ("limits", LIMITS),
        ("noise", NOISE),
        ("drive", DRIVE),
        ("supply", supply.PARAMETERS),
        ("hydraulics", np.int64),
        ("transducer", transducer.PARAMETERS),
        ("legs", leg_loop.PARAMETERS),
        ("valve", valve.PARAMETERS),
        ("cylinder", cylinder.PARAMETERS),
        ("chambers", chambers.PARAMETERS),
        ("sensor", force_sensor.PARAMETERS),
        ("servo", arm_servo.PARAMETERS),
        ("late", delay.PARAMETERS),
    ]
)

WORK = np.dtype(
    [
        ("slide", np.float64, 6),
        ("speed", np.float64, 6),
        ("wrench", np.float64, 6),
        ("lengths", np.float64, 6),
        ("q", np.float64, 3),
        ("rate", np.float64, 3),
        ("q_set", np.float64, 3),
        ("rate_set", np.float64, 3),
        ("added", np.float64, 3),
        ("torque", np.float64, 3),
    ]
)
"""Room for intermediate vectors: allocating them each tick would cost some per cent."""

STATE = np.dtype(
    [
        ("cycle_start", np.int64),
        ("work", WORK),
        ("current", np.float64, 6),
        ("legs", leg_loop.STATE),
        ("valve", valve.STATE),
        ("cylinder", cylinder.STATE),
        ("chambers", chambers.STATE),
        ("supply", supply.STATE),
        ("rod_force", np.float64, 6),
        ("sensor", force_sensor.STATE),
        ("servo", arm_servo.STATE),
        ("late", delay.STATE),
    ]
)
"""cycle_start: tick of the last admittance cycle; current: held amplifier outputs, -1 to 1;
rod_force: force of each cylinder [N]."""


def parameter_block(
    plant: Plant, layout: Layout, clock: Clock, legs: Legs, belief: Belief
) -> Block:
    """Parameters of the loop: the plant's for the hardware, the belief's for the computers.

    Raises:
        InvalidInputError: a changed parameter that acts on nothing in this form of hydraulics, an
            edge of a leg filter that is not there, a delay that is too long.
    """
    table = plant.actual
    refuse_idle(plant.hydraulics, table, Plant.load(plant.base).parameters)
    block = np.zeros(1, PARAMETERS)
    p = block[0]
    for name in CLOCKS.names or ():
        p["clock"][name] = getattr(clock, name)
    for name in set(LAYOUT.names or ()) - {"bending_qpos"}:
        p["layout"][name] = getattr(layout, name)
    p["layout"]["bending_qpos"][: layout.bends] = layout.bending_qpos
    p["home"]["position"] = plant.geometry.home
    p["limits"]["stroke"] = table.number("leg.stroke") / 2.0
    _fill_small_devices(p, table, plant)
    _fill_legs(p["legs"], legs, clock, belief)
    fill_sensor(p["sensor"], table, clock.tick)
    servo = p["servo"]
    for name in ("stiffness", "damping", "integral"):
        servo[name] = table.array(f"servo.{name}")
    servo["limit"] = table.array("arm.torque_limit")
    servo["cycle"] = clock.admittance * clock.tick
    for effect in plant.effects:
        effect.edit_loop(p)
    _derive(p, legs)
    return block


def _derive(p: np.void, legs: Legs) -> None:
    """What follows from numbers that effects may have changed: sections and delay lines."""
    rules = p["legs"]
    if rules["place"] == leg_loop.NONE and rules["edge"] != legs.edge:
        raise InvalidInputError(
            "edge of the deployed leg filter", float(rules["edge"]), "a filter in legs.filter"
        )
    rate = 1.0 / rules["period"]
    rules["numerator"], rules["denominator"] = leg_loop.chebyshev_section(rate, rules["edge"])
    delay.count_ticks(p["late"], p["clock"]["tick"])


def _fill_small_devices(p: np.void, table: ParameterTable, plant: Plant) -> None:
    p["noise"]["encoder_count"] = table.array("arm.encoder_resolution")
    p["noise"]["torque"] = table.array("arm.torque_noise")
    p["noise"]["pressure"] = table.number("supply.noise")
    p["drive"]["torque_gain"] = 1.0
    p["transducer"]["scale"] = 1.0
    p["transducer"]["home"] = plant.geometry.lengths(np.zeros(6))
    p["transducer"]["noise"] = table.number("transducer.noise")
    p["transducer"]["resolution"] = table.number("transducer.resolution")
    p["hydraulics"] = plant.hydraulics.code
    for name in valve.PARAMETERS.names or ():
        p["valve"][name] = table.array(f"hydraulics.valve_{name}")
    for name in supply.PARAMETERS.names or ():
        p["supply"][name] = table.number(f"supply.{name}")
    fill_chambers(p["chambers"], table)
    p["cylinder"]["full_speed"] = table.number("hydraulics.full_speed")
    p["cylinder"]["stiffness"] = table.array("hydraulics.oil_stiffness")
    p["cylinder"]["damping"] = table.array("hydraulics.oil_damping")


def _fill_legs(p: np.void, legs: Legs, clock: Clock, belief: Belief) -> None:
    p["gain"], p["rate_gain"], p["limit"] = legs.gain, legs.rate_gain, 1.0
    p["place"], p["edge"] = legs.filter.code, legs.edge
    p["period"] = clock.leg * clock.tick
    p["full_speed"] = belief.full_speed


def fill_sensor(p: np.void, table: ParameterTable, tick: float) -> None:
    """Write the force sensor's PARAMETERS for a sampling time [s]."""
    from scipy.signal import butter, lfilter  # slow to import

    corner = table.number("sensor.corner")
    if corner >= 0.5 / tick:
        raise InvalidInputError(
            "sensor.corner", corner, f"less than half a tick's rate, {0.5 / tick:.1f} Hz"
        )
    numerator, denominator = butter(2, corner, fs=1.0 / tick)
    impulse = lfilter(numerator, denominator, np.eye(1, int(1.0 / tick))[0])
    full_scale = table.array("sensor.range")
    share = table.array("sensor.crosstalk")
    p["gain"] = np.eye(6) + share * np.outer(full_scale, 1.0 / full_scale)
    p["calibration"] = np.eye(6)
    p["offset"] = table.array("sensor.offset")
    p["drift"] = table.array("sensor.drift")
    # the table gives the sd of the filtered reading; white noise loses this share in the filter
    p["noise"] = table.array("sensor.noise") / np.sqrt(np.sum(impulse**2))
    p["wander"] = table.array("sensor.wander")
    p["wander_decay"] = np.exp(-SLOW * tick / table.number("sensor.wander_time"))
    p["wander_kick"] = np.sqrt(1.0 - p["wander_decay"] ** 2)
    p["numerator"], p["denominator"] = numerator, denominator
    p["range"] = table.array("sensor.range")
    p["resolution"] = table.array("sensor.resolution")
