"""decide: what kind of verdict fits and held-out gains make."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from ves_twin.diagnosis.decide import _kind
from ves_twin.diagnosis.verdict import Kind

LIMIT = 3.7


def found(pull: float, adequate: bool = False) -> Any:
    best = SimpleNamespace(pull=pull, causes=("spring",))
    return SimpleNamespace(adequate=adequate, best=best, chosen=(best,))


@pytest.mark.parametrize(
    ("pull", "low", "kind"),
    [
        (1.0, 0.99, Kind.PARTIAL),
        (1.0, 0.90, Kind.UNKNOWN),
        (30.0, 0.99, Kind.UNKNOWN),
    ],
)
def test_a_part_of_the_truth_strains_no_commissioning_error(
    pull: float, low: float, kind: Kind
) -> None:
    gains = cast("Any", [SimpleNamespace(low=low, share=low)])
    assert _kind(found(pull), gains, LIMIT) is kind
    assert _kind(found(pull, adequate=True), gains, LIMIT) is Kind.NAMED
