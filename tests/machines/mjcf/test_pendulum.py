"""The shipped pendulum: the same motion as one written by hand, and the diagnosis of blind ones."""

from __future__ import annotations

import numpy as np
import pytest
from pendulum import (
    ANGLE,
    BIAS,
    BLIND,
    DAMPING,
    DELAYED,
    FED,
    FRICTION,
    GAIN,
    INERTIA,
    LATE,
    LATE_COMMAND,
    MASS,
    PLANT,
    RATE,
    SPRING,
    STEP,
    TIME,
    TORQUE,
    ZERO,
)
from rows import EXPECTED, ROWS, row_record
from sizes import nightly_but
from written_pendulum import START, Pendulum, edited

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.fit.detectability import detectability
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.suites.machine import BlindRig

WRITTEN = Pendulum.with_command_delay()
SAME = {
    "joint.damping": DAMPING,
    "joint.friction": FRICTION,
    "joint.stiffness": SPRING,
    "joint.armature": INERTIA,
    "link.mass": MASS,
    "drive.gain": GAIN,
    "sensor.delay": LATE,
    "command.delay": LATE_COMMAND,
    "encoder.bias": BIAS,
    "start.angle": ANGLE,
    "start.rate": RATE,
    "drive.offset": ZERO,
}
"""Parameter of the pendulum written by hand -> of the shipped one."""

ROUNDING = 1e-12
"""Two ways to the same numbers, in rad and rad/s: mass enters the compiler or the compiled model,
the offset through the motor or as an effort on the joint."""


def blind_record(seed, hidden=None, outside="", size=0.0):
    """A measured pendulum of the blind suites: every commissioning parameter drawn anew."""
    rng = np.random.default_rng(seed)
    values = BLIND.commissioned(rng)
    for name, departure in (hidden or {}).items():
        values[name] = values.get(name, 0.0) + departure
    return BLIND.record(BlindRig(values, outside, size), "train", rng)


@pytest.fixture(scope="module")
def settings(banks):
    return Settings(nulls=60, cache=banks)


@pytest.mark.parametrize("refined", [False, True])
@pytest.mark.parametrize("name", SAME)
def test_it_moves_as_the_pendulum_written_by_hand(name, refined):
    """An independent path: MjSpec compiled for each run, delays and offsets by hand."""
    p = next(p for p in WRITTEN.parameters if p.name == name)
    value = p.nominal + 0.1 * (p.high - p.nominal)
    begun = np.tile([0.3, -0.4], (len(TIME), 1))
    programme = Excitation("", TIME, {"joint.torque": TORQUE, START.name: begun})
    by_hand = WRITTEN.simulate(programme, {name: value}, refined)
    sign = -1.0 if name == "drive.offset" else 1.0
    shipped = DELAYED.simulate(programme, {SAME[name]: sign * value}, refined)
    assert np.abs(shipped - by_hand).max() < ROUNDING
    assert np.abs(shipped - DELAYED.simulate(programme, {}, refined)).max() > 1e-4


def test_it_is_known_as_well_and_its_causes_are_as_large():
    shipped = {p.name: p for p in DELAYED.parameters}
    for p in WRITTEN.parameters:
        ours = shipped[SAME[p.name]]
        assert (ours.nominal, ours.sd, ours.per_recording) == (p.nominal, p.sd, p.per_recording)
        assert (ours.unit, ours.low, ours.high) == (p.unit, p.low, p.high), p.name
    causes = {h.parameters[0]: h for h in DELAYED.hypotheses}
    assert len(causes) == len(WRITTEN.hypotheses)
    for h in WRITTEN.hypotheses:
        ours = causes[SAME[h.parameters[0]]]
        assert (ours.smallest, ours.largest, ours.signs) == (h.smallest, h.largest, h.signs)


def test_the_motion_is_that_of_the_equation_of_motion():
    """I q'' + d q' + m g l sin q = u by classic Runge-Kutta, the torque held for each row."""
    model = edited({p.name: p.nominal for p in WRITTEN.parameters})
    about_joint = float(model.body_inertia[1][0] + model.body_mass[1] * 0.2**2 + 0.01)

    def rate(x, u):
        return np.array([x[1], (u - 0.05 * x[1] - 9.81 * 0.2 * np.sin(x[0])) / about_joint])

    torque, exact = TORQUE[:, 0], np.zeros((1000, 2))
    for k in range(len(exact) - 1):
        a = rate(exact[k], torque[k])
        b = rate(exact[k] + STEP / 2 * a, torque[k])
        c = rate(exact[k] + STEP / 2 * b, torque[k])
        d = rate(exact[k] + STEP * c, torque[k])
        exact[k + 1] = exact[k] + STEP / 6 * (a + 2 * b + 2 * c + d)
    coarse = PLANT.simulate(FED, {})[: len(exact)]
    fine = PLANT.simulate(FED, {}, refined=True)[: len(exact)]
    # a first-order step: halving it halves the error, and that error is the step's alone
    ratio = np.linalg.norm(coarse - exact) / np.linalg.norm(fine - exact)
    assert ratio == pytest.approx(2.0, abs=0.05)


def test_every_parameter_moves_a_channel_and_nominal_values_move_none():
    nominal = PLANT.simulate(FED, {})
    told = PLANT.simulate(FED, {p.name: p.nominal for p in PLANT.parameters})
    assert np.array_equal(nominal, told)
    for p in PLANT.parameters:
        moved = PLANT.simulate(FED, {p.name: p.nominal + 0.1 * (p.high - p.nominal)})
        assert np.max(np.abs(moved - nominal) / [0.001, 0.01]) > 1.0, p.name


def test_delay_bias_and_gain_are_edits_of_the_loop():
    nominal = PLANT.simulate(FED, {})
    late = PLANT.simulate(FED, {LATE: 5 * STEP})
    assert late[5:] == pytest.approx(nominal[:-5], abs=1e-12)
    offset = PLANT.simulate(FED, {BIAS: 0.02})
    assert offset - nominal == pytest.approx(np.tile([0.02, 0.0], (len(TIME), 1)), abs=1e-15)
    half = Excitation("half", TIME, {"joint.torque": 0.5 * TORQUE})
    assert PLANT.simulate(FED, {GAIN: 0.5}) == pytest.approx(PLANT.simulate(half, {}))


@pytest.mark.slow
@pytest.mark.parametrize("name", nightly_but(1, list(ROWS)))
def test_five_causes_are_named_and_nothing_in_the_null(name, settings):
    hidden, _ = ROWS[name]
    v = diagnose(PLANT, [row_record(hidden)], settings=settings)
    if EXPECTED[name] is None:
        assert v.verdict is Kind.NOTHING
        return
    assert v.verdict is Kind.NAMED, v.words
    assert v.causes[0].effect == EXPECTED[name]
    (parameter, size), p = next(iter(hidden.items())), v.causes[0].parameters
    sd = (p[parameter].high - p[parameter].low) / 2 / 1.645
    assert abs(p[parameter].value - size) < 3 * sd


@pytest.mark.slow
def test_rigs_in_order_are_left_in_peace(settings):
    said = [diagnose(PLANT, [blind_record(s)], settings=settings) for s in range(12)]
    assert sum(v.verdict is not Kind.NOTHING for v in said) <= 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effect", "hidden"),
    nightly_but(
        1,
        [
            ("joint_spring", {SPRING: 0.02}),
            ("sensor_offset", {BIAS: -0.013}),
            ("coulomb_friction", {FRICTION: 0.004}),
            ("sensor_delay", {LATE: 0.0024}),
        ],
    ),
)
def test_a_cause_of_ten_sigma_is_named_and_with_it_left_out_nobody_is(effect, hidden, settings):
    runs = Runs(PLANT, (FED,), (0, 1))
    local, shift = linearise(runs, runs.origin), runs.origin
    for i, axis in enumerate(runs.coordinates):
        shift[i] = hidden.get(axis.parameter.name, 0.0)
    assert detectability(local, whitening_declared(runs), shift) > 10.0
    data = blind_record(21, hidden)
    v = diagnose(PLANT, [data], settings=settings)
    assert (v.verdict, v.causes[0].effect) == (Kind.NAMED, effect)
    blindfold = diagnose(PLANT, [data], exclude=[effect], settings=settings)
    assert blindfold.verdict is Kind.UNKNOWN


@pytest.mark.nightly
@pytest.mark.parametrize(("kind", "size"), [("quadratic_drag", 0.02), ("late_drift", 0.05)])
def test_effects_outside_the_library_are_unknown(kind, size, settings):
    data = blind_record(5, outside=kind, size=size)
    assert diagnose(PLANT, [data], settings=settings).verdict is Kind.UNKNOWN


@pytest.mark.slow
def test_where_a_delay_sits_cannot_be_told_from_rest_in_open_loop():
    data = blind_record(8, {LATE: 0.004})
    v = diagnose(DELAYED, [data], settings=Settings(nulls=60, simulated_nulls=False))
    assert v.verdict is Kind.AMBIGUOUS
    assert {f"{c.effect}@{c.target}" for c in v.causes} == {
        "sensor_delay@joint",
        "actuator_delay@drive",
    }


@pytest.mark.slow
def test_a_fault_that_was_repaired_meanwhile_extends_nothing(settings):
    """Commissioning errors bent to mimic a spring do worse than the spring, and both are wrong."""
    rng = np.random.default_rng(3)
    usual = BLIND.commissioned(rng)
    sick = {**usual, SPRING: 0.015}
    train = BLIND.record(BlindRig(sick), "train", rng)
    for values, confirmed in ((usual, False), (sick, True)):
        held = BLIND.record(BlindRig(values), "held_out", rng)
        v = diagnose(PLANT, [train], held_out=[held], settings=settings)
        assert v.causes[0].effect == "joint_spring"
        assert v.gain.passed == confirmed
        assert v.gain.low > 0.0  # against the commissioning errors alone it would do
