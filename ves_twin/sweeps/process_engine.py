"""ProcessEngine: points on several cores of this machine.

Each worker has a pipe of its own, so that it is known which point a worker that died was running;
an executor of the standard library only says that the whole pool is broken.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess

from ves_twin.core.errors import VesTwinError
from ves_twin.core.workers import follow_parent, single_threads
from ves_twin.sweeps.engine import BEAT, TRIES, Beat
from ves_twin.sweeps.point import Point
from ves_twin.sweeps.result import PointResult
from ves_twin.sweeps.run_point import lost_point, run_point


@dataclass
class _Worker:
    """A process, our end of its pipe, and the point that it runs."""

    process: SpawnProcess
    pipe: Connection
    point: Point


class ProcessEngine:
    """Points in `workers` processes, started afresh so that no state is inherited."""

    def __init__(self, workers: int) -> None:
        self._workers = workers

    def results(self, points: Sequence[Point], beat: Beat) -> Iterator[PointResult]:
        """Results as they come; see `Engine`."""
        waiting, deaths = deque(points), Counter[int]()
        busy: dict[Connection, _Worker] = {}
        try:
            while waiting or busy:
                while waiting and len(busy) < self._workers:
                    worker = _start(waiting.popleft())
                    busy[worker.pipe] = worker
                ready = wait(list(busy), timeout=BEAT)
                beat()
                for pipe in ready:
                    worker = busy[pipe]  # type: ignore[index]
                    result = _received(worker)
                    if isinstance(result, VesTwinError):
                        raise result
                    if result is None:
                        code = _stop(busy.pop(worker.pipe))
                        result = _after_death(worker.point, code, deaths, waiting)
                    elif waiting:
                        worker.point = waiting.popleft()
                        _send(worker)
                    else:
                        _stop(busy.pop(worker.pipe))
                    if result is not None:
                        yield result
        finally:
            for worker in busy.values():
                worker.process.kill()
            for worker in busy.values():
                _stop(worker)


def _start(point: Point) -> _Worker:
    context = get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(theirs,), daemon=True)
    with single_threads():
        process.start()
    theirs.close()  # so that our end sees when the worker dies
    worker = _Worker(process, ours, point)
    _send(worker)
    return worker


def _send(worker: _Worker) -> None:
    try:
        worker.pipe.send(worker.point)
    except OSError:
        return  # it has died; the next look at the pipe says so


def _received(worker: _Worker) -> PointResult | VesTwinError | None:
    """What a worker answers; None if it died."""
    try:
        answer = worker.pipe.recv()
    except (EOFError, OSError):
        return None
    return answer if isinstance(answer, PointResult | VesTwinError) else None


def _after_death(
    point: Point, code: int | None, deaths: Counter[int], waiting: deque[Point]
) -> PointResult | None:
    """Put the point of a dead worker back into the queue, or give it up."""
    deaths[point.number] += 1
    if deaths[point.number] < TRIES:
        waiting.append(point)
        return None
    return lost_point(point, f"its worker process died {TRIES} times, last with code {code}")


def _stop(worker: _Worker) -> int | None:
    """Let a worker end, and its exit code."""
    worker.pipe.close()
    worker.process.join()
    code = worker.process.exitcode
    worker.process.close()
    return code


def _serve(pipe: Connection) -> None:
    """The worker: point in, result out, until the pipe is closed."""
    follow_parent()
    while True:
        try:
            point = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send(run_point(point))
        except VesTwinError as error:
            pipe.send(error)
        except OSError:
            return
