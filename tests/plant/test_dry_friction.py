"""Dry friction as the rig sets it in MuJoCo, against exact solutions of a mass that sticks."""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from scipy.optimize import brentq

from ves_twin.plant.assembly import FRICTION_SOLIMP, JOINTS, assemble
from ves_twin.plant.plant import Plant

TICK = 341e-6
MASS, LEVEL = 10.0, 100.0


def pushed(
    force: Callable[[float], float],
    seconds: float,
    speed: float = 0.0,
    step: float = TICK,
    soft: bool = False,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, positions and speeds of a mass with dry friction under a force of time.

    `soft` leaves the engine's own numbers of the friction constraint.
    """
    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.gravity = step, [0, 0, 0]
    spec.option.tolerance = 1e-12
    body = spec.worldbody.add_body(mass=MASS, inertia=[1, 1, 1], explicitinertial=True)
    joint = body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, frictionloss=LEVEL)
    if not soft:
        joint.solref_friction = np.array([2.0 * step, 1.0])
        joint.solimp_friction = np.array(FRICTION_SOLIMP)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[0] = speed
    states = [(0.0, 0.0, speed)]
    for k in range(round(seconds / step)):
        data.qfrc_applied[0] = force(k * step)
        mujoco.mj_step(model, data)
        states.append((data.time, data.qpos[0], data.qvel[0]))
    return tuple(np.array(states).T)


@pytest.mark.parametrize(("soft", "width", "impedance"), [(True, 0.02, 0.9), (False, None, 0.9999)])
def test_a_mass_that_should_stick_creeps_as_the_constraint_is_soft(figure, soft, width, impedance):
    """v = F (1 - d) / (d m b), b = 2 / (d_max width): a force F below the level holds a speed."""
    load = 60.0
    _, _, v = pushed(lambda t: load, 2.0, soft=soft)
    highest = 0.95 if soft else impedance
    rate = 2.0 / (highest * (width or 2.0 * TICK))
    creep = load * (1.0 - impedance) / (impedance * MASS * rate)
    assert v[-1] == pytest.approx(creep, rel=1e-3)
    if not soft:  # the engine's own numbers: 6.3 mm/s
        figure("10 kg under 60 N below 100 N of friction: creep", v[-1] * 1e6, 0.3, "um/s")


def test_a_rising_load_breaks_away_at_the_level(figure):
    """F = r t: at rest until t0 = level / r, then x = r (t - t0)^3 / 6 m."""
    rise = 100.0
    t, x, _ = pushed(lambda t: rise * t, 2.0)
    exact = rise * np.clip(t - LEVEL / rise, 0.0, None) ** 3 / (6.0 * MASS)
    figure("breakaway under a rising load: error of position", np.max(np.abs(x - exact)) * 1e6,
           0.6, "um")  # fmt: skip  # of 1.7 m travelled


def test_a_sliding_mass_stops_where_its_energy_is_spent_and_stays():
    """x = m v0^2 / 2 F; first order in the step, half a step of v0."""
    speed = 0.1
    for step in (TICK, TICK / 2, TICK / 4):
        _, x, v = pushed(lambda t: 0.0, 0.1, speed=speed, step=step)
        assert x[-1] == pytest.approx(MASS * speed**2 / (2 * LEVEL), abs=0.52 * speed * step)
        assert abs(v[-1]) < 1e-9


def exact_sine(amplitude: float, rate: float, seconds: float) -> Callable[[np.ndarray], np.ndarray]:
    """Position under amplitude sin(rate t) from rest, stick and slip by their events.

    Sliding with sign s from t0 at x0: m v = (A / w)(cos w t0 - cos w t) - s F (t - t0).
    """
    pieces = [(0.0, 0.0, 0.0)]  # start, position, sign of the sliding
    t, x = 0.0, 0.0
    while t < seconds:
        if abs(amplitude * np.sin(rate * t)) <= LEVEL:
            phase = np.arcsin(LEVEL / amplitude)
            half = np.floor((rate * t) / np.pi)
            ahead = (half + np.array([0.0, 1.0])) * np.pi + phase
            t = float(min(a for a in ahead / rate if a >= t))
        sign = float(np.sign(np.sin(rate * t)))

        def speed(u, t=t, sign=sign):
            push = amplitude / rate * (np.cos(rate * t) - np.cos(rate * u))
            return (push - sign * LEVEL * (u - t)) / MASS

        pieces.append((t, x, sign))
        grid = np.linspace(t, t + 2 * np.pi / rate, 4001)[5:]
        turn = int(np.argmax(sign * speed(grid) < 0.0))
        stop = brentq(speed, grid[turn - 1], grid[turn], xtol=1e-14)
        x = float(_slid(np.array([stop]), (t, x, sign), amplitude, rate)[0])
        t = stop
        pieces.append((t, x, 0.0))

    def position(times: np.ndarray) -> np.ndarray:
        found = np.zeros_like(times)
        for piece in pieces:
            late = times >= piece[0]
            found[late] = _slid(times[late], piece, amplitude, rate)
        return found

    return position


def _slid(u: np.ndarray, piece: tuple, amplitude: float, rate: float) -> np.ndarray:
    t, x, sign = piece
    if sign == 0.0:
        return np.full_like(u, x)
    push = (u - t) * np.cos(rate * t) - (np.sin(rate * u) - np.sin(rate * t)) / rate
    return x + (amplitude / rate * push - sign * LEVEL * (u - t) ** 2 / 2.0) / MASS


@pytest.mark.parametrize("amplitude", [110.0, 150.0, 400.0])
def test_a_sine_force_sticks_and_slips_as_the_exact_solution(figure, amplitude):
    rate = 2 * np.pi * 2.0
    position = exact_sine(amplitude, rate, 3.0)
    errors = []
    for step in (TICK, TICK / 2):
        t, x, _ = pushed(lambda t: amplitude * np.sin(rate * t), 3.0, step=step)
        errors.append(np.max(np.abs(x - position(t))) / np.ptp(position(t)))
    figure(
        f"stick-slip under a sine of {amplitude:g} N: error over travel", errors[0] * 100, 0.5, "%"
    )
    assert errors[1] < 0.6 * errors[0]  # first order


def test_only_legs_with_friction_have_a_constraint_and_it_is_the_stiff_one():
    levels = [0.0, 20.0, 0.0, 100.0, 0.0, 0.0]
    plant = Plant.load("ves2")
    model = assemble(plant.with_values({"leg.dry_friction": levels}), TICK).compile()
    names = [f"leg{i}/slide" for i in range(1, 7)]
    assert [float(model.joint(name).frictionloss[0]) for name in names] == levels
    for name in (*names, *(f"arm/{joint}" for joint in JOINTS)):
        dof = model.joint(name).dofadr[0]
        np.testing.assert_allclose(model.dof_solref[dof], [2 * TICK, 1.0])
        np.testing.assert_allclose(model.dof_solimp[dof], FRICTION_SOLIMP)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.nf == 2
    bare = assemble(plant, TICK).compile()
    data = mujoco.MjData(bare)
    mujoco.mj_forward(bare, data)
    assert data.nf == 0


def test_the_modes_are_those_of_legs_that_slide():
    from ves_twin.plant.modes import structural_modes

    plant = Plant.load("ves2")
    stiff = plant.with_values({"leg.dry_friction": 100.0})
    first, second = (structural_modes(p, np.zeros(6), np.zeros(3))[0] for p in (plant, stiff))
    assert second == first
