"""Beside: one job at a time in a thread of its own, while its owner goes on."""

from __future__ import annotations

from collections.abc import Callable
from threading import Thread


class Beside:
    """Does jobs in order, each in a thread; what one raises, the owner gets at the next call."""

    def __init__(self) -> None:
        self._job: _Job | None = None

    def start(self, work: Callable[[], None]) -> None:
        """Wait for the job before, then have this one done beside.

        Raises:
            Exception: what the job before raised; this one is then not begun.
        """
        self.wait()
        job = _Job(work)
        job.start()
        self._job = job

    def wait(self) -> None:
        """Return when no job is under way.

        Raises:
            Exception: what the job raised.
        """
        if self._job is None:
            return
        job = self._job
        job.join()
        if not job.done:  # in a process that was forked meanwhile: no thread goes with it
            job.run()
        self._job = None  # only now: an interrupt while waiting leaves the job to be waited for
        if job.error is not None:
            raise job.error


class _Job(Thread):
    """A piece of work, and what it raised."""

    def __init__(self, work: Callable[[], None]) -> None:
        super().__init__(name="rows")
        self._work = work
        self.error: BaseException | None = None
        self.done = False

    def run(self) -> None:
        try:
            self._work()
        except BaseException as error:  # raised again where the owner waits
            self.error = error
        self.done = True
