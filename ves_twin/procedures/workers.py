"""carry_out_jobs: independent jobs on several cores, results in the order of the jobs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import TypeVar

from ves_twin.core.workers import single_threads

Job = TypeVar("Job")
Result = TypeVar("Result")


def carry_out_jobs(
    function: Callable[[Job], Result],
    jobs: Sequence[Job],
    workers: int,
    progress: Callable[[float], None] = lambda share: None,
) -> list[Result]:
    """Results of a function for each job.

    The workers' linear algebra runs on one thread each: small matrices gain nothing from more,
    and threads that wait for a shared core stall each other.

    Args:
        function: a function of a module, since it travels to other processes.
        jobs: its arguments.
        workers: processes; with 1 everything runs in this one.
        progress: called with the share done.
    """
    results: dict[int, Result] = {}
    if workers == 1:
        for i, job in enumerate(jobs):
            results[i] = function(job)
            progress((i + 1) / len(jobs))
    else:
        with (
            single_threads(),
            ProcessPoolExecutor(min(workers, len(jobs)), mp_context=get_context("spawn")) as pool,
        ):
            numbers = {pool.submit(function, job): i for i, job in enumerate(jobs)}
            try:
                for done in as_completed(numbers):
                    results[numbers[done]] = done.result()
                    progress(len(results) / len(jobs))
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
    return [results[i] for i in range(len(jobs))]
