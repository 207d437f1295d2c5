"""dataset: episodes of a policy as a Minari data set."""

from __future__ import annotations

import argparse

SUMMARY = "record episodes of an environment as a Minari data set"

MOST_EPISODES = 100_000
"""More than anybody waits for."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("environment", metavar="ENV", help="as for evaluate: VibrationDamping-v0")
    parser.add_argument(
        "--kind", default="expert", help="expert (default), behaviour (noise on it) or random"
    )
    parser.add_argument(
        "--policy",
        metavar="FILE:Class",
        help="a baseline or a class of a file; the environment's expert if left out",
    )
    parser.add_argument("--episodes", type=int, default=20, metavar="N", help="seeds 0 to N-1 (20)")
    parser.add_argument(
        "--rigs",
        default="train-v0",
        metavar="SET",
        help="whose faults are hidden: train-v0 (default), test-v0, none, or a TOML file",
    )
    parser.add_argument("--plant", metavar="FILE", help="another plant: a name or a TOML file")
    parser.add_argument("--scaled", action="store_true", help="float32 shares from -1 to 1")
    parser.add_argument("--name", metavar="ID", help="Minari's id; made of the rest if left out")
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Record the episodes and say where they are."""
    from ves_twin.cli.progress import RunProgress
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.core.json_text import json_text
    from ves_twin.envs.offline import Record, record_dataset

    if not 1 <= arguments.episodes <= MOST_EPISODES:
        raise InvalidInputError("--episodes", arguments.episodes, f"1 to {MOST_EPISODES}")
    record = Record(
        arguments.environment,
        arguments.kind,
        arguments.policy,
        arguments.rigs,
        arguments.plant,
        arguments.scaled,
        arguments.name,
    )
    with RunProgress(record.dataset_id, 1.0, unit="share") as progress:
        made = record_dataset(record, range(arguments.episodes), progress)
    steps, folder = int(made.total_steps), str(made.storage.data_path.parent)
    if arguments.json:
        content = {"id": made.id, "episodes": made.total_episodes, "steps": steps, "folder": folder}
        print(json_text(content))
    else:
        print(f"{made.id}: {made.total_episodes} episodes, {steps} steps, in {folder}")
        print(f'  minari.load_dataset("{made.id}")')
    return 0
