"""carry_out_sweep: every point of a plan that has no row yet, then the table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from ves_twin.core.errors import FileAccessError
from ves_twin.sweeps.engine import Engine
from ves_twin.sweeps.ledger import Ledger
from ves_twin.sweeps.plan import SweepPlan
from ves_twin.sweeps.result import LOST, PointResult
from ves_twin.sweeps.table import write_tables

Progress = Callable[[int, int], None]
"""Called with points done and points in all, several times a second; may raise
KeyboardInterrupt."""


@dataclass(frozen=True)
class SweepAccount:
    """How a sweep ended.

    Attributes:
        points: how many it has.
        found: how many had a row before it was started.
        outcomes: outcome -> number of points; LOST ones are tried again at the next start.
        table: the Parquet table.
    """

    points: int
    found: int
    outcomes: Mapping[str, int]
    table: Path

    @property
    def whole(self) -> bool:
        """Whether every point has a result."""
        return LOST not in self.outcomes


def carry_out_sweep(
    plan: SweepPlan, folder: Path, engine: Engine, progress: Progress = lambda done, points: None
) -> SweepAccount:
    """Run what is missing and write the table; an interrupted sweep goes on where it was.

    Args:
        plan: the sweep.
        folder: where its rows lie.
        engine: where the points run.
        progress: called with the points done.

    Raises:
        OtherSweepError: the folder holds another sweep.
        FileAccessError: the folder cannot be written, or another command writes it; the rows so
            far are kept.
        VesTwinError: a worker that cannot take part; the rows so far are kept.
    """
    total = len(plan.points)
    with Ledger(folder, plan) as ledger:
        found = len(ledger.results)
        lost: dict[int, PointResult] = {}
        missing = [point for point in plan.points if point.number not in ledger.results]

        def beat() -> None:
            progress(len(ledger.results) + len(lost), total)

        beat()
        if missing:
            with closing(engine.results(missing, beat)) as results:  # type: ignore[type-var]
                for result in results:
                    ledger.keep(result)
                    if result.outcome == LOST:
                        lost[result.number] = result
                    beat()
        rows = {**lost, **ledger.results}
        if len(rows) != total:
            raise FileAccessError(f"{folder}: {total - len(rows)} points came back without a row")
        table = write_tables(folder, plan, rows)
    outcomes = Counter(rows[point.number].outcome for point in plan.points)
    return SweepAccount(total, found, dict(outcomes), table)
