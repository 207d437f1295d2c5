"""Set-point files: what is read, what is refused."""

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.scenario.setpoint_file import read_setpoints

LEGS = ",".join(f"leg.command.{i}" for i in range(1, 7))
ARM = ",".join(f"arm.command.{i}" for i in range(1, 4))


def written(tmp_path, head, times, row):
    path = tmp_path / "next.csv"
    path.write_text("\n".join([head, *(f"{t},{row}" for t in times)]) + "\n")
    return str(path)


def test_times_count_from_the_first_row_and_the_arm_may_be_absent(tmp_path):
    path = written(tmp_path, f"t,{LEGS}", [5.0, 5.1, 5.2, 5.3], "1,1,1,1,1,1")
    found = read_setpoints(path)
    assert found.time == pytest.approx([0.0, 0.1, 0.2, 0.3])
    assert found.legs.shape == (4, 6)
    assert found.arm is None
    both = written(tmp_path, f"t,{LEGS},{ARM}", [0, 1, 2, 3], "1,1,1,1,1,1,0.5,0,0")
    np.testing.assert_allclose(read_setpoints(both).arm[:, 0], 0.5)


@pytest.mark.parametrize(
    ("head", "times", "row", "words"),
    [
        (f"t,{ARM}", [0, 1, 2, 3], "0,0,0", "leg.command.6"),
        (f"t,{LEGS},arm.command.1", [0, 1, 2, 3], "1,1,1,1,1,1,0", "arm.command.3"),
        (f"t,{LEGS}", [0, 1, 2, 4], "1,1,1,1,1,1", "evenly apart"),
        (f"t,{LEGS}", [0, 1], "1,1,1,1,1,1", "4 or more"),
        (f"t,{LEGS}", [0, 1, 2, 3], "1,1,nan,1,1,1", "finite"),
        (f"t,{LEGS},{ARM}", [0, 1, 2, 3], "1,1,1,1,1,1,90,0,0", "radians"),
    ],
)
def test_a_file_that_cannot_be_followed_is_refused(tmp_path, head, times, row, words):
    with pytest.raises(InvalidInputError, match=words):
        read_setpoints(written(tmp_path, head, times, row))


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(UnknownNameError, match="operator_example"):
        read_setpoints("operator_exampel")
