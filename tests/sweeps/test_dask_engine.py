"""Sweeps on a cluster of this machine: the same table, and a worker killed half way."""

import contextlib
import logging
import os
import signal

import psutil
import pyarrow.parquet as pq
import pytest
from distributed import Client, LocalCluster

from ves_twin.sweeps.dask_engine import LOOPBACK, ClusterError, DaskEngine
from ves_twin.sweeps.ledger import ROWS_NAME
from ves_twin.sweeps.plan import plan_sweep
from ves_twin.sweeps.process_engine import ProcessEngine
from ves_twin.sweeps.sweep import carry_out_sweep

# dask.distributed gives up where its thread starts 10 s late, which a busy machine does
on_cluster = pytest.mark.nightly


@on_cluster
def test_a_worker_killed_half_way_loses_nothing_and_doubles_nothing(tmp_path):
    plan = plan_sweep(
        "beam_horizontal_truth", ["seed=0..9:10"], {"run.duration": 4.0, "run.settle": 0.2}
    )
    killed: list[int] = []
    with (
        LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            host=LOOPBACK,
            dashboard_address=f"{LOOPBACK}:0",
            worker_dashboard_address=None,
            silence_logs=logging.CRITICAL,
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):

        def kill_one(done: int, points: int) -> None:
            if 2 <= done < points and not killed:  # both workers are busy with a later point
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        engine = DaskEngine(cluster.scheduler_address, 1)
        account = carry_out_sweep(plan, tmp_path / "dask", engine, kill_one)
    assert killed
    assert account.outcomes == {"completed": 10}
    lines = (tmp_path / "dask" / ROWS_NAME).read_text().splitlines()
    assert len(lines) == 10
    rows = pq.read_table(account.table)
    assert rows["point"].to_pylist() == list(range(10))
    alone = carry_out_sweep(plan, tmp_path / "processes", ProcessEngine(2))
    assert account.table.read_bytes() == alone.table.read_bytes()


@on_cluster
def test_the_cluster_that_is_started_listens_on_loopback_only(small_plan, tmp_path):
    found: set[str] = set()

    def look(done: int, points: int) -> None:
        for process in [psutil.Process(), *psutil.Process().children(recursive=True)]:
            with contextlib.suppress(psutil.Error):  # it has just ended
                sockets = process.net_connections("inet")
                found.update(s.laddr.ip for s in sockets if s.status == psutil.CONN_LISTEN)

    account = carry_out_sweep(small_plan, tmp_path, DaskEngine(None, 1), look)
    assert account.outcomes == {"completed": 4}
    assert found == {LOOPBACK}


@on_cluster
def test_a_scheduler_that_does_not_answer_is_one_line(small_plan, tmp_path, monkeypatch):
    monkeypatch.setattr("ves_twin.sweeps.dask_engine.PATIENCE", "1s")
    for address in ("tcp://127.0.0.1:9", "nonsense://x", ""):
        with pytest.raises(ClusterError, match="scheduler") as caught:
            carry_out_sweep(small_plan, tmp_path, DaskEngine(address, 1))
        assert "\n" not in str(caught.value)


@on_cluster
def test_a_scheduler_without_workers_is_one_line(small_plan, tmp_path, monkeypatch):
    monkeypatch.setattr("ves_twin.sweeps.dask_engine.MUSTER", 1.0)
    with (
        LocalCluster(n_workers=0, host=LOOPBACK, dashboard_address=f"{LOOPBACK}:0") as idle,
        pytest.raises(ClusterError, match="no worker has joined"),
    ):
        carry_out_sweep(small_plan, tmp_path, DaskEngine(idle.scheduler_address, 1))


def test_without_dask_the_missing_extra_is_named(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with pytest.raises(ClusterError, match=r"ves_twin\[cluster\]"):
        DaskEngine(None, 1)
