"""Operator files: what is followed, what is refused."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.scenario.operator import operator_motion

STILL = np.zeros(3)


def test_the_shipped_operator_is_followed_through_its_rows():
    motion = operator_motion("operator_example", STILL)
    np.testing.assert_allclose(motion.q(-1.0), STILL)
    np.testing.assert_allclose(motion.q(1e3), motion.q(20.0))
    times = np.arange(0.0, 20.0, 0.01)
    angles = np.array([motion.q(t) for t in times])
    assert np.max(np.abs(np.diff(angles, axis=0))) / 0.01 < 2.95  # rad/s, of the planned move


def test_csv_and_parquet_say_the_same(tmp_path):
    rows = {"t": [0.0, 1.0, 2.0], "q1": [0.0, 0.1, 0.3], "q2": [0.0] * 3, "q3": [0.0] * 3}
    pq.write_table(pa.table(rows), tmp_path / "o.parquet")
    lines = [",".join(map(str, row)) for row in zip(*rows.values(), strict=True)]
    (tmp_path / "o.csv").write_text("\n".join(["t,q1,q2,q3", *lines]))
    one, two = (operator_motion(str(tmp_path / f"o.{end}"), STILL) for end in ("csv", "parquet"))
    np.testing.assert_array_equal(one.q(0.7), two.q(0.7))
    np.testing.assert_allclose(one.q(1.0), [0.1, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,q1,q2\n0,0,0\n1,0,0", "columns"),
        ("t,q1,q2,q3\n0,0,0,0\n0,1,0,0", "increasing"),
        ("t,q1,q2,q3\n0,0,0,0\n1,nan,0,0", "finite"),
        ("t,q1,q2,q3\n0,0,0,0\n1,abc,0,0", "numbers"),
        ("t,q1,q2,q3\n0,0,0,0\n1,90,0,0", "radians"),
        ("t,q1,q2,q3\n0,1,0,0\n1,1,0,0", "arm.start"),
    ],
)
def test_a_file_that_cannot_be_followed_is_refused(tmp_path, text, message):
    path = tmp_path / "o.csv"
    path.write_text(text)
    with pytest.raises(InvalidInputError, match=message):
        operator_motion(str(path), STILL)


def test_an_unknown_operator_is_answered_with_the_nearest():
    with pytest.raises(UnknownNameError, match="operator_example"):
        operator_motion("operator_exampel", STILL)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gravity": {"method": "learned", "file": "w.parquet"}}, "known in advance"),
        ({"gravity": {"method": "learned"}}, "gravity.file"),
        ({"arm.moves": [{"start": 0.0, "duration": 1.0, "to": [1, 0, 0]}]}, "arm.operator"),
    ],
)
def test_the_scenario_says_what_does_not_go_with_an_operator(changes, message):
    with pytest.raises(InvalidInputError, match=message):
        vt.Scenario.load("teleoperation", changes)
