"""LearnedGravity: a file that knows its experiment, and refuses another one."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.mechanics.gravity.learned import LearnedGravity, PlannedExperiment

PLANNED = PlannedExperiment(
    sensor="s1",
    system="beam (b1)",
    start=(0.0,) * 6,
    period=0.0125,
    commands=np.linspace([0.0, 0.0, 0.0], [1.0, 2.0, 3.0], 50),
)


@pytest.fixture
def learned():
    return LearnedGravity(np.random.default_rng(1).normal(size=(50, 6)), PLANNED, "a test")


def test_what_is_written_is_what_is_read(tmp_path, learned):
    learned.save(tmp_path / "w.parquet")
    read = LearnedGravity.load(str(tmp_path / "w.parquet"))
    np.testing.assert_array_equal(read.wrenches, learned.wrenches)
    np.testing.assert_array_equal(read.experiment.commands, PLANNED.commands)
    read.check(PLANNED)
    assert [p.name for p in tmp_path.iterdir()] == ["w.parquet"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"commands": PLANNED.commands * 1.01}, "another motion: joint 3 differs by 0.03"),
        ({"commands": np.zeros((51, 3))}, "W_g of 0.625 s"),
        ({"system": "beam (b2)"}, "emulated system"),
        ({"sensor": "s2"}, "sensor"),
        ({"period": 0.01}, "80.000 Hz"),
        ({"start": (0.0, 0.0, 0.1, 0.0, 0.0, 0.0)}, "start pose"),
    ],
)
def test_another_experiment_is_refused(learned, change, message):
    with pytest.raises(InvalidInputError, match=message):
        learned.check(replace(PLANNED, **change))


def test_a_shorter_run_of_the_same_motion_is_allowed(learned):
    learned.check(replace(PLANNED, commands=PLANNED.commands[:20]))


def test_files_that_are_none_are_refused(tmp_path):
    path = tmp_path / "other.parquet"
    with pytest.raises(FileAccessError, match=r"other\.parquet"):
        LearnedGravity.load(str(path))
    path.write_text("no parquet")
    with pytest.raises(InvalidInputError, match="Learning Method"):
        LearnedGravity.load(str(path))
    pq.write_table(pa.table({"t": [0.0]}), path)
    with pytest.raises(InvalidInputError, match="Learning Method"):
        LearnedGravity.load(str(path))
