"""Emulated systems given as a beam, and the checks of anybody's matrices."""

import numpy as np
import pytest

from ves_twin.core.errors import VesTwinError
from ves_twin.mechanics.beams.beam import BentBeam, StraightBeam
from ves_twin.mechanics.beams.section import Material, Tube
from ves_twin.mechanics.emulated import EmulatedSystem

BEAM = """
[beam]
shape = "bent"
form = "corrected"
l1 = "800 cm"
l2 = 8.0
outer_diameter = "90 mm"
wall = "7 mm"
"""
HEAD = 'schema = 1\ncoupling = "beam"\n'


@pytest.fixture
def load(tmp_path):
    def build(text):
        path = tmp_path / "model.toml"
        path.write_text(HEAD + text)
        return EmulatedSystem.load(str(path))

    return build


def test_a_beam_table_is_the_beam_of_the_library(load):
    expected = BentBeam(8.0, 8.0, Tube(0.09, 0.007)).corrected()
    for system in (load(BEAM), EmulatedSystem.load("beam_bent_corrected")):
        np.testing.assert_allclose(system.mass, expected.mass, rtol=1e-12)
        np.testing.assert_allclose(system.stiffness, expected.stiffness, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(system.damping, expected.damping, rtol=1e-9, atol=1e-9)


def test_material_damping_and_direction_are_read(load):
    text = (
        '[beam]\nshape = "straight"\nform = "reduced"\nlength = 3\ndirection = [0, 1, 0]\n'
        "outer_diameter = 0.1\nwall = 0.01\nelasticity = 2.1e11\nrigidity = 8e10\ndensity = 7850\n"
        "damping_ratio = 0.01\n"
    )
    tube = Tube(0.1, 0.01, Material(2.1e11, 8e10, 7850.0))
    expected = StraightBeam(3.0, tube, (0.0, 1.0, 0.0)).reduced(0.01)
    system = load(text)
    np.testing.assert_array_equal(system.mass, expected.mass)
    np.testing.assert_array_equal(system.damping, expected.damping)


def full(diagonal, i, j, value, across=None):
    matrix = np.diag(diagonal)
    matrix[i, j], matrix[j, i] = value, value if across is None else across
    return str(matrix.tolist())


ONES = "[1.0, 1.0, 1.0, 1.0, 1.0, 1.0]"
PLAIN = f"mass = {ONES}\ndamping = {ONES}\n"
SKEW = full([1.0] * 6, 0, 1, 0.5, 0.1)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (f"{PLAIN}stiffness = {SKEW}", ["stiffness", "row 1, column 2", "0.5", "0.1", "nonsymm"]),
        (f"mass = {SKEW}\ndamping = {ONES}\nstiffness = {ONES}", ["mass", "symmetric matrix"]),
        (f"{PLAIN}stiffness = {full([1.0] * 6, 0, 1, 2.0)}", ["stiffness", "semi-definite", "-1"]),
        (
            f"mass = {ONES}\ndamping = [-1.0, 0, 0, 0, 0, 0]\nstiffness = {ONES}",
            ["damping", "semi"],
        ),
        (f"{PLAIN}stiffness = {ONES}\nunits = 'kN, mm'", ["units", "SI"]),
        (f"{PLAIN}stiffness = {ONES}\nnonsymmetric = ['mass']", ["nonsymmetric", "'damping'"]),
        (f"{PLAIN}stiffness = {ONES}\nnonsymmetric = 'all'", ["nonsymmetric", "list"]),
        (f"{PLAIN}stiffness = {ONES}\nnonsymmetric = ['damping']", ["no exception"]),
        (f"mass = {ONES}{BEAM}", ["mass", "[beam]"]),
        (BEAM.replace("bent", "bend"), ["beam.shape", "'bent'"]),
        (BEAM.replace("corrected", "correct"), ["beam.form", "'corrected'"]),
        (BEAM.replace("l2", "l3"), ["key of beam", "'l2'"]),
        (BEAM.replace('wall = "7 mm"', ""), ["beam.wall", "no default"]),
        (BEAM.replace('"7 mm"', '"7 kg"'), ["beam.wall", "m"]),
        (BEAM.replace('"7 mm"', '"70 mm"'), ["wall", "0.045"]),
        (BEAM + "damping_ratio = -0.1", ["damping_ratio", "at least 0"]),
        (BEAM.replace("corrected", "thesis") + "damping_ratio = 0.1", ["key of beam"]),
        ("beam = 3", ["beam", "table"]),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(load, text, words):
    with pytest.raises(VesTwinError) as caught:
        load(text)
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_the_printed_skew_damping_loads_by_its_declared_exception(load):
    system = EmulatedSystem.load("beam_bent_thesis")
    assert system.damping[0, 4] == -122.0
    assert system.damping[4, 0] == -4.0
    rows = str(system.damping.tolist())
    with pytest.raises(VesTwinError, match=r'nonsymmetric = \["damping"\]'):
        load(f"mass = {ONES}\nstiffness = {ONES}\ndamping = {rows}")


def test_a_free_base_without_spring_loads(load):
    zeros = "[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]"
    assert not np.any(load(f"{PLAIN}stiffness = {zeros}").stiffness)


@pytest.mark.parametrize("form", ["corrected", "reduced", "thesis"])
def test_a_beam_beyond_the_range_of_numbers_is_refused_in_one_line(load, form):
    text = BEAM.replace("corrected", form).replace('"800 cm"', "1e308")
    with pytest.raises(VesTwinError, match="finite") as caught:
        load(text)
    assert "\n" not in str(caught.value)
