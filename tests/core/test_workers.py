"""Workers: order, share done, failures."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from ves_twin.core.errors import VesTwinError
from ves_twin.core.workers import Workers


@pytest.mark.slow
def test_jobs_come_back_in_order_and_failures_come_through():
    shares: list[float] = []
    with Workers(2) as workers:
        assert workers.collect(abs, [-3, 1, -2], shares.append) == [3, 1, 2]
        assert shares == [pytest.approx(n / 3) for n in (1, 2, 3)]
        with pytest.raises(ValueError, match="invalid literal"):
            workers.collect(int, ["1", "x"])


def later(seconds: float) -> float:
    time.sleep(seconds)
    return seconds


@pytest.mark.slow
@pytest.mark.parametrize(("count", "order"), [(1, [0, 1, 2]), (2, [1, 2, 0])])
def test_jobs_come_as_they_end_each_with_its_number(count, order):
    """The long one keeps no other waiting; one process works in order."""
    jobs = [3.0, 0.0, 0.1]
    with Workers(count) as workers:
        found = list(workers.as_done(later, jobs))
        assert [n for n, _ in found] == order
        assert all(result == jobs[n] for n, result in found)
        with pytest.raises(ValueError, match="invalid literal"):
            list(workers.as_done(int, ["1", "x"]))


BEGUN = """
import os, sys, time
from ves_twin.core.workers import Workers
if __name__ == "__main__":
    with Workers(2) as workers:
        list(workers.map(abs, [1, 2, 3]))
        print(*[process.pid for process in workers._pool._processes.values()], flush=True)
        time.sleep(60)
"""


@pytest.mark.slow
def test_processes_end_with_the_one_that_began_them_even_if_it_is_killed(tmp_path):
    script = tmp_path / "begun.py"
    script.write_text(BEGUN)
    parent = subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True)
    pids = [int(word) for word in parent.stdout.readline().split()]
    assert len(pids) == 2
    parent.kill()
    parent.wait()
    parent.stdout.close()
    until = time.monotonic() + 20.0
    while any(_lives(pid) for pid in pids) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(_lives(pid) for pid in pids)


def _lives(pid: int) -> bool:
    """Whether a process is there and no zombie."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().split(")")[-1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def gone(number: int) -> int:
    os._exit(9)


@pytest.mark.slow
def test_a_process_that_is_killed_is_told_in_one_line():
    with Workers(2) as workers:
        with pytest.raises(VesTwinError, match="one of the 2 processes"):
            list(workers.map(gone, [1, 2]))
        with pytest.raises(VesTwinError, match="one of the 2 processes"):
            list(workers.as_done(gone, [1, 2]))
