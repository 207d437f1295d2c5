"""Sweeps on processes: the table, interruption, workers that die."""

import multiprocessing
import os
import signal
import threading
import time

import pyarrow.parquet as pq
import pytest

import ves_twin as vt
from ves_twin.simulator.emulation_error import emulation_error
from ves_twin.sweeps.plan import plan_sweep
from ves_twin.sweeps.process_engine import ProcessEngine
from ves_twin.sweeps.run_point import ForeignWorkerError, run_hash, run_point
from ves_twin.sweeps.sweep import carry_out_sweep
from ves_twin.sweeps.table import TABLE_NAME


@pytest.fixture(scope="module")
def swept(small_plan, tmp_path_factory):
    """The small sweep on two processes: account and table."""
    folder = tmp_path_factory.mktemp("sweep")
    account = carry_out_sweep(small_plan, folder, ProcessEngine(2))
    return account, pq.read_table(account.table)


def test_each_row_is_what_the_run_alone_gives(small_plan, swept):
    account, table = swept
    assert account.outcomes == {"completed": 4}
    rows = table.to_pylist()
    for row, point in zip(rows, small_plan.points, strict=True):
        run = vt.simulate(point.scenario)
        assert row["run_hash"] == run_hash(run)
        assert row["plant_hash"] == run.info.plant_hash
        parts = (run["truth.pose"], run["reference.pose"], run["reference.pose_leg_lag"])
        for axis, error in emulation_error([parts]).items():
            assert row[f"error.{axis}.rms"] == error.rms
            assert row[f"error.{axis}.peak"] == error.peak
    assert len({row["run_hash"] for row in rows}) == 4


def test_columns_say_their_units(swept):
    schema = swept[1].schema
    units = {field.name: (field.metadata or {}).get(b"unit") for field in schema}
    assert units["legs.gain"] == b"1/s"
    assert units["effects.valve_null.leg.3.null"] == b"1"
    assert (units["error.z.peak"], units["error.rz.peak"]) == (b"m", b"rad")
    assert units["duration"] == b"s"


def test_an_interrupted_sweep_goes_on_and_ends_in_the_same_bytes(small_plan, swept, tmp_path):
    def stop_after_two(done: int, points: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        carry_out_sweep(small_plan, tmp_path, ProcessEngine(1), stop_after_two)
    assert not (tmp_path / TABLE_NAME).exists()
    account = carry_out_sweep(small_plan, tmp_path, ProcessEngine(1))
    assert account.found == 2
    assert account.table.read_bytes() == swept[0].table.read_bytes()


def test_failures_are_rows_with_their_outcome_and_reason(tmp_path):
    """A base too light for the loop, a pose out of reach, and one that is well."""
    settings = {"run.duration": 3.0, "run.settle": 0.2}
    plan = plan_sweep("position_sine", ["platform.start=[0,0,0,0,0,0],[0.5,0,0,0,0,0]"], settings)
    loud = plan_sweep("position_sine", ["platform.motion.amplitude=[0.6,0,0,0,0,0]"], settings)
    account = carry_out_sweep(plan, tmp_path / "reach", ProcessEngine(1))
    well, refused = pq.read_table(account.table).to_pylist()
    assert well["outcome"] == "completed"
    assert refused["outcome"] == "refused"
    assert "needs leg" in refused["reason"]
    assert run_point(loud.points[0]).outcome == "leg_limit"
    assert "left the safety margin" in run_point(loud.points[0]).reason


@pytest.mark.parametrize("scenario", ["position_sine", "beam_horizontal_truth"])
def test_a_run_that_fails_while_it_settles_is_a_row_too(scenario):
    weak = {"run.duration": 0.2, "run.settle": 0.2, "parameters.sensor.range": [500.0] * 6}
    result = run_point(plan_sweep(scenario, ["legs.gain=12"], weak).points[0])
    assert (result.outcome, result.duration) == ("wrench_range", 0.0)
    assert "while settling" in result.reason
    assert result.tracking_error == result.emulation_error == {}


def test_whatever_fails_after_the_run_is_a_row_too(small_plan, monkeypatch):
    monkeypatch.setattr("ves_twin.sweeps.run_point.simulate", lambda *_: None)
    assert run_point(small_plan.points[0]).outcome == "error"


def test_a_worker_with_other_versions_is_refused(small_plan):
    point = small_plan.points[0]
    old = type(point)(**{**vars(point), "versions": {**point.versions, "mujoco": "1.0"}})
    with pytest.raises(ForeignWorkerError, match=r"mujoco 3.*the sweep 1\.0"):
        run_point(old)
    changed = type(point)(**{**vars(point), "plant_hash": "0" * 16})
    with pytest.raises(ForeignWorkerError, match="model files differ"):
        run_point(changed)


class Killer(threading.Thread):
    """Kills worker processes of this test as they appear, a number of times."""

    def __init__(self, times: int) -> None:
        super().__init__(daemon=True)
        self.times, self.killed = times, set()

    def run(self) -> None:
        while len(self.killed) < self.times:
            for child in multiprocessing.active_children():
                if child.pid not in self.killed and len(self.killed) < self.times:
                    os.kill(child.pid, signal.SIGKILL)
                    self.killed.add(child.pid)
            time.sleep(0.01)


@pytest.mark.nightly
def test_points_of_a_worker_that_is_killed_run_again(small_plan, swept, tmp_path):
    killer = Killer(2)
    killer.start()
    account = carry_out_sweep(small_plan, tmp_path, ProcessEngine(2))
    killer.join()
    assert len(killer.killed) == 2
    assert account.outcomes == {"completed": 4}
    assert account.table.read_bytes() == swept[0].table.read_bytes()


def test_a_point_that_always_kills_its_worker_is_a_row_and_is_tried_again_later(tmp_path):
    plan = plan_sweep("position_sine", ["seed=1"], {"run.duration": 0.2, "run.settle": 0.2})
    killer = Killer(3)
    killer.start()
    account = carry_out_sweep(plan, tmp_path, ProcessEngine(1))
    killer.join()
    assert account.outcomes == {"lost": 1}
    assert not account.whole
    row = pq.read_table(account.table).to_pylist()[0]
    assert "died 3 times" in row["reason"]
    again = carry_out_sweep(plan, tmp_path, ProcessEngine(1))
    assert again.outcomes == {"completed": 1}
