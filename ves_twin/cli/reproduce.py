"""reproduce: the thesis's claims with a verdict each, one claim, or one figure."""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from ves_twin.thesis.context import Context
    from ves_twin.thesis.scorecard import Scorecard

SUMMARY = "hold the twin against the thesis: every claim, some claims, or a figure"
JSON_NAME, PAGE_NAME = "scorecard.json", "thesis-scorecard.md"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "names",
        metavar="CLAIM|FIGURE",
        nargs="*",
        help="for instance C072 or fig-5-12; every claim if left out",
    )
    parser.add_argument("--quick", action="store_true", help="shorter simulations, under 2 min")
    parser.add_argument("--plant", metavar="FILE", help="another plant: a name or a TOML file")
    parser.add_argument(
        "--models",
        choices=("thesis", "corrected"),
        default="thesis",
        help="emulated models as the thesis has them, or with its errata corrected",
    )
    parser.add_argument("--no-cache", action="store_true", help="compute every row anew")
    parser.add_argument("--out", metavar="DIR", help="write the scorecard, or the figures, here")
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Evaluate what was asked for and print it."""
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.cli.scorecard_text import figure_text, scorecard_text
    from ves_twin.core.errors import UnknownNameError
    from ves_twin.thesis.claim import load_claims
    from ves_twin.thesis.figures.registry import FIGURES

    claims = load_claims()
    names = [name.upper() if name.upper() in claims else name for name in arguments.names]
    for name in names:
        if name not in claims and name not in FIGURES:
            raise UnknownNameError("claim or figure", name, [*claims, *FIGURES])
    context = _context(arguments)
    figures = [name for name in names if name in FIGURES]
    chosen = list(dict.fromkeys(name for name in names if name in claims))
    writes = arguments.out or figures
    with output_folder(arguments.out, "reproduce") if writes else nullcontext() as held:
        drawn = [FIGURES[name](context.plant, held.path, context.quick) for name in figures if held]
        card = None if names and not chosen else _score(arguments, chosen, context)
        content = {
            **(card.to_dict() if card else {}),
            "figures": [{**vars(figure), "png": str(figure.png)} for figure in drawn],
        }
        text = json_text(content)
        if arguments.out and card and held:
            _write(held.path, card, text)
    if arguments.json:
        print(text)
        return 0
    parts = [scorecard_text(card, detailed=bool(chosen))] if card else []
    print("\n\n".join([*parts, *map(figure_text, drawn)]))
    return 0


def _context(arguments: argparse.Namespace) -> Context:
    from ves_twin.plant.plant import NOMINAL, Plant
    from ves_twin.thesis.context import Context, Models

    name = arguments.plant or ""
    return Context(
        plant=Plant.load(name or NOMINAL),
        quick=arguments.quick,
        models=Models(arguments.models),
        plant_name=name,
    )


def _score(arguments: argparse.Namespace, chosen: list[str], context: Context) -> Scorecard:
    from ves_twin.cli.progress import RunProgress
    from ves_twin.thesis.claim import load_claims
    from ves_twin.thesis.evaluators.registry import ANSWERS
    from ves_twin.thesis.scorecard import score_claims
    from ves_twin.thesis.store import Store

    claims = load_claims()
    store = None if arguments.no_cache else Store.of_user()
    selected = [claims[name] for name in chosen] if chosen else list(claims.values())
    with RunProgress("reproduce", 1.0, unit="share") as progress:
        return score_claims(selected, ANSWERS, context, store, progress.share)


def _write(folder: Path, card: Scorecard, text: str) -> None:
    from ves_twin.core.whole_file import write_whole
    from ves_twin.thesis.page import scorecard_page

    write_whole(folder / JSON_NAME, text + "\n")
    write_whole(folder / PAGE_NAME, scorecard_page(card))
