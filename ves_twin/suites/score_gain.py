"""mark_gain: which share of the gain that could be had right names have on held-out data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ves_twin.core.recording.files import load_recording
from ves_twin.suites.achievable import true_energy
from ves_twin.suites.answers import Answer
from ves_twin.suites.benches import bench_of
from ves_twin.suites.rate import Rate
from ves_twin.suites.suite import HELD_OUT, STANDSTILL, load_suite
from ves_twin.suites.truth import Hidden, Truth

VISIBLE = 0.02
"""Fall of mean z^2 that the true values bring, from which a held-out recording shows a cause."""

MOST = 0.9
"""Share of it that an extension should bring."""


def mark_gain(
    folder: Path, truths: Sequence[Truth], answers: Mapping[str, Answer]
) -> dict[str, Rate]:
    """Count, of single causes with the right name and a held-out recording that shows them.

    The gain that could be had is that of the rig's true values in the model.

    Args:
        folder: of the suite.
        truths: of the suite, with the rigs' values.
        answers: case -> answer.
    """
    forward = bench_of(load_suite(folder).bench).forward
    still = load_recording(folder / STANDSTILL)
    had, passed, right = [], [], 0
    for truth in truths:
        answer = answers.get(truth.case)
        known = truth.values and not truth.repaired and not truth.background
        if truth.hidden is not Hidden.SINGLE or not known:  # true values do not explain the rest
            continue
        if answer is None or answer.verdict != "named" or not answer.energies:
            continue
        if list(answer.causes) != [truth.causes[0].label]:
            continue
        right += 1
        held_out = load_recording(folder / truth.case / HELD_OUT)
        least = true_energy(forward, held_out, still, truth.values)
        before, after = answer.energies
        if before - least > VISIBLE:
            had.append((before - after) / (before - least))
            passed.append(bool(answer.passed))
    return {
        "right names that held-out data show": Rate(len(had), right),
        f"those: {MOST:.0%} of the gain that could be had": Rate.over(had, lambda s: s >= MOST),
        "those: the gate passes": Rate.over(passed, bool),
    }
