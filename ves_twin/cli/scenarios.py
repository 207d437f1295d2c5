"""scenarios: list the scenarios and the question that each answers."""

from __future__ import annotations

import argparse

from ves_twin.core.json_text import json_text

SUMMARY = "list the scenarios: name and the question each answers"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Print the list."""
    from ves_twin.scenario.load import procedure_questions, scenario_questions

    questions = scenario_questions() | procedure_questions()
    if arguments.json:
        print(json_text(questions))
        return 0
    width = max(map(len, questions))
    for name, question in questions.items():
        print(f"{name:<{width}}  {question}")
    return 0
