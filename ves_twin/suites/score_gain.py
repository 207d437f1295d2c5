"""score_gain: which share of the gain that could be had right names have on held-out data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.whitening import whitening_of
from ves_twin.suites.answers import Answer
from ves_twin.suites.judgement import Judgement, judge
from ves_twin.suites.machine import BlindMachine
from ves_twin.suites.machines import machine_of
from ves_twin.suites.rate import Rate
from ves_twin.suites.suite import HELD_OUT, STANDSTILL, load_suite
from ves_twin.suites.truth import Hidden, Truth

VISIBLE = 0.02
"""Fall of mean z^2 that the true values bring, from which a held-out recording shows a cause."""

MOST = 0.9
"""Share of it that an extension should bring."""


def score_gain(
    folder: Path, truths: Sequence[Truth], answers: Mapping[str, Answer]
) -> dict[str, Rate]:
    """Count, of single causes with the right name and a held-out recording that shows them.

    The gain that could be had is that of the rig's true values in the model.

    Args:
        folder: of the suite.
        truths: of the suite, with the rigs' values.
        answers: case -> answer.
    """
    machine = machine_of(load_suite(folder).machine)
    still = load_recording(folder / STANDSTILL)
    had, passed, right, many = [], [], 0, []
    for truth in truths:
        answer = answers.get(truth.case)
        known = truth.values and not truth.repaired and not truth.background
        if truth.hidden not in (Hidden.SINGLE, Hidden.MANY) or not known:
            continue  # true values do not explain the rest
        if answer is None or not answer.energies:
            many += [0.0] if answer and truth.hidden is Hidden.MANY else []
            continue
        if truth.hidden is Hidden.MANY:
            many.append(_share(machine, folder, truth, still, answer.energies))
            continue
        if judge(answer, truth.labels, outside=False) is not Judgement.RIGHT:
            continue
        right += 1
        held_out = load_recording(folder / truth.case / HELD_OUT)
        least = true_energy(machine, held_out, still, truth.values)
        before, after = answer.energies
        if before - least > VISIBLE:
            had.append((before - after) / (before - least))
            passed.append(bool(answer.passed))
    return {
        "right names that held-out data show": Rate(len(had), right),
        f"those: {MOST:.0%} of the gain that could be had": Rate.over(had, lambda s: s >= MOST),
        f"many: {MOST:.0%} of the gain that could be had": Rate.over(many, lambda s: s >= MOST),
        "those: the gate passes": Rate.over(passed, bool),
    }


def _share(
    machine: BlindMachine,
    folder: Path,
    truth: Truth,
    still: Recording,
    energies: Sequence[float],
) -> float:
    """Of the gain that the rig's true values would bring on its held-out recording."""
    held_out = load_recording(folder / truth.case / HELD_OUT)
    least = true_energy(machine, held_out, still, truth.values)
    before, after = energies
    return (before - after) / max(before - least, VISIBLE)


def true_energy(
    machine: BlindMachine, held_out: Recording, standstill: Recording, values: Mapping[str, float]
) -> float:
    """Mean z^2 that the true values leave of a held-out recording: noise, and what no model has.

    The step of the forward is not the rig's: its trace is taken off as a diagnosis takes it off.

    Args:
        machine: whose forward was held against the recording.
        held_out: the recording.
        standstill: tells the noise.
        values: every value of the rig, by parameter.
    """
    seen = preprocess(machine.forward, [held_out], rate=machine.rate)
    runs, measured = seen.runs, seen.measured
    shift = runs.origin
    for i, axis in enumerate(runs.coordinates):
        shift[i] = values.get(axis.parameter.name, axis.parameter.nominal) - axis.parameter.nominal
    coarse, fine = runs.one(shift), runs.one(shift, refined=True)
    plain = whitening_of(runs, standstill)
    first = Metric(2.0 * plain.apply((fine - coarse)[None]).T)
    own = plain.adapted(first.project(plain.apply(measured - coarse)))
    left = Metric(2.0 * own.apply((fine - coarse)[None]).T).project(own.apply(measured - coarse))
    return float(left @ left) / len(left)
