"""Ledger: rows that are kept once, whole, and only in their own sweep."""

import resource
import subprocess
import sys

import pytest

from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.sweeps.ledger import ROWS_NAME, Ledger, OtherSweepError
from ves_twin.sweeps.plan import plan_sweep
from ves_twin.sweeps.result import LOST, PointResult


def result_of(plan, number: int, outcome: str = "completed") -> PointResult:
    """A finished point."""
    return PointResult(number=number, run_id=plan.points[number].run_id, outcome=outcome)


def test_rows_are_found_again_and_a_second_one_is_not_kept(small_plan, tmp_path):
    with Ledger(tmp_path, small_plan) as ledger:
        assert ledger.keep(result_of(small_plan, 2))
        assert not ledger.keep(result_of(small_plan, 2, "diverged"))
    with Ledger(tmp_path, small_plan) as ledger:
        assert ledger.results == {2: result_of(small_plan, 2)}


@pytest.mark.parametrize("cut", [1, 10, 60])
def test_a_row_that_a_kill_cut_short_is_dropped_and_written_again(small_plan, tmp_path, cut):
    with Ledger(tmp_path, small_plan) as ledger:
        ledger.keep(result_of(small_plan, 0))
        ledger.keep(result_of(small_plan, 1))
    path = tmp_path / ROWS_NAME
    path.write_bytes(path.read_bytes()[:-cut])
    with Ledger(tmp_path, small_plan) as ledger:
        assert set(ledger.results) == {0}
        ledger.keep(result_of(small_plan, 1))
    with Ledger(tmp_path, small_plan) as ledger:
        assert set(ledger.results) == {0, 1}


def test_a_lost_point_is_tried_again(small_plan, tmp_path):
    with Ledger(tmp_path, small_plan) as ledger:
        ledger.keep(result_of(small_plan, 0, LOST))
    with Ledger(tmp_path, small_plan) as ledger:
        assert ledger.results == {}
        assert ledger.keep(result_of(small_plan, 0))
    with Ledger(tmp_path, small_plan) as ledger:
        assert ledger.results[0].outcome == "completed"


@pytest.mark.parametrize(
    ("vary", "seed", "says"),
    [
        (["legs.gain=8,12.7", "effects.valve_null.leg.3.null=0,0.01"], None, "its vary is"),
        (["legs.gain=8,12.6", "effects.valve_null.leg.3.null=0,0.01"], 3, "its settings is"),
    ],
)
def test_another_sweep_in_the_same_folder_is_refused(small_plan, tmp_path, vary, seed, says):
    with Ledger(tmp_path, small_plan):
        pass
    settings = {"run.duration": 0.2, "run.settle": 0.2}
    other = plan_sweep("beam_horizontal_truth", vary, settings, seed=seed)
    with pytest.raises(OtherSweepError, match=says):
        Ledger(tmp_path, other)


def test_rows_of_another_sweep_are_refused(small_plan, tmp_path):
    with Ledger(tmp_path, small_plan):
        pass
    foreign = result_of(small_plan, 1).model_copy(update={"run_id": "0" * 16})
    for line in (foreign.model_dump_json(), "{}", "[1", '{"number": 99}'):
        (tmp_path / ROWS_NAME).write_text(line + "\n")
        with pytest.raises(InvalidInputError, match="line 1"):
            Ledger(tmp_path, small_plan)


def test_a_sweep_that_is_running_keeps_its_folder_to_itself(small_plan, tmp_path):
    with Ledger(tmp_path, small_plan), pytest.raises(FileAccessError, match="another command"):
        Ledger(tmp_path, small_plan)


def test_a_full_disk_leaves_whole_rows_and_one_line(small_plan, tmp_path):
    """A limit on the size of files stands for the disk, in a process of its own."""
    with Ledger(tmp_path, small_plan) as ledger:
        ledger.keep(result_of(small_plan, 0))
    size = (tmp_path / ROWS_NAME).stat().st_size
    limit = max(size + 40, (tmp_path / "sweep.json").stat().st_size + 1)
    (tmp_path / "fill.py").write_text(f"""
import resource, sys
from pathlib import Path
from ves_twin.core.errors import FileAccessError
from ves_twin.sweeps.ledger import Ledger
from ves_twin.sweeps.plan import plan_sweep
from ves_twin.sweeps.result import PointResult
plan = plan_sweep("beam_horizontal_truth", {["legs.gain=8,12.6", "effects.valve_null.leg.3.null=0,0.01"]!r},
                  {{"run.duration": 0.2, "run.settle": 0.2}})
ledger = Ledger(Path({str(tmp_path)!r}), plan)
resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))
try:
    for n in (1, 2, 3):
        reason = "r" * {limit // 2}
        ledger.keep(PointResult(number=n, run_id=plan.points[n].run_id, outcome="completed", reason=reason))
except FileAccessError as error:
    print(error)
    sys.exit(7)
""")
    done = subprocess.run(
        [sys.executable, str(tmp_path / "fill.py")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 7, done.stderr
    assert "cannot write" in done.stdout
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY
    with Ledger(tmp_path, small_plan) as ledger:
        assert 0 in ledger.results
        assert len(ledger.results) < 4
    assert (tmp_path / ROWS_NAME).read_bytes().endswith(b"\n")


def test_a_folder_that_cannot_be_made_is_one_line(small_plan, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FileAccessError, match="cannot write"):
        Ledger(tmp_path / "file" / "sweep", small_plan)
