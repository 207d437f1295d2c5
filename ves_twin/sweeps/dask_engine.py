"""DaskEngine: points on a cluster of dask.distributed, or on one that it starts on this machine."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from itertools import islice
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

from ves_twin.core.errors import VesTwinError, one_line
from ves_twin.sweeps.engine import BEAT, TRIES, Beat
from ves_twin.sweeps.point import Point
from ves_twin.sweeps.result import PointResult
from ves_twin.sweeps.run_point import lost_point, run_point

if TYPE_CHECKING:
    from distributed import Client, Future

LOOPBACK = "127.0.0.1"
AHEAD = 4
"""Points given to the scheduler at a time for each thread: enough that none waits."""

PATIENCE = "10s"
"""How long a scheduler may take to answer."""

MUSTER = 60.0
"""How long it may take until a worker has joined [s]."""


class ClusterError(VesTwinError):
    """A cluster that cannot be used."""


class DaskEngine:
    """Points on the cluster of a scheduler.

    Args:
        address: of the scheduler, for instance "tcp://host:8786"; None starts a cluster on this
            machine that listens on 127.0.0.1 only.
        workers: processes of the cluster that is started.

    Raises:
        ClusterError: dask.distributed is not installed.
    """

    def __init__(self, address: str | None, workers: int) -> None:
        try:
            import distributed  # noqa: F401  (an extra that most users do not need)
        except ModuleNotFoundError:
            raise ClusterError(
                "--engine dask needs dask.distributed: pip install 'ves_twin[cluster]'"
            ) from None
        self._address = address
        self._workers = workers

    def results(self, points: Sequence[Point], beat: Beat) -> Iterator[PointResult]:
        """Results as they come; see `Engine`."""
        with ExitStack() as stack:
            client = self._client(stack)
            queue = iter(points)
            given: dict[Future, Point] = {}
            finished: SimpleQueue[Future] = SimpleQueue()
            while True:
                room = AHEAD * max(1, sum(client.nthreads().values())) - len(given)
                for point in islice(queue, max(room, 0)):
                    future = _submit(client, point)
                    given[future] = point
                    future.add_done_callback(finished.put)
                if not given:
                    return
                beat()
                with suppress(Empty):
                    future = finished.get(timeout=BEAT)
                    yield _result(future, given.pop(future))
                    future.release()

    def _client(self, stack: ExitStack) -> Client:
        import dask
        from distributed import Client, LocalCluster

        stack.enter_context(dask.config.set({"distributed.scheduler.allowed-failures": TRIES - 1}))
        address: Any = self._address
        try:
            if address is None:
                address = stack.enter_context(
                    LocalCluster(
                        n_workers=self._workers,
                        threads_per_worker=1,
                        host=LOOPBACK,
                        dashboard_address=f"{LOOPBACK}:0",
                        worker_dashboard_address=None,
                        silence_logs=logging.CRITICAL,  # a worker that is stopped complains
                    )
                )
            client = stack.enter_context(Client(address, timeout=PATIENCE, set_as_default=False))
        except (OSError, ValueError, ImportError) as error:
            raise ClusterError(f"scheduler {self._address}: {one_line(error)}") from None
        try:
            client.wait_for_workers(1, timeout=MUSTER)
        except TimeoutError:
            raise ClusterError(
                f"scheduler {self._address}: no worker has joined it in {MUSTER:g} s; start some"
                f" with `dask worker {self._address}` and sweep again"
            ) from None
        return client


def _submit(client: Client, point: Point) -> Future:
    # keyed by what is run: the scheduler never runs a point twice at a time
    return client.submit(run_point, point, key=f"ves_twin-{point.run_id}-{point.number}")


def _result(future: Future, point: Point) -> PointResult:
    from distributed import KilledWorker

    try:
        result = future.result()
    except VesTwinError:
        raise
    except KilledWorker:
        return lost_point(point, f"its worker died {TRIES} times")
    except Exception as error:
        raise ClusterError(
            f"a worker could not run point {point.number}: {type(error).__name__}:"
            f" {one_line(error)}"
        ) from None
    if not isinstance(result, PointResult):
        raise ClusterError(f"a worker answered with {type(result).__name__}; is it of this version")
    return result
