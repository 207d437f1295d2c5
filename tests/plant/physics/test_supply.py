"""The manifold against closed forms: droop, time constant, flow limit, null flow of six legs."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.plant.hydraulics import fill_chambers, loaded_pressures, resting_supply
from ves_twin.plant.physics import chambers, supply

TICK = 341e-6
P0, DROOP, LIMIT, COMPLIANCE = 1e7, 1e9, 6e-3, 8e-10


@pytest.fixture
def block():
    p, s = np.zeros(1, supply.PARAMETERS), np.zeros(1, supply.STATE)
    p["pressure"], p["droop"], p["flow_limit"], p["compliance"] = P0, DROOP, LIMIT, COMPLIANCE
    s["manifold"] = P0
    return p, s


@pytest.fixture
def legs():
    """Parameters and state of the nominal chambers without piston leakage."""
    p, s = np.zeros(1, chambers.PARAMETERS), np.zeros(1, chambers.STATE)
    fill_chambers(p[0], vt.Plant.load("ves2_pressure").parameters)
    p["leakage"] = 0.0
    s["pressure"][0] = loaded_pressures(p[0], np.zeros(6))
    return p, s


def drawn(legs, spool, speed, manifold, step=TICK):
    """Flow and slope that six legs draw in one step."""
    p, s = legs
    return chambers.push_rods_by_pressure(
        p[0], s[0], np.zeros(6), spool, np.zeros(6), speed, manifold, step
    )


def test_without_droop_the_pressure_is_the_sources_to_the_last_bit(block):
    p, s = block
    p["droop"] = 0.0
    for demand in (0.0, 1e-3, 1.0, -1e-3):
        supply.feed_manifold(p[0], s[0], demand, 1e-9, TICK)
        assert s["manifold"][0] == P0


@pytest.mark.parametrize("step", [1e-4, 0.05, 3.0])
def test_a_step_of_flow_is_answered_exactly_at_any_step(block, step):
    """P = P0 - R Q (1 - exp(-t / R C))."""
    p, s = block
    demand = 2e-3
    for _ in range(round(3.0 / step)):
        supply.feed_manifold(p[0], s[0], demand, 0.0, step)
    expected = P0 - DROOP * demand * (1.0 - np.exp(-3.0 / (DROOP * COMPLIANCE)))
    assert s["manifold"][0] == pytest.approx(expected, rel=1e-10)  # round-off of 3e4 steps


def test_beyond_the_flow_limit_the_accumulator_empties_at_the_missing_flow(block):
    p, s = block
    p["droop"] = 1e6  # the source reaches its limit 6 kPa below P0
    for _ in range(1000):
        supply.feed_manifold(p[0], s[0], 7e-3, 0.0, 1e-4)
    lost = (7e-3 - LIMIT) * 0.1 / COMPLIANCE
    assert P0 - s["manifold"][0] == pytest.approx(lost, rel=0.05)  # and the first 6 kPa of 125


def test_an_empty_manifold_stays_at_vacuum(block):
    p, s = block
    for _ in range(100):
        supply.feed_manifold(p[0], s[0], 1.0, 0.0, 0.01)
    assert s["manifold"][0] == 0.0


def test_resting_legs_draw_the_null_flow_of_the_closed_form(block, legs):
    """Q = 6 cv P / (1 + R) with the valves closed and no load."""
    ratio = legs[0]["area"][0, 0] / legs[0]["area"][0, 1]
    demand, _ = drawn(legs, np.zeros(6), np.zeros(6), P0)
    assert demand == pytest.approx(6 * 1.5e-11 * P0 / (1 + ratio), rel=1e-12)


def test_the_resting_pressure_is_that_of_manifold_and_legs_together(block, legs):
    p, s = block
    p["droop"] = 5e9
    s["manifold"] = start = resting_supply(p[0], legs[0][0])
    legs[1]["pressure"][0] = loaded_pressures(legs[0][0], np.zeros(6), start)
    for _ in range(2000):
        flow = drawn(legs, np.zeros(6), np.zeros(6), s["manifold"][0])
        supply.feed_manifold(p[0], s[0], *flow, TICK)
    assert s["manifold"][0] == pytest.approx(start, rel=1e-12)
    assert 0.8 * P0 < start < 0.9 * P0


def test_pistons_at_constant_speed_draw_what_they_sweep(block, legs):
    """P0 - P = 6 R A1 v in steady flow; null leakage off."""
    legs[0]["conductance"] = 0.0
    p, s = block
    speed = 0.1
    for _ in range(30_000):  # 10 s, twelve time constants of the manifold
        flow = drawn(legs, np.full(6, 0.5), np.full(6, speed), s["manifold"][0])
        supply.feed_manifold(p[0], s[0], *flow, TICK)
    swept = 6 * legs[0]["area"][0, 0] * speed
    assert P0 - s["manifold"][0] == pytest.approx(DROOP * swept, rel=1e-4)


def test_the_slope_of_the_demand_is_its_derivative(legs):
    spool = np.array([0.2, -0.2, 0.05, -0.05, 1.0, 0.0])
    kept = legs[1].copy()
    flows = []
    for manifold in (P0 - 10.0, P0, P0 + 10.0):
        legs[1][:] = kept
        flows.append(drawn(legs, spool, np.zeros(6), manifold))
    assert flows[1][1] == pytest.approx((flows[2][0] - flows[0][0]) / 20.0, rel=1e-6)


def test_one_step_in_a_tick_is_enough_for_the_manifold_under_moving_legs(block, legs):
    """Half a second of legs that start to move, without an accumulator: 10 l of oil."""
    found = {}
    for parts in (1, 2, 4, 64):
        p, s = block
        p["compliance"], s["manifold"] = 1.2e-11, P0
        legs[1]["pressure"][0] = loaded_pressures(legs[0][0], np.zeros(6))
        for k in range(1500 * parts):
            spool = np.full(6, 0.3 * np.sin(2 * np.pi * 3.0 * k * TICK / parts))
            speed = 0.5 * spool
            flow = drawn(legs, spool, speed, s["manifold"][0], TICK / parts)
            supply.feed_manifold(p[0], s[0], *flow, TICK / parts)
        found[parts] = s["manifold"][0]
    errors = [abs(found[parts] - found[64]) for parts in (1, 2, 4)]
    assert errors[0] < 2e-3 * P0
    assert errors[1] < 0.6 * errors[0]  # first order
    assert errors[2] < 0.6 * errors[1]
