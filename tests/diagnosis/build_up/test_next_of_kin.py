"""A cause that held-out rows do not bear out leaves its place to another at the same target."""

from __future__ import annotations

import pytest
from linear import Linear, halves

from ves_twin.diagnosis.build_up.next_of_kin import MOST, next_of_kin
from ves_twin.diagnosis.build_up.proof import Proof, prove

PLANT = Linear()


def proofs(hidden: dict[str, float], chosen: set[str]) -> tuple[Proof, Proof, dict[int, str]]:
    """Of a choice alone, and with what takes the place of dropped ones; labels by number."""
    both = halves(PLANT, hidden, 4)
    labels = {n: trial.cause.label for n, trial in enumerate(both.regression.trials)}
    some: dict[str, int] = {}
    for n, label in labels.items():
        if label in chosen:
            some.setdefault(label, n)
    before = prove(both.regression, both.held, list(some.values()))
    return before, next_of_kin(before), labels


@pytest.mark.parametrize(
    ("there", "chosen"),
    [("coulomb", "offset"), ("viscous", "harmonic"), ("harmonic", "spring"), ("harmonic", "drag")],
)
def test_what_was_dropped_leaves_its_place_to_what_is_there(there, chosen):
    hidden = {f"{there}@a:size": 0.3, "spring@b:size": 1.0}
    before, after, labels = proofs(hidden, {f"{chosen}@a", "spring@b"})
    assert {labels[n] for n in before.proved} == {"spring@b"}
    assert {labels[n] for n in after.proved} == {f"{there}@a", "spring@b"}
    assert after.tested == before.tested + 1
    assert {labels[n] for n in after.dropped} == {f"{chosen}@a"}


@pytest.mark.parametrize("chosen", [{"viscous@a", "spring@b"}, {"spring@b"}])
def test_nothing_enters_where_nothing_is_and_the_proof_stays_as_it_was(chosen):
    before, after, _ = proofs({"spring@b:size": 1.0}, chosen)
    assert after is before


def test_what_was_tried_in_vain_counts_for_the_rate_of_what_enters():
    """A gap before the offset: of the others at its target the first does not pass."""
    hidden = {"spring@a:size": 0.15, "spring@b:size": 1.0}
    before, after, labels = proofs(hidden, {"offset@a", "spring@b"})
    entered = {labels[n] for n in after.proved} - {labels[n] for n in before.proved}
    assert len(entered) == 1
    assert after.tested > before.tested + 1
    assert after.tested <= before.tested + MOST
