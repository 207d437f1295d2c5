"""Emulated systems: printed frequencies, exact discretisation, clear refusals."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete

from ves_twin.control.emulated import Coupling, EmulatedSystem
from ves_twin.errors import (
    FileAccessError,
    InvalidInputError,
    UnknownNameError,
    VersionError,
    VesTwinError,
)

MODELS = ["beam_horizontal_thesis", "beam_horizontal_corrected", "table_5_2"]
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
