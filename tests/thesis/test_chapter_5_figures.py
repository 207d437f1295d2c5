"""Every figure of chapter 5 is drawn and says finite numbers."""

import math

import pytest
from sizes import nightly_but

from ves_twin.plant.plant import Plant
from ves_twin.thesis.figures.registry import FIGURES

CHAPTER_5 = ("5-3", "5-8", "5-10", "5-13", "5-2", "5-5", "5-11", "5-12")


@pytest.mark.slow
@pytest.mark.parametrize("number", nightly_but(4, CHAPTER_5))
def test_a_figure_is_drawn_with_its_numbers(number, tmp_path):
    name = f"fig-{number}"
    result = FIGURES[name](Plant.load("ves2"), tmp_path, True)
    assert result.id == name
    assert result.png == tmp_path / f"{name}.png"
    assert result.png.read_bytes().startswith(b"\x89PNG")
    assert result.numbers
    assert all(math.isfinite(value) for value in result.numbers.values())
