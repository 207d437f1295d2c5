"""Columns of numbers from a file that a scenario names: no line of a foreign file is shown."""

import pytest

from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError
from ves_twin.scenario.columns import read_columns

SECRET = "root:x:0:0"


@pytest.mark.parametrize("key", ["arm.operator", "platform.setpoints"])
def test_a_file_of_another_kind_is_not_read(tmp_path, capsys, key):
    (tmp_path / "passwd").write_text(f"{SECRET}\n{SECRET},1\n")
    words = ["run", "position_sine", "--set", f"{key}={tmp_path / 'passwd'}"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert SECRET not in said
    assert said.count("\n") == 1


def test_a_row_of_another_width_is_not_quoted(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(f"t,q1\n0,0\n{SECRET}\n")
    with pytest.raises(InvalidInputError, match="Expected 2 columns, got 1") as caught:
        read_columns("operator file", path, ("t", "q1"))
    assert SECRET not in str(caught.value)
