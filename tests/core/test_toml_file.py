"""TOML files: numbers that TOML does not have are refused, wherever they stand."""

import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.toml_file import read_toml


@pytest.mark.parametrize("number", [str(2**63), str(-(2**63) - 1), "1" + "0" * 400, "9" * 5000])
@pytest.mark.parametrize("text", ["a = {}", "a = [[1], [{}]]", "[a.b]\nc = {}", "[[a]]\nb = {}"])
def test_an_integer_beyond_64_bits_is_refused_in_one_line(text, number, tmp_path):
    path = tmp_path / "a.toml"
    path.write_text(text.replace("{}", number))
    with pytest.raises(InvalidInputError, match="valid TOML") as caught:
        read_toml("file", path)
    assert len(str(caught.value)) < 300


def test_the_largest_integers_of_toml_are_read(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text(f"a = {2**63 - 1}\nb = {-(2**63)}\n")
    assert read_toml("file", path)[0] == {"a": 2**63 - 1, "b": -(2**63)}
