"""Workers: processes that share out independent jobs, and the time that these may take."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import TypeVar

from ves_twin.core.budget import Budget
from ves_twin.core.errors import VesTwinError

Job = TypeVar("Job")
Result = TypeVar("Result")

_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


class Workers:
    """A number of processes; they start with the first job and end with the `with` block.

    Args:
        count: of processes; 1 computes here.
        budget: of all jobs, by a clock that processes share where there are several; endless if
            None.
    """

    def __init__(self, count: int = 1, budget: Budget | None = None) -> None:
        self.count, self.budget = count, budget or Budget()
        self._pool: ProcessPoolExecutor | None = None

    def __reduce__(self) -> tuple[type[Workers], tuple[int, Budget]]:
        return Workers, (1, self.budget)  # what was given to another process computes there

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        if self._pool is not None:
            if kind is KeyboardInterrupt:  # what is being computed is of use to nobody
                for process in multiprocessing.active_children():
                    process.kill()
            self._pool.shutdown(cancel_futures=True)
            self._pool = None

    def map(
        self, function: Callable[[Job], Result], jobs: Sequence[Job], chunk: int = 1
    ) -> Iterator[Result]:
        """Results in the order of the jobs.

        Args:
            function: travels to the processes with each chunk.
            jobs: its arguments.
            chunk: jobs that travel together.

        Raises:
            VesTwinError: a process was killed.
        """
        if self.count == 1 or len(jobs) < 2:
            yield from map(function, jobs)
            return
        with single_threads(), self._whole():
            yield from self._started.map(function, jobs, chunksize=chunk)

    def as_done(
        self, function: Callable[[Job], Result], jobs: Sequence[Job]
    ) -> Iterator[tuple[int, Result]]:
        """Numbers of jobs with their results, in the order in which they end."""
        if self.count == 1 or len(jobs) < 2:
            yield from ((n, function(job)) for n, job in enumerate(jobs))
            return
        with single_threads(), self._whole():
            waiting = {self._started.submit(function, job): n for n, job in enumerate(jobs)}
            for future in as_completed(waiting):
                yield waiting[future], future.result()

    @contextmanager
    def _whole(self) -> Iterator[None]:
        """Raise VesTwinError where a process is killed, in place of what the pool says."""
        try:
            yield
        except BrokenProcessPool:
            for process in multiprocessing.active_children():
                process.kill()  # the pool would ask them to end, which they leave to their parent
            raise VesTwinError(
                f"one of the {self.count} processes that share the work was killed, for want of"
                " memory most often"
            ) from None

    @property
    def _started(self) -> ProcessPoolExecutor:
        if self._pool is None:
            context = multiprocessing.get_context("spawn")
            self._pool = ProcessPoolExecutor(self.count, context, initializer=follow_parent)
        return self._pool

    def collect(
        self,
        function: Callable[[Job], Result],
        jobs: Sequence[Job],
        progress: Callable[[float], None] = lambda share: None,
    ) -> list[Result]:
        """All results in the order of the jobs; `progress` is called with the share done."""
        results: list[Result] = []
        for result in self.map(function, jobs):
            results.append(result)
            progress(len(results) / len(jobs))
        return results


def follow_parent() -> None:
    """End this process when the one that began it is gone, which alone hears of Ctrl-C.

    And of what a batch system or `timeout` sends to all of a group.
    """
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            wait([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def single_threads() -> Iterator[None]:
    """Environment of processes that start meanwhile: one thread of linear algebra."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
