"""make_suite: recordings with hidden effects in a folder, the truth of each sealed beside it."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from ves_twin.core.errors import FileAccessError, InvalidInputError
from ves_twin.core.whole_file import whole_file
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.build_up.discrepancy import discrepancy
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.suites.aliases import aliases
from ves_twin.suites.draw import Detectability, draw_truths
from ves_twin.suites.likes import Likes
from ves_twin.suites.machine import BlindMachine, BlindRig
from ves_twin.suites.machines import machine_of
from ves_twin.suites.model_error import everywhere, outside_library
from ves_twin.suites.pinned import pinned_recipe
from ves_twin.suites.recipe import Recipe
from ves_twin.suites.save_bare import save_bare
from ves_twin.suites.seal import new_key, seal, unseal
from ves_twin.suites.suite import (
    BASELINE,
    FILE,
    HELD_OUT,
    RECORDING,
    STANDSTILL,
    Suite,
    commissioning_file,
    from_folder,
)
from ves_twin.suites.truth import Hidden, Truth

Progress = Callable[[float, str], None]

DRAWN = "drawn.sealed"
"""What the cases hide, before they are recorded."""

DRIFT = 0.3
"""Commissioning sd by which a rig changes between its baseline and the case, of its spread."""

LEAD = (2.0, 8.0)
"""Motion before the piece that a cut recording is [s]."""


def make_suite(
    recipe: Recipe, folder: Path, key_file: Path, progress: Progress, workers: int = 1
) -> Suite:
    """Write a suite; one that was interrupted goes on where it was.

    Args:
        recipe: what it is asked to hold.
        folder: for the recordings.
        key_file: takes the key; it is what a diagnosis must not see.
        progress: told how far it is.
        workers: processes.

    Raises:
        UnknownNameError: no such machine or background.
        InvalidInputError: a folder that holds something else, or a recipe that cannot be met.
        FileAccessError: not writable.
    """
    machine = machine_of(recipe.machine)
    recipe.check(machine)
    key = _key(folder, key_file)
    stored = replace(recipe, machine=from_folder(recipe.machine, folder))
    seed = pinned_recipe(stored, folder, key).seed
    recipe = replace(recipe, seed=seed)
    root = recipe.rng(1)
    standstill = machine.record(
        BlindRig(machine.commissioned(root, recipe.spread)), "standstill", root
    )
    save_bare(standstill, folder / STANDSTILL)
    _commission(machine, recipe, folder)
    truths = _kept(folder, key, lambda: _truths(machine, recipe, progress, workers))
    for n, truth in enumerate(truths):
        progress(n / len(truths), "recordings")
        sealed = folder / truth.case / "truth.sealed"
        if not sealed.is_file():
            whole = _record(machine, truth, recipe, folder, n)
            with whole_file(sealed) as partial:
                partial.write_bytes(seal(whole.to_json(), key))
    excluded = {
        t.case: tuple(c.label for c in t.causes)
        for t in truths
        if t.hidden is Hidden.OUTSIDE and t.causes
    }
    cases = tuple(t.case for t in truths)
    suite = Suite(recipe.machine, cases, excluded, recipe.commissioned, recipe.baseline)
    suite.save(folder)
    return suite


def _key(folder: Path, key_file: Path) -> str:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if key_file.is_file():
            return key_file.read_text().strip()
        if (folder / FILE).exists() or any(folder.glob("case-*")):
            raise InvalidInputError(str(folder), "cases whose key is missing", "an empty folder")
        key = new_key()
        key_file.write_text(key + "\n")
    except OSError as error:
        raise FileAccessError(f"cannot write {error.filename}: {error.strerror}") from None
    return key


def _kept(folder: Path, key: str, draw: Callable[[], list[Truth]]) -> list[Truth]:
    """What was drawn before the suite was interrupted: sizes in sigma take many runs."""
    path = folder / DRAWN
    if path.is_file():
        texts = json.loads(unseal(path.read_bytes(), key, str(path)))
        return [Truth.from_json(text) for text in texts]
    truths = draw()
    with whole_file(path) as partial:
        partial.write_bytes(seal(json.dumps([truth.to_json() for truth in truths]), key))
    return truths


def _commission(machine: BlindMachine, recipe: Recipe, folder: Path) -> None:
    """Other rigs in order, each drawn for itself."""
    for k in range(recipe.commissioned):
        rng = recipe.rng(3, k)
        rig = BlindRig(machine.commissioned(rng, recipe.spread), background=recipe.background)
        save_bare(machine.record(rig, "train", rng), folder / commissioning_file(k + 1))


def _truths(machine: BlindMachine, recipe: Recipe, progress: Progress, workers: int) -> list[Truth]:
    rng = recipe.rng(0)
    nominal = machine.record(BlindRig(), recipe.programme, rng)
    with Workers(workers) as shared:
        runs = preprocess(machine.forward, [nominal], shared, machine.rate).runs
        base = linearise(runs, runs.origin, progress)
        detectability = Detectability(base, whitening_declared(runs))
        if recipe.model_error:
            detectability = _erring(machine, recipe, detectability, rng)
        truths = draw_truths(machine, recipe.counts, detectability, rng, recipe.spread, progress)
        left_out = [t for t in truths if t.hidden is Hidden.OUTSIDE and t.causes]
        likes = dict(
            zip([t.case for t in left_out], aliases(runs, left_out, progress), strict=True)
        )
        if recipe.model_error:
            truths = _with_errors(truths, recipe, detectability)
    return [replace(t, background=recipe.background, aliases=likes.get(t.case, ())) for t in truths]


def _erring(
    machine: BlindMachine, recipe: Recipe, shown: Detectability, rng: np.random.Generator
) -> Detectability:
    """Sizes in sigma of noise and model error together, as one drawn record shows them."""
    errors = everywhere(recipe.model_error, shown.levels, rng)
    odd = machine.record(BlindRig(errors=errors), recipe.programme, rng)
    seen = preprocess(machine.forward, [odd], rate=machine.rate)
    residual = np.asarray(seen.measured - shown.base.prediction, float)
    return replace(shown, whitening=discrepancy(shown.base.runs, residual))


def _with_errors(truths: list[Truth], recipe: Recipe, shown: Detectability) -> list[Truth]:
    """Each machine with model error of its own; one with many causes with some outside, too."""
    likes, found = Likes(shown), []
    for n, truth in enumerate(truths):
        rng = recipe.rng(6, n)
        errors = everywhere(recipe.model_error, shown.levels, rng)
        if truth.hidden is Hidden.MANY:
            errors += outside_library(shown.levels, rng)
        causes = tuple(replace(cause, likes=likes.of(cause)) for cause in truth.causes)
        found.append(replace(truth, errors=errors, causes=causes))
    return found


def record_pair(
    machine: BlindMachine,
    rigs: tuple[BlindRig, BlindRig],
    place: Path,
    rng: np.random.Generator,
    programme: str = "train",
    lead: float = 0.0,
) -> None:
    """Write what is to be explained, and what is held out.

    Args:
        machine: that measures.
        rigs: of the two recordings.
        place: folder of the case.
        rng: of noise and disturbance.
        programme: of the first recording.
        lead: motion before it that is not recorded [s].
    """
    for rig, fed, name in zip(rigs, (programme, "held_out"), (RECORDING, HELD_OUT), strict=True):
        save_bare(machine.record(rig, fed, rng, lead), place / name)


def hide(
    machine: BlindMachine,
    usual: Mapping[str, float],
    truth: Truth,
    deployed: Mapping[str, object] | None = None,
) -> BlindRig:
    """A rig within its tolerances with what a case hides.

    Args:
        machine: whose rig.
        usual: its values without anything hidden.
        truth: what is hidden.
        deployed: keys of the scenario that its programs have otherwise.
    """
    nominal, values = {p.name: p.nominal for p in machine.forward.parameters}, dict(usual)
    for cause in truth.causes if truth.hidden is not Hidden.EDITED else ():
        for name, departure in cause.departures.items():
            values[name] = values.get(name, nominal[name]) + departure
    kind, size = truth.outside, truth.outside_size
    return BlindRig(values, kind, size, deployed or {}, truth.background, errors=truth.errors)


def _record(
    machine: BlindMachine, truth: Truth, recipe: Recipe, folder: Path, number: int
) -> Truth:
    """Write the recordings of a case; its truth with every value of the rig."""
    rng = recipe.rng(2, number)
    usual = machine.commissioned(rng, truth.spread)
    rig = hide(machine, usual, truth)
    truth = replace(truth, values=rig.values, repaired=recipe.repaired)
    healthy = BlindRig(usual, background=truth.background, errors=truth.errors)
    place = folder / truth.case
    lead = recipe.rng(4, number).uniform(*LEAD) if recipe.cut else 0.0
    held = healthy if recipe.repaired else rig
    record_pair(machine, (rig, held), place, rng, recipe.programme, lead)
    if recipe.baseline:
        rng = recipe.rng(5, number)
        before = machine.again(usual, rng, truth.spread, DRIFT * truth.spread)
        healthy = replace(healthy, values=before)
        save_bare(machine.record(healthy, recipe.programme, rng), place / BASELINE)
    return truth
