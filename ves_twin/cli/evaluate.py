"""evaluate: score a policy on the rigs of a set."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING

from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from ves_twin.envs.evaluation import Evaluation, Figure

SUMMARY = "score a policy in an environment, one episode a seed"

UNITS = {
    "energy_integral": "J s",
    "energy_peak": "J",
    "energy_last": "J",
    "goal_error": "rad",
    "distance_rms": "mm",
    "distance_peak": "mm",
    "emulation_rms": "mm",
    "emulation_peak": "mm",
    "shaking": "of 50 N",
    "force_error": "N",
    "moment_error": "N m",
    "force_error_last": "N",
    "moment_error_last": "N m",
    "tracking_rms": "mrad",
    "tracking_peak": "mrad",
    "caught": "share",
    "caught_at": "s",
    "tip_distance": "m",
    "cost": "s",
}
"""Of figures; the return is minus the loss of the environment's own table."""

MOST_SEEDS = 100_000
"""More than anybody waits for."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "environment",
        metavar="ENV",
        help="VibrationDamping-v0, PlatformTracking-v0 ...; an unknown name lists all",
    )
    parser.add_argument(
        "--policy",
        required=True,
        metavar="FILE:Class",
        help="a class of a Python file, which is run, or a baseline's name, such as still",
    )
    parser.add_argument("--seeds", type=int, default=20, metavar="N", help="seeds 0 to N - 1 (20)")
    parser.add_argument(
        "--rigs",
        default="test-v0",
        metavar="SET",
        help="test-v0 (default), train-v0, none, or a TOML file",
    )
    parser.add_argument(
        "--against", metavar="FILE:Class", help="another policy; differences are seed by seed"
    )
    parser.add_argument(
        "--challenges",
        action="store_true",
        help="score on every set of the challenge matrix in turn, in place of --rigs",
    )
    parser.add_argument("--plant", metavar="FILE", help="another plant: a name or a TOML file")
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="processes (1)")
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Run the episodes and print their figures."""
    from ves_twin.cli.progress import RunProgress
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.envs.evaluation import Trial, evaluate, paired

    if not 1 <= arguments.seeds <= MOST_SEEDS:
        raise InvalidInputError("--seeds", arguments.seeds, f"1 to {MOST_SEEDS}")
    if not 1 <= arguments.workers <= 256:
        raise InvalidInputError("--workers", arguments.workers, "1 to 256")
    if arguments.challenges:
        return _challenges(arguments)
    names = [arguments.policy, *([arguments.against] if arguments.against else [])]
    trials = [Trial(arguments.environment, name, arguments.rigs, arguments.plant) for name in names]
    found: list[Evaluation] = []
    with RunProgress(arguments.environment, 1.0, unit="share") as progress:
        for trial in trials:
            done = len(found)

            def show(share: float, done: int = done, name: str = trial.policy) -> None:
                progress.share((done + share) / len(trials), name)

            found.append(evaluate(trial, range(arguments.seeds), arguments.workers, show))
    differences = paired(found[0].episodes, found[1].episodes) if len(found) > 1 else {}
    if arguments.json:
        content = found[0].to_dict()
        if differences:
            figures = {name: asdict(figure) for name, figure in differences.items()}
            content["against"] = {**found[1].to_dict(), "differences": figures}
        print(json_text(content))
    else:
        print(_text(found[0]))
        if differences:
            print(f"\n  less {arguments.against}, seed by seed")
            print("\n".join(_rows(differences, len(found[0].episodes))))
    return 0


def _challenges(arguments: argparse.Namespace) -> int:
    """A row for each challenge: the score, its interval, how many episodes stopped early."""
    from ves_twin.cli.progress import RunProgress
    from ves_twin.envs.challenges import score_challenges
    from ves_twin.envs.evaluation import NO_RIGS, Trial

    trial = Trial(arguments.environment, arguments.policy, NO_RIGS, arguments.plant)
    with RunProgress(arguments.environment, 1.0, unit="share") as progress:
        rows = score_challenges(
            trial, range(arguments.seeds), arguments.workers, lambda share, what: progress(share)
        )
    if arguments.json:
        print(json_text({row.challenge: row.evaluation.to_dict() for row in rows}))
        return 0
    seeds = "1 seed" if arguments.seeds == 1 else f"{arguments.seeds} seeds"
    print(f"{trial.environment}: {trial.policy}, {seeds} a challenge\n")
    print(f"  {'':<14}{'return':>12}{'95 % interval':>24}{'stopped':>10}")
    for row in rows:
        found, outcomes = row.evaluation.figures["return"], row.evaluation.outcomes
        interval = f"{found.low:.4g} to {found.high:.4g}" if arguments.seeds > 1 else "-"
        stopped = len(row.evaluation.episodes) - outcomes.get("completed", 0)
        print(f"  {row.challenge:<14}{found.iqm:>12.4g}{interval:>24}{stopped:>10}")
    return 0


def _text(found: Evaluation) -> str:
    trial, count = found.trial, len(found.episodes)
    ends = ", ".join(f"{number} {name}" for name, number in found.outcomes.items())
    seeds = "1 seed" if count == 1 else f"{count} seeds"
    lines = [
        f"{trial.environment}: {trial.policy} on rigs {trial.rigs}, {seeds}",
        f"  outcomes  {ends}",
        "",
        f"  {'':<22}{'interquartile mean':>20}{'95 % interval':>26}",
    ]
    return "\n".join([*lines, *_rows(found.figures, count)])


def _rows(figures: Mapping[str, Figure], count: int) -> list[str]:
    """Name with unit, interquartile mean and interval; one seed has no interval."""
    rows = []
    for name, figure in figures.items():
        label = f"{name} [{UNITS[name]}]" if name in UNITS else name
        interval = f"{figure.low:.4g} to {figure.high:.4g}" if count > 1 else "-"
        rows.append(f"  {label:<22}{figure.iqm:>20.4g}{interval:>26}")
    return rows
