"""new_text: a draft as a person reads it in a terminal: each guess with its reason."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.machines.new_machine import NewMachine

NOTHING = 0.05
"""Share of every column's power below which columns, or the model, may be other ones."""


def new_text(found: NewMachine, model: Path, logs: Sequence[Path]) -> str:
    """What was written, each column, what to look at, how near the model is, what to do next."""
    draft = found.draft
    beside = f" and {found.model}" if found.model else ""
    lines = [f"drafted {found.path}{beside} from {model.name} and {logs[0].name}", ""]
    width = max(len(guess.column) for guess in draft.guesses)
    for guess in draft.guesses:
        lines.append(f"  {guess.column:<{width}}  {guess.taken_for}")
        lines.append(f"  {'':<{width}}    {guess.why}")
        lines += [f"  {'':<{width}}    {guess.others}"] if guess.others else []
    lines += [f"  {column:<{width}}  not used: {why}" for column, why in draft.left.items()]
    lines += ["", f"  mode      {draft.mode}"]
    lines += [f"  look      {words}" for words in draft.look]
    shares = ", ".join(f"{share:.0%} of {name}" for name, share in draft.explained.items())
    lines += [f"  as it is  the model explains {shares}"] if shares else []
    held = f" --alternate {draft.stretch:g}" if draft.stretch else ""
    *fitted, last = [str(log) for log in logs]
    held = f" --held-out {last}" if fitted else held
    given = " ".join(fitted or [last])
    first = ""
    if draft.explained and max(draft.explained.values()) < NOTHING:
        first = "look whether each column is what it is taken for: the model explains none; then "
    lines += [f"  next      {first}ves-twin diagnose {given}{held} --plant {found.path}"]
    return "\n".join(lines)
