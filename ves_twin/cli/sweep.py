"""sweep: run a scenario at many settings, on several cores or a cluster, into one table."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from ves_twin.sweeps.engine import Engine
    from ves_twin.sweeps.plan import SweepPlan
    from ves_twin.sweeps.sweep import SweepAccount

SUMMARY = "run a scenario at many settings into one table; started again, it goes on"

ENGINES = ("processes", "dask")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("scenario", metavar="SCENARIO", help="a name or a TOML file")
    parser.add_argument(
        "--vary",
        metavar="KEY=VALUES",
        action="append",
        default=[],
        help="a key and its values: legs.gain=8,12,16, or 8..20:5 for five even steps,"
        " or 8..20 with --random; may be given several times, for a grid",
    )
    parser.add_argument(
        "--random", type=int, metavar="N", default=0, help="draw N points instead of the grid"
    )
    parser.add_argument(
        "--set",
        dest="settings",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="override a key in every point, for instance run.duration=10; may be repeated",
    )
    parser.add_argument("--plant", metavar="FILE", help="another plant: a name or a TOML file")
    parser.add_argument("--seed", type=int, metavar="N", help="seed of the noise and of the draws")
    parser.add_argument(
        "--engine", metavar="ENGINE", default="processes", help="processes (default) or dask"
    )
    parser.add_argument(
        "--address", metavar="ADDRESS", help="dask scheduler; without it one starts on 127.0.0.1"
    )
    parser.add_argument(
        "--workers", type=int, metavar="N", help="processes on this machine (default: its cores)"
    )
    parser.add_argument("--out", metavar="DIR", help="folder (default: runs/SCENARIO-sweep)")
    parser.add_argument("--plot", metavar="FILE", help="draw the errors over what was varied (PNG)")
    parser.add_argument("--json", action="store_true", help="the account as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Carry out the sweep; 0 when every point has a result, 3 where some were lost."""
    from ves_twin.cli.exit_codes import DONE, ENDED_EARLY
    from ves_twin.cli.progress import RunProgress
    from ves_twin.sweeps.sweep import carry_out_sweep

    engine = _engine(arguments)
    plan = _plan(arguments)
    folder = _folder(arguments.out, plan)
    with RunProgress(plan.scenario.name, 1.0, unit="share") as bar:
        account = carry_out_sweep(
            plan,
            folder,
            engine,
            lambda done, points: bar.share(done / points, f"{done} of {points} points"),
        )
    if arguments.plot is not None:
        from ves_twin.report.picture import save_picture
        from ves_twin.report.sweep_picture import draw_sweep

        save_picture(draw_sweep(account.table, plan.keys), Path(arguments.plot))
    if arguments.json:
        print(json_text(_account(plan, account)))
    else:
        print(_text(plan, account))
    return DONE if account.whole else ENDED_EARLY


def _engine(arguments: argparse.Namespace) -> Engine:
    from ves_twin.core.errors import InvalidInputError, UnknownNameError

    if arguments.engine not in ENGINES:
        raise UnknownNameError("engine", arguments.engine, ENGINES)
    workers = os.cpu_count() or 1 if arguments.workers is None else arguments.workers
    if not 1 <= workers <= 1024:
        raise InvalidInputError("--workers", workers, "1 to 1024 processes")
    if arguments.engine == "processes":
        from ves_twin.sweeps.process_engine import ProcessEngine

        if arguments.address is not None:
            raise InvalidInputError("--address", arguments.address, "--engine dask with it")
        return ProcessEngine(workers)
    from ves_twin.sweeps.dask_engine import DaskEngine

    return DaskEngine(arguments.address, workers)


def _plan(arguments: argparse.Namespace) -> SweepPlan:
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.plant.plant import Plant
    from ves_twin.procedures.registry import load_procedure
    from ves_twin.scenario.load import parse_setting
    from ves_twin.sweeps.plan import plan_sweep

    settings = dict(parse_setting(text) for text in arguments.settings)
    if load_procedure(arguments.scenario) is not None:
        raise InvalidInputError(
            "sweep", arguments.scenario, "a scenario; this is a procedure of many runs already"
        )
    if arguments.seed is not None and not 0 <= arguments.seed < 2**63:
        raise InvalidInputError("--seed", arguments.seed, "at least 0 and below 2^63")
    return plan_sweep(
        arguments.scenario,
        arguments.vary,
        settings,
        Plant.load(arguments.plant) if arguments.plant else None,
        arguments.random,
        arguments.seed,
    )


def _folder(given: str | None, plan: SweepPlan) -> Path:
    """The folder asked for, or the first of runs/NAME-sweep, -2, ... that is free or this one."""
    from ves_twin.core.errors import VesTwinError
    from ves_twin.sweeps.ledger import check_identity

    if given is not None:
        return Path(given)
    stem = f"{plan.scenario.name}-sweep"
    folder, number = Path("runs") / stem, 1
    while folder.exists():
        try:
            check_identity(folder, plan)
            return folder
        except VesTwinError:
            number += 1
            folder = Path("runs") / f"{stem}-{number}"
    return folder


def _account(plan: SweepPlan, account: SweepAccount) -> dict[str, object]:
    return {
        "scenario": plan.scenario.name,
        "question": plan.scenario.question,
        "points": account.points,
        "found": account.found,
        "outcomes": account.outcomes,
        "varied": plan.keys,
        "table": str(account.table),
        "identity": plan.identity,
    }


def _text(plan: SweepPlan, account: SweepAccount) -> str:
    from ves_twin.cli.sweep_text import sweep_rows

    varied = ", ".join(f"{key} [{unit}]" if unit else key for key, unit in plan.keys.items())
    outcomes = ", ".join(f"{name} {count}" for name, count in sorted(account.outcomes.items()))
    points = str(account.points)
    if account.found:
        points += f", of which {account.found} were there already"
    lines = [
        f"{plan.scenario.name}: {plan.scenario.question}",
        f"  varied    {varied}",
        f"  points    {points}",
        f"  outcomes  {outcomes}",
        f"  table     {account.table}",
        "",
        *sweep_rows(account.table, plan.keys),
    ]
    if not account.whole:
        lines.append("  lost points are tried again when the same sweep is started again")
    return "\n".join(lines)
