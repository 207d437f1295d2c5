"""arm_prior and legs_prior: linear models of the believed rig as environments show it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.plant import Plant
from ves_twin.plant.puma_chain import puma_chain
from ves_twin.scenario.schema import Scenario

if TYPE_CHECKING:
    from control import StateSpace


def arm_prior(scenario: Scenario, rate: float) -> StateSpace:
    """Arm behind its servo on a platform that follows a flexible base through its legs.

        M Y'' + B Y' + K Y = -(H_bb P'' + H_bq q''),    lag P'' + P' = gain (Y - P)
        H_bq' P'' + H_qq q'' = K_s (c - q) + B_s (c' - q') + i - D q',    i' = K_i (c - q)
        c' = rate a

    about the start angles, with everything that the scenario's belief says; the force sensor's
    low-pass, the computers' cycle and gravity are left out.

    Args:
        scenario: base, start angles, leg gain and belief.
        rate: joint rate of an action of 1 [rad/s].

    Returns:
        States (Y, Y', P, P', q, q', c, i) (36,) as deviations; inputs are the actions a (3,);
        outputs are deviations of `platform.pose`, `arm.q` and `arm.command` (12,).

    Source: thesis 4.3.2, 5.1; `ves_twin.mechanics.planning.lagging_base`.
    """
    from control import StateSpace  # slow to import

    plant = Plant.load(scenario.belief)
    array = plant.parameters.array
    base = EmulatedSystem.load(str(scenario.platform.emulated))
    mass = puma_chain(plant).mass_matrix(np.array(scenario.arm.start))
    h_bb, h_bq, h_qq = mass[:6, :6], mass[:6, 6:], mass[6:, 6:]
    # every quantity is a row of coefficients of the states and the inputs
    rows = np.eye(39)
    y, y_rate, p, p_rate = (rows[6 * k : 6 * k + 6] for k in range(4))
    q, q_rate, c, i, a = (rows[24 + 3 * k : 27 + 3 * k] for k in range(5))
    lag = float(np.median(plant.parameters.array("hydraulics.valve_lag")))
    follows = (scenario.legs.gain * (y - p) - p_rate) / lag
    torque = array("servo.stiffness")[:, None] * (c - q) + i
    torque = torque + array("servo.damping")[:, None] * (rate * a - q_rate)
    torque = torque - array("arm.damping")[:, None] * q_rate
    joints = np.linalg.solve(h_qq, torque - h_bq.T @ follows)
    load = base.stiffness @ y + base.damping @ y_rate + h_bb @ follows + h_bq @ joints
    falls = -np.linalg.solve(base.mass, load)
    integral = array("servo.integral")[:, None] * (c - q)
    moves = np.vstack([y_rate, falls, p_rate, follows, q_rate, joints, rate * a, integral])
    seen = np.vstack([p, q, c])
    return StateSpace(
        moves[:, :36],
        moves[:, 36:],
        seen[:, :36],
        seen[:, 36:],
        inputs=_names("arm.rate", 3),
        outputs=[*_names("platform.pose", 6), *_names("arm.q", 3), *_names("arm.command", 3)],
        name=scenario.name,
    )


def legs_prior(scenario: Scenario, offset: float) -> StateSpace:
    """Six legs with their valves, each lag l'' + l' = gain (c - l), c = offset a.

    Args:
        scenario: leg gain and belief.
        offset: set-point offset of an action of 1 [m].

    Returns:
        States (l, l') (12,); inputs are the actions (6,); outputs are deviations of `leg.travel`.

    Source: thesis 5.1.
    """
    from control import StateSpace  # slow to import

    plant = Plant.load(scenario.belief)
    lag = float(np.median(plant.parameters.array("hydraulics.valve_lag")))
    gain, one, none = scenario.legs.gain, np.eye(6), np.zeros((6, 6))
    a: FloatArray = np.block([[none, one], [-gain / lag * one, -one / lag]])
    b = np.vstack([none, gain * offset / lag * one])
    return StateSpace(
        a,
        b,
        np.hstack([one, none]),
        none,
        inputs=_names("leg.offset", 6),
        outputs=_names("leg.travel", 6),
        name=scenario.name,
    )


def _names(name: str, count: int) -> list[str]:
    """Column names as `Channel.columns` has them; a dot would mean a subsystem to the library."""
    return [f"{name.replace('.', '_')}_{k + 1}" for k in range(count)]
