"""decide: what kind of verdict fits and held-out gains make."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from toy import SD, Toy, programme

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.decide import _kind, _probed
from ves_twin.diagnosis.fit.refine import Fit, refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind

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


@dataclass(frozen=True)
class Found:
    """What of an explanation is probed."""

    evidence: Evidence
    chosen: tuple[Fit, ...]
    fits: tuple[Fit, ...]


@pytest.mark.parametrize("sparse", [True, False])
def test_probes_let_no_commissioning_error_beyond_what_a_fit_was_held_to(sparse: bool) -> None:
    """A slope 12 sd off is one more fault; beside a friction that is named it stays at 3.7."""
    fed = programme(1)
    friction = next(h for h in Toy().hypotheses if h.effect == "friction")
    clean = Toy().simulate(fed, {"friction.size": 0.05, "plant.slope": 0.6})
    noise = np.random.default_rng(2).standard_normal(clean.shape) * SD
    runs = Runs(Toy(), (fed,), (0, 1))
    evidence = Evidence(runs, (clean + noise).astype(np.float32), whitening_declared(runs))
    local = linearise(runs, runs.origin)
    free = refine(evidence, (friction,), runs.origin, local)
    held = refine(evidence, (friction,), runs.origin, local, farthest=LIMIT)
    assert free.pull > 2.0 * LIMIT
    settings = replace(Settings(), sparse=sparse)
    for fit in (held, free):
        found = cast("Any", Found(evidence, (fit,), (fit,)))
        assert _probed(found, settings).chosen[0].pull == pytest.approx(fit.pull, rel=0.05)
