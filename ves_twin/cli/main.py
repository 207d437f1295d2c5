"""main: the ves-twin command; parses, dispatches, and turns errors into one line."""

from __future__ import annotations

import argparse
import os
import re
import sys
import warnings
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from itertools import pairwise
from typing import NoReturn, TextIO

from ves_twin import __version__
from ves_twin.cli import (
    blind,
    compare,
    dataset,
    diagnose,
    evaluate,
    export,
    import_log,
    info,
    inspect,
    new,
    plan,
    reproduce,
    run,
    scenarios,
    sweep,
    trend,
    view,
)
from ves_twin.cli.exit_codes import BAD_INPUT, DONE, INTERRUPTED
from ves_twin.cli.given import refuse_missing
from ves_twin.core.cache_folder import cache_folder
from ves_twin.core.errors import (
    InvalidInputError,
    UnknownNameError,
    VesTwinError,
    VesTwinWarning,
    one_line,
)

COMMANDS = {
    "scenarios": scenarios,
    "run": run,
    "sweep": sweep,
    "plan": plan,
    "new": new,
    "diagnose": diagnose,
    "trend": trend,
    "compare": compare,
    "blind": blind,
    "reproduce": reproduce,
    "inspect": inspect,
    "import": import_log,
    "export": export,
    "evaluate": evaluate,
    "dataset": dataset,
    "view": view,
    "info": info,
}
"""Name -> module with SUMMARY, add_arguments(parser) and execute(arguments) -> exit code."""

BEGIN = """\
begin with:
  ves-twin run beam_horizontal_truth          writes runs/beam_horizontal_truth/
  ves-twin view --last                        shows it in 3-D; --web for a browser
  ves-twin diagnose REC --plant MACHINE       names what the model of a machine gets wrong
  ves-twin COMMAND --help                     what a command takes

exit codes: 0 done, 2 bad input, 3 the run ended early, 4 out of tolerance, 130 interrupted
"""
"""What stands below the commands."""

EMPTY = re.compile(r"--[a-z-]+=")
"""An option without its value, as a shell makes of one whose variable is not set."""


class Parser(argparse.ArgumentParser):
    """A parser that answers bad arguments with one line and exit code 2."""

    def error(self, message: str) -> NoReturn:
        """Raise instead of printing the usage."""
        command = self.prog.partition(" ")[2]
        raise VesTwinError(f"{command}: {message}" if command else message)

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """Raise for an option that is unknown, where the nearest one is known: at its command."""
        found, rest = super().parse_known_args(args, namespace)
        if rest and self._subparsers is None:
            raise self.unknown(rest[0])
        return found, rest

    def unknown(self, word: str) -> UnknownNameError:
        """What to raise for an option that this parser does not have."""
        known = set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", self.format_help()))
        return UnknownNameError("option", word.split("=")[0], known)


def build_parser() -> Parser:
    """The parser of all commands."""
    parser = Parser(
        prog="ves-twin",
        description="Find out what a simulation gets wrong about a machine, of your own or VES II.",
        epilog=BEGIN,
        formatter_class=partial(argparse.RawDescriptionHelpFormatter, max_help_position=14),
    )
    parser.add_argument("--version", action="version", version=f"ves-twin {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", parser_class=Parser)
    for name, module in COMMANDS.items():
        command = commands.add_parser(name, help=module.SUMMARY, description=module.SUMMARY)
        module.add_arguments(command)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command.

    Returns:
        0 done; 2 bad input; 3 the run ended early; 4 out of tolerance; 130 interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    noted: list[tuple[Warning | str, type[Warning], str, int]] = []

    def note(
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        """What the user should know, at once and in one line; others' warnings at the end."""
        if issubclass(category, VesTwinWarning):
            print(f"ves-twin: {' '.join(str(message).split())}", file=sys.stderr)
        else:
            noted.append((message, category, filename, lineno))

    with warnings.catch_warnings():
        warnings.simplefilter("always", VesTwinWarning)
        warnings.showwarning = note
        _give_matplotlib_a_folder()
        code = _answered(words)
    for one in noted if code != BAD_INPUT else ():  # a refusal is one line
        warnings.showwarning(*one)
    return code


def _give_matplotlib_a_folder() -> None:
    """Where there is no home to write: it would warn, and look for its fonts in every command."""
    home = os.path.expanduser("~")
    writable = os.path.isdir(home) and os.access(home, os.W_OK)
    if "MPLCONFIGDIR" not in os.environ and not writable:
        with suppress(OSError):  # no place at all: whoever needs one says so
            os.environ["MPLCONFIGDIR"] = str(cache_folder("matplotlib"))


def _refuse_empty(words: Sequence[str]) -> None:
    for before, word in pairwise(["ves-twin", *words]):
        if not word.strip() or EMPTY.fullmatch(word):
            raise InvalidInputError(word[:-1] if word.strip() else before, "", "a value")


def _answered(words: list[str]) -> int:
    try:
        _refuse_empty(words)
        if words and not words[0].startswith("-") and words[0] not in COMMANDS:
            raise UnknownNameError("command", words[0], COMMANDS)
        parser = build_parser()
        if not words:
            parser.print_help()
            return BAD_INPUT
        found, rest = parser.parse_known_args(words)
        if rest:
            raise parser.unknown(rest[0])
        refuse_missing(found)
        return int(COMMANDS[found.command].execute(found))
    except VesTwinError as error:
        print(f"ves-twin: {one_line(error)}", file=sys.stderr)
        return BAD_INPUT
    except (OSError, UnicodeError, RecursionError) as error:
        if isinstance(error, BrokenPipeError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return DONE
        print(f"ves-twin: {one_line(error)}", file=sys.stderr)
        return BAD_INPUT
    except MemoryError:
        print(
            "ves-twin: not enough memory; a shorter run or a smaller file takes less",
            file=sys.stderr,
        )
        return BAD_INPUT
    except KeyboardInterrupt:
        print("ves-twin: interrupted", file=sys.stderr)
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
