"""new: draft the file of a machine from its model and a log."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from ves_twin.core.json_text import json_text

SUMMARY = "draft the file of a machine of your own from its MuJoCo model or URDF and a log"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("model", metavar="MODEL", help="MuJoCo model (.xml) or URDF")
    parser.add_argument("logs", metavar="LOG", nargs="+", help="logs; the first is matched")
    parser.add_argument("--out", metavar="FILE", help="the draft (default: MODEL's name, .toml)")
    parser.add_argument("--rate", metavar="HZ", help="rows a second, where no column is a time")
    parser.add_argument(
        "--scale",
        metavar="COLUMN=NUMBER",
        action="append",
        default=[],
        help="a constant that is known, as a motor's in N m per A, gear included; may be repeated",
    )
    parser.add_argument("--json", action="store_true", help="what was guessed as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Draft, write, print what was guessed and why."""
    from ves_twin.core.missing_file import missing_file

    model, logs = Path(arguments.model), [Path(name) for name in arguments.logs]
    for path in (model, *logs):
        if not path.is_file():  # before what reads it is imported
            raise missing_file("", path)
    from ves_twin.cli.new_text import new_text
    from ves_twin.core.units import to_si
    from ves_twin.machines.new_machine import new_machine

    out = Path(arguments.out or f"{model.stem}.toml")
    rate = None if arguments.rate is None else _positive(to_si(arguments.rate, "Hz", "--rate"))
    scales = _scales(arguments.scale)
    found = new_machine(model, logs, out, rate, scales=scales)
    print(json_text(found.to_dict()) if arguments.json else new_text(found, model, logs))
    return 0


def _positive(rate: float) -> float:
    from ves_twin.core.errors import InvalidInputError

    if rate <= 0.0:
        raise InvalidInputError("--rate", rate, "rows a second, above zero")
    return rate


def _scales(texts: Sequence[str]) -> dict[str, float]:
    from ves_twin.core.errors import InvalidInputError

    scales: dict[str, float] = {}
    for column, scale in map(_scale, texts):
        if column in scales:
            given = f"{column}={scales[column]:g} and {column}={scale:g}"
            raise InvalidInputError("--scale", given, "one constant of a column")
        scales[column] = scale
    return scales


def _scale(text: str) -> tuple[str, float]:
    from ves_twin.core.errors import InvalidInputError

    column, _, number = text.rpartition("=")
    try:
        scale = float(number)
    except ValueError:
        scale = float("nan")
    if not column or not isfinite(scale):
        raise InvalidInputError("--scale", text, "COLUMN=NUMBER, as u_V=0.035")
    return column, scale
