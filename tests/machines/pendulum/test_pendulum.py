"""The pendulum: its physics, and the diagnosis of blind ones."""

from __future__ import annotations

import numpy as np
import pytest
from rows import EXPECTED, ROWS, row_record
from sizes import nightly_but

from ves_twin.diagnosis.detectability import detectability
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.forward import Excitation
from ves_twin.diagnosis.linearise import linearise
from ves_twin.diagnosis.runs import Runs
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict import Kind
from ves_twin.diagnosis.whitening import whitening_declared
from ves_twin.machines.pendulum.forward import STEP, Pendulum, edited
from ves_twin.suites.bench import BlindRig
from ves_twin.suites.benches import bench_of
from ves_twin.suites.pendulum import asked_torque

TORQUE = asked_torque(1)
TIME = STEP * np.arange(len(TORQUE))
FED = Excitation("multisine", TIME, {"joint.torque": TORQUE[:, None]})
PLANT = Pendulum()
BENCH = bench_of("pendulum")


def blind_record(seed, hidden=None, outside="", size=0.0):
    """A measured pendulum of the blind suites: every commissioning parameter drawn anew."""
    rng = np.random.default_rng(seed)
    values = BENCH.commissioned(rng)
    for name, departure in (hidden or {}).items():
        values[name] = values.get(name, 0.0) + departure
    return BENCH.record(BlindRig(values, outside, size), "train", rng)


@pytest.fixture(scope="module")
def settings(tmp_path_factory):
    return Settings(nulls=60, cache=tmp_path_factory.mktemp("banks"))


def test_the_motion_is_that_of_the_equation_of_motion():
    """I q'' + d q' + m g l sin q = u by classic Runge-Kutta, the torque held for each row."""
    model = edited({p.name: p.nominal for p in PLANT.parameters})
    about_joint = float(model.body_inertia[1][0] + model.body_mass[1] * 0.2**2 + 0.01)

    def rate(x, torque):
        return np.array([x[1], (torque - 0.05 * x[1] - 9.81 * 0.2 * np.sin(x[0])) / about_joint])

    exact = np.zeros((1000, 2))
    for k in range(len(exact) - 1):
        a = rate(exact[k], TORQUE[k])
        b = rate(exact[k] + STEP / 2 * a, TORQUE[k])
        c = rate(exact[k] + STEP / 2 * b, TORQUE[k])
        d = rate(exact[k] + STEP * c, TORQUE[k])
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
    late = PLANT.simulate(FED, {"sensor.delay": 5 * STEP})
    assert late[5:] == pytest.approx(nominal[:-5], abs=1e-12)
    offset = PLANT.simulate(FED, {"encoder.bias": 0.02})
    assert offset - nominal == pytest.approx(np.tile([0.02, 0.0], (len(TIME), 1)), abs=1e-15)
    half = Excitation("half", TIME, {"joint.torque": 0.5 * TORQUE[:, None]})
    assert PLANT.simulate(FED, {"drive.gain": 0.5}) == pytest.approx(PLANT.simulate(half, {}))


@pytest.mark.slow
@pytest.mark.parametrize("name", nightly_but(2, list(ROWS)))
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
            ("encoder_offset", {"encoder.bias": -0.013}),
            ("coulomb_friction", {"joint.friction": 0.004}),
            ("joint_stiffness", {"joint.stiffness": 0.02}),
            ("delay", {"sensor.delay": 0.0024}),
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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "size"), nightly_but(1, [("quadratic_drag", 0.02), ("late_drift", 0.05)])
)
def test_effects_outside_the_library_are_unknown(kind, size, settings):
    data = blind_record(5, outside=kind, size=size)
    assert diagnose(PLANT, [data], settings=settings).verdict is Kind.UNKNOWN


@pytest.mark.slow
def test_where_a_delay_sits_cannot_be_told_from_rest_in_open_loop():
    plant = Pendulum.with_command_delay()
    data = blind_record(8, {"sensor.delay": 0.004})
    v = diagnose(plant, [data], settings=Settings(nulls=60))
    assert v.verdict is Kind.AMBIGUOUS
    assert {f"{c.effect}@{c.target}" for c in v.causes} == {"delay@sensor", "delay@command"}


@pytest.mark.slow
def test_a_fault_that_was_repaired_meanwhile_extends_nothing(settings):
    """Commissioning errors bent to mimic a spring do worse than the spring, and both are wrong."""
    rng = np.random.default_rng(3)
    usual = BENCH.commissioned(rng)
    sick = {**usual, "joint.stiffness": 0.015}
    train = BENCH.record(BlindRig(sick), "train", rng)
    for values, confirmed in ((usual, False), (sick, True)):
        held = BENCH.record(BlindRig(values), "held_out", rng)
        v = diagnose(PLANT, [train], held_out=[held], settings=settings)
        assert v.causes[0].effect == "joint_stiffness"
        assert v.gain.passed == confirmed
        assert v.gain.low > 0.0  # against the commissioning errors alone it would do
