"""play_next: the rig of each ambiguous case carries a next experiment out.

It holds the key: the rig is the hidden one. Nothing of it comes out but the recording.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.whole_file import write_whole
from ves_twin.suites.answers import Answer
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.machines import machine_of
from ves_twin.suites.save_bare import save_bare
from ves_twin.suites.suite import load_suite, next_file
from ves_twin.suites.truth import Truth

CHOICES = ("proposed", "random")
"""Which of the offered programmes: the likeliest to part the causes, or any."""


def play_next(
    folder: Path,
    key: str,
    truths: Sequence[Truth],
    answers: Mapping[str, Answer],
    choice: str,
    progress: Callable[[float, str], None],
) -> dict[str, str]:
    """Record the next experiment of every case that was answered with offered programmes.

    Args:
        folder: of the suite.
        key: of its seal; noise is drawn from it, too.
        truths: opened with it.
        answers: of the first recordings.
        choice: one of CHOICES.
        progress: told how far it is.

    Returns:
        Case -> programme, as it is written beside the suite's cases.

    Raises:
        UnknownNameError: no such choice.
        InvalidInputError: a suite whose rigs were not kept, or of a plant that plays nothing.
    """
    if choice not in CHOICES:
        raise UnknownNameError("choice of a next experiment", choice, CHOICES)
    machine = machine_of(load_suite(folder).machine)
    menu = machine.excitations
    played = {}
    asked = [t for t in truths if t.case in answers and answers[t.case].programmes]
    for n, truth in enumerate(asked):
        progress(n / len(asked), "next experiments")
        offered = answers[truth.case].programmes or {}
        if not truth.values:
            raise InvalidInputError(str(folder), "a suite without its rigs", "one made anew")
        rng = _rng(key, truth.case, choice)
        name = _chosen(offered, choice, rng)
        if name not in menu:
            raise UnknownNameError("next programme", name, menu)
        values = machine.again(truth.values, rng, truth.spread, 0.0)
        rig = BlindRig(values, truth.outside, truth.outside_size, background=truth.background)
        save_bare(machine.play(rig, menu[name], rng), folder / truth.case / next_file(choice))
        played[truth.case] = name
    write_whole(played_file(folder, choice), json.dumps(played, indent=1) + "\n")
    return played


def played_file(folder: Path, choice: str) -> Path:
    """Case -> programme that was played."""
    return folder / f"next-{choice}.json"


def _chosen(offered: Mapping[str, float], choice: str, rng: np.random.Generator) -> str:
    if choice == "proposed":
        return max(offered, key=lambda name: offered[name])
    return str(rng.choice(sorted(offered)))


def _rng(key: str, case: str, choice: str) -> np.random.Generator:
    """As secret as the key, and the same again."""
    digest = hashlib.sha256(f"{key} {case} {choice}".encode()).digest()
    return np.random.default_rng(int.from_bytes(digest))
