"""Pressure hydraulics against closed forms: orifice, stiffness, natural frequency, speed, leaks."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.plant.hydraulics import chamber_stiffness, fill_chambers, loaded_pressures
from ves_twin.plant.physics import chambers

TICK = 341e-6
HOME = np.zeros(6)


@pytest.fixture
def block():
    """Parameters and state of the nominal chambers at null."""
    p, s = np.zeros(1, chambers.PARAMETERS), np.zeros(1, chambers.STATE)
    fill_chambers(p[0], vt.Plant.load("ves2_pressure").parameters)
    s["pressure"][0] = loaded_pressures(p[0], np.zeros(6))
    return p, s


def push(block, spool, slide, speed, step=TICK, supply=1e7):
    """Rod forces (6,) after one step."""
    p, s = block
    force = np.zeros(6)
    chambers.push_rods_by_pressure(p[0], s[0], force, spool, slide, speed, supply, step)
    return force


def test_orifice_is_a_square_root_away_from_zero_and_linear_within():
    flow, slope = chambers.orifice(2.0, 1e7, 1e5)
    # (1 + (dp0/dp)^2)^(-1/4) is 2.5e-5 off the square root at dp = 100 dp0
    assert flow == pytest.approx(2.0 * np.sqrt(1e7), rel=3e-5)
    assert slope == pytest.approx(0.5 * flow / 1e7, rel=1e-4)
    small, small_slope = chambers.orifice(2.0, 10.0, 1e5)
    assert small / 10.0 == pytest.approx(2.0 / np.sqrt(1e5), rel=1e-7)
    assert small_slope == pytest.approx(small / 10.0, rel=1e-7)
    assert chambers.orifice(2.0, -1e6, 1e5)[0] == -chambers.orifice(2.0, 1e6, 1e5)[0]


@pytest.mark.parametrize("drop", [-2e6, -5e4, 0.0, 3e4, 4e6])
def test_slope_of_the_orifice_is_its_derivative(drop):
    h = 10.0
    ahead, behind = (chambers.orifice(1e-6, drop + d, 1e5)[0] for d in (h, -h))
    assert chambers.orifice(1e-6, drop, 1e5)[1] == pytest.approx(
        (ahead - behind) / (2 * h), rel=1e-5
    )


def test_null_without_load_or_leakage_is_an_equilibrium(block):
    block[0]["leakage"] = 0.0  # it would equalise pressures that areas keep apart
    force = push(block, np.zeros(6), HOME, np.zeros(6))
    assert np.max(np.abs(force)) < 1e-9  # N; the pressures balance to round-off of 1e4 N
    assert np.allclose(block[1]["pressure"][0], block[0]["null"][0], rtol=1e-14)


def test_loaded_pressures_carry_their_force(block):
    p, s = block
    asked = np.array([-500.0, -50.0, 0.0, 50.0, 300.0, 900.0])
    s["pressure"][0] = loaded_pressures(p[0], asked)
    p["conductance"] = p["leakage"] = 0.0
    assert push(block, np.zeros(6), HOME, np.zeros(6)) == pytest.approx(asked, abs=1e-9)


@pytest.mark.parametrize("travel", [-0.2, 0.0, 0.2])
def test_oil_is_as_stiff_as_the_closed_form(block, travel):
    p, _ = block
    p["conductance"] = p["leakage"] = p["viscous"] = 0.0
    speed = 1e-3
    force = push(block, np.zeros(6), np.full(6, travel), np.full(6, speed))
    # half a step of travel lies between the volumes of the two
    k = chamber_stiffness(p[0], np.full(6, travel + 0.5 * speed * TICK))
    assert -force / (speed * TICK) == pytest.approx(k, rel=1e-6)


@pytest.mark.parametrize(("share", "taken"), [(0.3, 0.3), (0.1, 0.2), (-0.5, 0.2)])
def test_beyond_the_stroke_a_chamber_keeps_a_fifth_of_its_dead_volume(block, share, taken):
    p, s = block
    p["conductance"] = p["leakage"] = 0.0
    area, dead, beta = p["area"][0, 0], p["dead_volume"][0], p["bulk_modulus"][0]
    slide = -p["half_stroke"][0] + (share - 1.0) * dead / area
    before = s["pressure"][0, :, 0].copy()
    speed = 1e-6  # so slow that the volume stays
    push(block, np.zeros(6), slide, np.full(6, speed))
    rise = s["pressure"][0, :, 0] - before
    assert rise == pytest.approx(-beta * area * speed * TICK / (taken * dead), rel=1e-3)


def test_stiffness_at_mid_stroke_is_that_of_the_linear_form(block):
    k = chamber_stiffness(block[0][0], HOME)[0]
    assert k == pytest.approx(
        vt.Plant.load("ves2").parameters.number("hydraulics.oil_stiffness"), rel=0.01
    )


def test_mass_on_the_oil_swings_at_the_closed_form_frequency(block):
    p, _ = block
    p["conductance"] = p["leakage"] = p["viscous"] = 0.0
    mass, step = 300.0, 2e-5
    x, v, trace = np.full(6, 1e-4), np.zeros(6), []
    for _ in range(20_000):
        v = v + step * push(block, np.zeros(6), x, v, step) / mass
        x = x + step * v
        trace.append(x[0] - 1e-4)
    spectrum = np.abs(np.fft.rfft(np.array(trace) * np.hanning(len(trace)), 1 << 20))
    # the mass starts at rest with balanced pressures: give it a push instead
    assert np.max(spectrum) < 1e-9
    v, trace = np.full(6, 0.01), []
    for _ in range(20_000):
        v = v + step * push(block, np.zeros(6), x, v, step) / mass
        x = x + step * v
        trace.append(x[0])
    centred = np.array(trace) - np.mean(trace)
    spectrum = np.abs(np.fft.rfft(centred * np.hanning(len(trace)), 1 << 20))
    found = np.fft.rfftfreq(1 << 20, step)[np.argmax(spectrum)]
    closed = np.sqrt(chamber_stiffness(p[0], HOME)[0] / mass) / (2 * np.pi)
    assert found == pytest.approx(closed, rel=0.005)  # 0.4 s of record resolves 0.1 Hz of 29


def test_full_opening_moves_at_the_mean_speed_of_both_directions(block):
    speeds = []
    for opening in (1.0, -1.0):
        p, s = block
        s["pressure"][0] = loaded_pressures(p[0], np.zeros(6))
        p["viscous"] = 0.0
        v = np.zeros(6)
        for _ in range(4000):
            v = v + 2e-5 * push(block, np.full(6, opening), HOME, v, 2e-5) / 20.0
        speeds.append(abs(v[0]))
    ratio = block[0]["area"][0, 0] / block[0]["area"][0, 1]
    full = vt.Plant.load("ves2").parameters.number("hydraulics.full_speed")
    # null leakage and the laminar part of the orifices take some tenths of a per cent
    assert np.mean(speeds) == pytest.approx(full, rel=0.01)
    assert speeds[0] / speeds[1] == pytest.approx(np.sqrt(ratio), rel=0.01)


def test_one_step_in_a_tick_is_enough(block):
    """Half opening, moving rod: one exponential step against 64 of them."""
    p, s = block
    forces = []
    for parts in (1, 64):
        s["pressure"][0] = loaded_pressures(p[0], np.zeros(6))
        for k in range(20 * parts):
            slide = np.full(6, 0.1 * k * TICK / parts)
            force = push(block, np.full(6, 0.2), slide, np.full(6, 0.1), TICK / parts)
        forces.append(force[0])
    assert forces[0] == pytest.approx(forces[1], abs=2.0)  # N of a range of 12 000


def test_pressures_stay_above_vacuum_and_volumes_positive(block):
    for slide in (-0.4, 0.4):
        force = push(block, np.full(6, np.sign(slide)), np.full(6, slide), np.full(6, -3.0))
        assert np.all(np.isfinite(force))
        assert np.all(block[1]["pressure"] >= 0.0)


def steady_speed(block, opening, supply):
    """Speed of an unloaded rod at an opening [m/s], volumes held at mid stroke."""
    p, s = block
    s["pressure"][0] = loaded_pressures(p[0], np.zeros(6), supply)
    v, late = np.zeros(6), []
    for k in range(20_000):
        v = v + 2e-5 * push(block, np.full(6, opening), HOME, v, 2e-5, supply) / 20.0
        if k >= 10_000:
            late.append(v[0])
    return np.mean(late)


def test_speed_goes_with_the_root_of_the_supply(block):
    block[0]["conductance"] = block[0]["leakage"] = block[0]["viscous"] = 0.0
    block[0]["crossover"] = 1.0
    high, low = (steady_speed(block, 0.5, supply) for supply in (1e7, 8e6))
    assert low / high == pytest.approx(np.sqrt(0.8), rel=1e-4)


def test_null_pressures_follow_the_supply(block):
    block[0]["leakage"] = 0.0
    block[1]["pressure"][0] = loaded_pressures(block[0][0], np.zeros(6), 7e6)
    force = push(block, np.zeros(6), HOME, np.zeros(6), supply=7e6)
    assert np.max(np.abs(force)) < 1e-9
    assert block[1]["pressure"][0].sum(axis=1) == pytest.approx(7e6, rel=1e-14)


def test_a_held_piston_leaks_to_equal_pressures_at_the_closed_form_rate(block):
    """d(p1 - p2)/dt = -cl beta (1/V1 + 1/V2) (p1 - p2), another leakage in each leg."""
    p, s = block
    p["conductance"] = 0.0
    leakage = np.array([1e-12, 2e-12, 5e-12, 1e-11, 2e-11, 0.0])
    p["leakage"] = leakage
    start = s["pressure"][0].copy()
    errors = []
    for parts in (1, 2, 4):
        s["pressure"][0] = start
        for _ in range(300 * parts):
            push(block, np.zeros(6), HOME, np.zeros(6), TICK / parts)
        across = np.subtract(*s["pressure"][0].T)
        volumes = p["dead_volume"][0] + np.outer(p["area"][0], p["half_stroke"])
        rate = leakage * p["bulk_modulus"][0] * np.sum(1.0 / volumes, axis=0)
        closed = np.subtract(*start.T) * np.exp(-rate * 300 * TICK)
        errors.append(np.max(np.abs(across - closed)))
    assert errors[0] < 0.01 * abs(np.subtract(*start[0]))
    assert errors[1] < 0.6 * errors[0]  # first order in the step
    assert errors[2] < 0.6 * errors[1]


def test_a_loaded_leg_with_its_valve_shut_drifts_at_the_closed_form_speed(block):
    """cv (n1 - p1) - cl dp = A1 v, cv/R (n2 - p2) + cl dp = -A2 v, A1 p1 - A2 p2 = F."""
    p, s = block
    leakage = np.array([0.0, 2e-13, 1e-12, 5e-12, 1e-11, 1e-10])
    load, mass, step = 300.0, 50.0, 1e-4
    p["leakage"], p["viscous"], p["bulk_modulus"] = leakage, 0.0, 8.5e8
    s["pressure"][0] = loaded_pressures(p[0], np.full(6, load))
    v, late = np.zeros(6), []
    for k in range(12_000):
        v = v + step * (push(block, np.zeros(6), HOME, v, step) - load) / mass
        if k >= 10_000:
            late.append(v)
    (a1, a2), (c1, c2), (n1, n2) = (p[0][n] for n in ("area", "conductance", "null"))
    closed = [
        np.linalg.solve(
            [[c1 + cl, -cl, a1], [-cl, c2 + cl, -a2], [a1, -a2, 0.0]], [c1 * n1, c2 * n2, load]
        )[2]
        for cl in leakage
    ]
    assert np.mean(late, axis=0) == pytest.approx(closed, rel=1e-3)
    assert abs(closed[-1] - closed[0]) > 2e-3  # m/s; the leak is seen


def test_a_fault_of_one_leg_stays_in_that_leg(block):
    p, s = block
    speed = np.full(6, 0.01)
    push(block, np.full(6, 0.1), HOME, speed)
    sound = s["pressure"][0].copy()
    for name, factor in (
        *(("leakage", 100.0), ("bulk_modulus", 0.7), ("dead_volume", 2.0), ("viscous", 3.0)),
    ):
        kept = p[name].copy()
        p[name][0, 2] *= factor
        s["pressure"][0] = loaded_pressures(p[0], np.zeros(6))
        force = push(block, np.full(6, 0.1), HOME, speed)
        others = [0, 1, 3, 4, 5]
        np.testing.assert_array_equal(s["pressure"][0, others], sound[others])
        assert np.all(force[others] == force[0])
        assert force[2] != force[0]
        p[name] = kept
