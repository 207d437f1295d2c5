"""commands_page: every command and option, out of the parsers themselves."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from functools import partial

from ves_twin.cli.main import build_parser


def commands_page() -> str:
    """A section for each command, with usage and a table of what it takes."""
    lines = [
        "# Commands",
        "",
        "Out of the parsers of `ves-twin`, as `ves-twin COMMAND --help` prints them.",
        "Exit codes: 0 done, 2 bad input, 3 the run ended early, 4 out of tolerance, 130 interrupted.",
        "",
    ]
    for parser in _parsers(build_parser()):
        lines += _section(parser)
    return "\n".join(lines) + "\n"


EXAMPLES = {
    "scenarios": ("ves-twin scenarios",),
    "run": (
        "ves-twin run beam_horizontal_truth",
        "ves-twin run position_sine --set legs.gain=16 --set run.duration=5",
        "ves-twin run my_scenario.toml --controller my.py:Controller",
        "ves-twin run free_float --set run.duration=5 --video free_float.gif",
    ),
    "sweep": ("ves-twin sweep position_sine --vary legs.gain=8..16:5 --plot sweep.png",),
    "plan": (
        "ves-twin plan --plant pendulum --quick",
        "ves-twin plan --scenario identify_fast --channels leg.length --seconds 15",
        "ves-twin plan --plant pendulum --add-channel",
        "ves-twin plan --plant pendulum --design actuator_delay/sensor_delay --seconds 2",
    ),
    "new": ("ves-twin new my_robot.xml lab.csv --out my_robot.toml",),
    "dataset": ("ves-twin dataset VibrationDamping-v0 --episodes 10",),
    "diagnose": (
        "ves-twin diagnose rec.parquet --plant my_machine.toml --held-out other.parquet",
        "ves-twin diagnose today.parquet --plant my_machine.toml --baseline last_week.parquet",
    ),
    "trend": ("ves-twin trend logs/ --plant my_machine.toml",),
    "compare": (
        "ves-twin compare rec.parquet --plant my_machine.toml",
        "ves-twin compare after.parquet --against before.parquet --plant my_machine.toml",
    ),
    "blind make": ("ves-twin blind make --machine pendulum --out runs/blind/mine",),
    "blind answer": ("ves-twin blind answer --out runs/blind/mine",),
    "blind play": ("ves-twin blind play --out runs/blind/mine",),
    "blind score": ("ves-twin blind score --out runs/blind/mine",),
    "blind reveal": ("ves-twin blind reveal --out runs/blind/mine",),
    "reproduce": ("ves-twin reproduce", "ves-twin reproduce fig-5-2"),
    "inspect": ("ves-twin inspect lab.csv", "ves-twin inspect lab.csv --draft-map"),
    "import": ("ves-twin import lab.csv --map lab.map.toml --out rec.parquet",),
    "export": ("ves-twin export runs/beam_horizontal_truth --out beam.csv",),
    "evaluate": ("ves-twin evaluate VibrationDamping-v0 --policy lqg",),
    "view": (
        "ves-twin view --last",
        "ves-twin view runs/beam_horizontal_truth --web",
        "ves-twin view position_sine --live",
    ),
    "info": ("ves-twin info", "ves-twin info --plant ves2_pressure"),
}
"""Command -> what people type; `tests/docs` parses each."""


def _section(parser: argparse.ArgumentParser) -> list[str]:
    parser.formatter_class = partial(argparse.HelpFormatter, width=84)  # type: ignore[assignment]
    usage = parser.format_usage().removeprefix("usage: ").rstrip()
    lines = [f"## {parser.prog}", "", f"{parser.description or ''}", ""]
    typed = EXAMPLES.get(parser.prog.removeprefix("ves-twin "), ())
    lines += ["Type for example:", "", *(f"    {line}" for line in typed), ""] if typed else []
    lines += ["```", usage, "```", ""]
    shown = [a for a in _actions(parser) if a.help != argparse.SUPPRESS]
    shown = [a for a in shown if not isinstance(a, argparse._HelpAction)]
    rows = [_row(a) for a in shown if not isinstance(a, argparse._SubParsersAction)]
    if rows:
        lines += ["| argument | meaning |", "|---|---|", *rows, ""]
    return lines


def _row(action: argparse.Action) -> str:
    value = action.metavar or (
        f"{{{','.join(map(str, action.choices))}}}" if action.choices else ""
    )
    takes = action.nargs != 0
    if action.option_strings:
        name = ", ".join(action.option_strings)
        name += f" {value or action.dest.upper()}" if takes else ""
    else:
        name = str(value or action.dest)
    meaning = (action.help or "") + (" **required**" if _required(action) else "")
    plain = action.default in (None, False, [], argparse.SUPPRESS)
    if not plain and "default" not in meaning and f"({action.default})" not in meaning:
        meaning += f" (default: {action.default})"
    return f"| `{_cell(name)}` | {_cell(meaning)} |"


def _required(action: argparse.Action) -> bool:
    return bool(action.option_strings) and action.required


def _parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """The parser and those below it, in order."""
    yield parser
    for action in _actions(parser):
        if isinstance(action, argparse._SubParsersAction):
            for below in action.choices.values():
                yield from _parsers(below)


def _actions(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    return parser._actions  # argparse has no public way to list them


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
