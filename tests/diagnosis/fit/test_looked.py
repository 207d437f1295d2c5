"""A record whose simulations fall out of step is not in order because rigs in order leave as much."""

from __future__ import annotations

import pytest
from lively_arm import lively, measured

from ves_twin.diagnosis.bank.signature_library import build_bank
from ves_twin.diagnosis.fit.assess import Assessment, pull_limit
from ves_twin.diagnosis.fit.looked import looked
from ves_twin.diagnosis.fit.null import Thresholds
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.runs import silent
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.mjcf.motion.forward import MjcfForward

SETTINGS = Settings(nulls=4)
HIDDEN = {
    "coulomb_friction@a:level": 0.05,
    "coulomb_friction@b:level": 0.02,
    "body_mass@two:mass": 0.38,
}
"""Half a second on, a simulation without these is radians off."""


@pytest.fixture(scope="module")
def forward(tmp_path_factory: pytest.TempPathFactory) -> MjcfForward:
    return MjcfForward.of(lively(tmp_path_factory.mktemp("lively")))


def look(
    forward: MjcfForward, level: float, hidden: dict[str, float]
) -> tuple[Thresholds, Assessment, float]:
    """Of a machine that is driven by tones of a level [N m]; and the limit of a tolerance."""
    nominal = {p.name: p.nominal for p in forward.parameters}
    seen = preprocess(forward, [measured(forward.rig, nominal | hidden, 6.0, 1, level)])
    bank = build_bank(seen.runs)
    limits, first = looked(seen.measured, bank, whitening_declared(seen.runs), SETTINGS, silent)
    return limits, first, pull_limit(bank, SETTINGS.alpha)


@pytest.mark.nightly
def test_where_rigs_in_order_fall_out_of_step_a_record_is_judged_by_noise(forward):
    limits, first, pull = look(forward, 0.45, HIDDEN)
    assert limits.in_order is not None
    assert limits.in_order > 100.0 * limits.misfit  # these are what noise does
    assert first.exceeds(limits.effect, limits.misfit, pull)


def test_where_they_stay_in_step_it_is_judged_by_them(forward):
    limits, first, pull = look(forward, 0.03, {})
    assert limits.in_order is None
    assert len(limits.misfits) == SETTINGS.nulls
    assert not first.exceeds(limits.effect, limits.misfit, pull)
