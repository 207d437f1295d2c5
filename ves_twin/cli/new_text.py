"""new_text: a draft as a person reads it in a terminal: each guess with its reason."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.machines.new_machine import NewMachine

NOTHING = 0.05
"""Share of every column's power below which columns, or the model, may be other ones."""

ONE = (
    "too short for --alternate: give a second log as --held-out. Without one, many causes are"
    " proved by every second tenth, and one or two by nothing"
)
"""What is held out of a log in which no stretches are long enough."""


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
    first = _first({k: v for k, v in draft.explained.items() if k not in draft.rubs})
    if draft.gravity:
        first = "draft again from it; then "
    if draft.untold:
        units = dict.fromkeys(draft.untold.values())
        unit = ", ".join(f"units {u}" if u.startswith("of ") else u for u in units)
        counts = [unit for unit in units if unit.endswith("per count")]
        known = "what the motors give" if not counts else "constants that you know"
        known = "what a count is" if len(counts) == len(units) else known
        asked = " ".join(f"--scale {shlex.quote(c + '=...')}" for c in draft.untold)
        first = f"draft again with {known} ({asked}, in {unit}); then "
    if draft.gravity:
        first = f"see to the gravity in {found.model or model.name}, and {first}"
    if draft.odd_clock:
        first = f"see to the unit of the clock (look), and draft again; then {first}"
    elif draft.short:
        first = f"see to the rows that a diagnosis lacks (look); then {first}"
    if draft.one_only and not fitted:
        lines.append(f"  held out  {ONE}")
    lines += [f"  next      {first}ves-twin diagnose {given}{held} --plant {found.path}"]
    return "\n".join(lines)


def _first(explained: Mapping[str, float]) -> str:
    """What to look at before a diagnosis, where the model explains nothing of some columns."""
    none = [name for name, share in explained.items() if share < NOTHING]
    if not none:
        return ""
    if len(none) == len(explained):
        return "look whether each column is what it is taken for: the model explains none; then "
    one = len(none) == 1
    told = f"{', '.join(none)} {'is' if one else 'are'} what {'it is' if one else 'they are'}"
    it = "it" if one else "them"
    return (
        f"look whether {told} taken for, and whether the position there is the joint's own:"
        f" the model explains nothing of {it}, unless friction is most of {it}; then "
    )
