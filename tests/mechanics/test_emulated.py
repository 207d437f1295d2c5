"""Emulated systems: printed frequencies, exact discretisation, clear refusals."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import sqrtm
from scipy.signal import cont2discrete

from ves_twin.core.errors import (
    FileAccessError,
    InvalidInputError,
    UnknownNameError,
    VersionError,
    VesTwinError,
)
from ves_twin.mechanics.emulated import Coupling, EmulatedSystem

MODELS = ["beam_horizontal_thesis", "beam_horizontal_corrected", "table_5_2"]
MODELS += ["beam_vertical_thesis", "beam_vertical_corrected", "beam_bent_thesis", "free_float"]
EXPONENTIALS = 1e-10
"""Relative to the largest entry of a row: expm of two libraries, entries up to 592 rad/s."""
PRINTED = 0.005
"""Relative: half of the third printed digit."""
INTEGRATED = 1e-8
"""Relative: the integrator's own tolerance is 1e-10, over one period."""

PLAIN = {
    "schema": "1",
    "coupling": '"decoupled"',
    "mass": "[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]",
    "damping": "[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]",
    "stiffness": "[1.0, 1.0, 1.0, 1.0, 1.0, 1.0]",
}


@pytest.fixture
def load(tmp_path):
    def build(**changes):
        content = {**PLAIN, **changes}
        path = tmp_path / "model.toml"
        path.write_text("".join(f"{k} = {v}\n" for k, v in content.items() if v is not None))
        return EmulatedSystem.load(str(path))

    return build


def continuous(system):
    inverse = np.linalg.inv(system.mass)
    a = np.block(
        [[np.zeros((6, 6)), np.eye(6)], [-inverse @ system.stiffness, -inverse @ system.damping]]
    )
    return a, np.vstack([np.zeros((6, 6)), inverse])


def assert_rows_agree(found, expected, tolerance):
    scale = np.max(np.abs(expected), axis=1, keepdims=True)
    assert np.max(np.abs(found - expected) / scale) < tolerance


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("beam_horizontal_thesis", [0.156, 0.162, 0.315, 0.707, 8.73]),
        ("beam_horizontal_corrected", [0.162, 0.162, 0.707, 0.707, 3.77]),
    ],
)
def test_the_beam_has_the_frequencies_of_errata_e_10(name, printed):
    system = EmulatedSystem.load(name)
    squares = np.linalg.eigvals(np.linalg.solve(system.mass, system.stiffness))
    found = np.sort(np.sqrt(squares.real)) / (2 * np.pi)
    np.testing.assert_allclose(found[:5], printed, rtol=PRINTED)
    assert abs(found[5] - 94.0) < 0.5


@pytest.mark.parametrize("name", MODELS[:2])
def test_the_beam_s_stiffness_is_that_of_its_tube(name):
    """12 m, 70 mm outside, 6 mm wall, E = 72 GPa, G = 27 GPa; root at -X, beam along X."""
    outer, inner, length = 0.070, 0.058, 12.0
    second = np.pi / 64 * (outer**4 - inner**4)
    ei, gj, ea = 72e9 * second, 27e9 * 2 * second, 72e9 * np.pi / 4 * (outer**2 - inner**2)
    expected = np.diag(
        [ea / length, *[12 * ei / length**3] * 2, gj / length, *[4 * ei / length] * 2]
    )
    expected[1, 5] = expected[5, 1] = 6 * ei / length**2
    expected[2, 4] = expected[4, 2] = -6 * ei / length**2
    stiffness = EmulatedSystem.load(name).stiffness
    # the axial 7e6 is printed with one digit, all else with three
    np.testing.assert_allclose(stiffness[0], expected[0], rtol=0, atol=0.5e6)
    np.testing.assert_allclose(stiffness[1:], expected[1:], rtol=PRINTED)


def test_the_corrected_beam_differs_in_two_inertias_only():
    printed, corrected = (EmulatedSystem.load(name) for name in MODELS[:2])
    np.testing.assert_array_equal(printed.stiffness, corrected.stiffness)
    np.testing.assert_array_equal(printed.damping, corrected.damping)
    np.testing.assert_array_equal(np.diag(printed.mass)[3:], [2900.0, 2900.0, 5.0])
    np.testing.assert_array_equal(np.diag(corrected.mass)[3:], [5.0, 2900.0, 2900.0])


def test_the_vertical_beam_is_the_horizontal_one_turned():
    """Turned by 90 deg about Y, so that -X, in which the beam leaves its root, becomes +Z."""
    upright, lying = (
        EmulatedSystem.load(f"beam_{way}_thesis") for way in ("vertical", "horizontal")
    )
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    both = np.kron(np.eye(2), turn)
    for matrix in ("stiffness", "damping"):
        expected = both @ getattr(lying, matrix) @ both.T
        np.testing.assert_allclose(getattr(upright, matrix), expected, rtol=0, atol=1e-9)
    # printed, the two M are interchanged (E-10): each has the 5 kg m^2 across its beam
    assert (np.argmin(np.diag(upright.mass)), np.argmin(np.diag(lying.mass))) == (3, 5)


def bent_beam_compliance(ei, gj, ea, length, faulty):
    """Q of two equal tubes, L1 along -X and then L2 along +Z; `faulty` as the thesis has Q55."""
    q = np.zeros((6, 6))
    one, two, three = length, length**2, length**3
    q[0, 0] = three / (3 * ei) + one / ea + three / ei
    q[0, 2] = three / (2 * ei)
    q[0, 4] = two / (2 * ei) + two / ei
    q[1, 1] = 2 * three / (3 * ei) + three / gj
    q[1, 3] = -two / (2 * ei) - two / gj
    q[1, 5] = -two / (2 * ei)
    q[2, 2] = one / ea + three / (3 * ei)
    q[2, 4] = two / (2 * ei)
    q[3, 3] = q[5, 5] = one / ei + one / gj
    q[4, 4] = one / ei + (one / gj if faulty else one / ei)
    return q + np.triu(q, 1).T


def test_the_bent_beam_has_the_printed_errors():
    """K inverts a compliance with L1 / GJ in Q55 (E-15); B is 0.1 sqrtm(K M), M twice too heavy
    in translation and of another order in rotation (E-17, E-18), all to the printed digit."""
    outer, wall, length = 0.090, 0.007, 8.0
    inner = outer - 2 * wall
    second, area = np.pi / 64 * (outer**4 - inner**4), np.pi / 4 * (outer**2 - inner**2)
    ei, gj, ea = 72e9 * second, 27e9 * 2 * second, 72e9 * area
    system = EmulatedSystem.load("beam_bent_thesis")
    stiffness = np.linalg.inv(bent_beam_compliance(ei, gj, ea, length, faulty=True))
    np.testing.assert_allclose(system.stiffness, stiffness, rtol=0, atol=0.75)
    right = np.linalg.inv(bent_beam_compliance(ei, gj, ea, length, faulty=False))
    assert np.max(np.abs(system.stiffness - right)) > 2e4
    beam = 2800.0 * area * 2 * length
    assumed = np.diag([beam, beam, beam, 2617.0, 2617.0, 5233.0])
    damping = np.real(sqrtm(stiffness @ assumed)) * 0.1
    # printed with whole numbers, some cut off: 805.7 is 800
    np.testing.assert_allclose(system.damping, damping, rtol=0.008, atol=1.0)
    assert not np.allclose(system.damping, system.damping.T, atol=100.0)
    np.testing.assert_allclose(np.diag(system.mass)[:3], beam / 2, rtol=0.01)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("beam_vertical_thesis", [0.156, 0.162, 0.315, 0.707, 8.73]),
        ("beam_bent_thesis", [0.167, 0.192, 0.197, 0.643, 0.725, 1.165]),
        ("free_float", [0.0] * 6),
    ],
)
def test_the_other_models_have_the_frequencies_of_the_fact_sheet(name, expected):
    system = EmulatedSystem.load(name)
    squares = np.linalg.eigvals(np.linalg.solve(system.mass, system.stiffness))
    found = np.sort(np.sqrt(squares.real)) / (2 * np.pi)
    np.testing.assert_allclose(found[: len(expected)], expected, rtol=PRINTED)


def test_the_free_spacecraft_is_a_homogeneous_cube():
    system = EmulatedSystem.load("free_float")
    assert not system.stiffness.any()
    assert not system.damping.any()
    np.testing.assert_allclose(np.diag(system.mass), [1200.0] * 3 + [1200.0 * 2.0**2 / 6] * 3)


@pytest.mark.parametrize("name", MODELS)
def test_every_shipped_model_names_its_source_and_its_coupling(name):
    system = EmulatedSystem.load(name)
    assert system.name == name
    assert system.source.strip()
    assert system.coupling in set(Coupling)
    diagonal = not np.any(system.stiffness - np.diag(np.diag(system.stiffness)))
    assert diagonal == (system.coupling == Coupling.DECOUPLED)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("rate", [75.0, 85.0, 1000.0])
def test_the_discrete_form_equals_scipy(name, rate):
    system = EmulatedSystem.load(name)
    a, b = continuous(system)
    phi, gamma, *_ = cont2discrete((a, b, np.eye(12), np.zeros((12, 6))), 1.0 / rate, "zoh")
    found = system.discretise(1.0 / rate)
    assert found[0].shape == (12, 12)
    assert found[1].shape == (12, 6)
    assert_rows_agree(found[0], phi, EXPONENTIALS)
    assert_rows_agree(found[1], gamma, EXPONENTIALS)


@pytest.mark.parametrize("name", MODELS)
def test_the_discrete_form_equals_python_control(name):
    control = pytest.importorskip("control")
    system = EmulatedSystem.load(name)
    a, b = continuous(system)
    sampled = control.sample_system(control.ss(a, b, np.eye(12), np.zeros((12, 6))), 1 / 80, "zoh")
    phi, gamma = system.discretise(1 / 80)
    assert_rows_agree(phi, sampled.A, EXPONENTIALS)
    assert_rows_agree(gamma, sampled.B, EXPONENTIALS)


@pytest.mark.parametrize("name", MODELS)
def test_one_step_is_the_integral_of_the_equation_of_motion(name):
    system = EmulatedSystem.load(name)
    rng = np.random.default_rng(13)
    state, wrench = rng.normal(size=12) * 0.1, rng.normal(size=6) * 50.0

    def motion(_, x):
        force = wrench - system.damping @ x[6:] - system.stiffness @ x[:6]
        return np.concatenate([x[6:], np.linalg.solve(system.mass, force)])

    end = solve_ivp(motion, (0, 1 / 80), state, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    phi, gamma = system.discretise(1 / 80)
    np.testing.assert_allclose(phi @ state + gamma @ wrench, end, rtol=INTEGRATED, atol=INTEGRATED)


def test_two_half_steps_are_one_step():
    system = EmulatedSystem.load("table_5_2")
    phi, gamma = system.discretise(0.01)
    half_phi, half_gamma = system.discretise(0.005)
    np.testing.assert_allclose(half_phi @ half_phi, phi, rtol=0, atol=1e-14)
    np.testing.assert_allclose(half_phi @ half_gamma + half_gamma, gamma, rtol=0, atol=1e-14)


def test_six_numbers_are_a_diagonal(load):
    np.testing.assert_array_equal(load().mass, np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))


def test_numbers_near_the_end_of_doubles_do_not_overflow(load):
    assert load(mass=str([1e300] * 6), stiffness=str([1e300] * 6)).mass[0, 0] == 1e300


def unsymmetric():
    mass = np.eye(6)
    mass[0, 1] = 0.5
    return str(mass.tolist())


@pytest.mark.parametrize(
    ("changes", "kind", "words"),
    [
        ({"mass": unsymmetric()}, InvalidInputError, ["mass", "symmetric"]),
        ({"mass": "[1.0, 1.0, 1.0, 1.0, 1.0, -1.0]"}, InvalidInputError, ["positive definite"]),
        ({"mass": "[1.0, 1.0, 1.0, 1.0, 1.0, 0.0]"}, InvalidInputError, ["positive definite"]),
        ({"mass": "[1.0, 2.0]"}, InvalidInputError, ["mass", "6 rows"]),
        ({"stiffness": "[[1.0], [1.0, 2.0]]"}, InvalidInputError, ["stiffness", "6 rows"]),
        ({"damping": "'much'"}, InvalidInputError, ["damping", "6 numbers"]),
        ({"damping": "3.0"}, InvalidInputError, ["damping", "6 numbers"]),
        ({"damping": None}, InvalidInputError, ["damping", "6 numbers"]),
        ({"damping": "[nan, 0, 0, 0, 0, 0]"}, InvalidInputError, ["damping", "finite"]),
        ({"stiffness": "[inf, 0, 0, 0, 0, 0]"}, InvalidInputError, ["stiffness", "finite"]),
        ({"schema": "2"}, VersionError, ["schema version 2", "(1)"]),
        ({"schema": None}, VersionError, ["None"]),
        ({"stifness": "[1.0]"}, UnknownNameError, ["'stiffness'"]),
        ({"coupling": '"beem"'}, UnknownNameError, ["'beam'"]),
        ({"coupling": None}, UnknownNameError, ["coupling"]),
        ({"mass": "[1.0, "}, InvalidInputError, ["TOML"]),
    ],
    ids=str,
)
def test_a_wrong_file_is_refused_in_one_line(load, changes, kind, words):
    with pytest.raises(VesTwinError) as caught:
        load(**changes)
    assert type(caught.value) is kind
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_a_file_nested_too_deeply_is_refused(load):
    with pytest.raises(VesTwinError):
        load(mass="[" * 20000)


def test_an_unknown_model_is_answered_with_the_nearest():
    with pytest.raises(UnknownNameError, match="did you mean 'table_5_2'"):
        EmulatedSystem.load("table_5_3")


def test_a_file_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(FileAccessError):
        EmulatedSystem.load(str(tmp_path / "no.toml"))
