"""Where simulations fall out of step, causes are proved by the efforts that the motion lacks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lively_arm import lively, measured

from ves_twin.core.recording.recording import Recording
from ves_twin.core.workers import Workers
from ves_twin.diagnosis import view as view_module
from ves_twin.diagnosis.fit.assess import assess, pull_limit
from ves_twin.diagnosis.fit.null import noise_thresholds
from ves_twin.diagnosis.judge_view import judge_as_seen, judge_view
from ves_twin.diagnosis.record.runs import silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.diagnosis.view import Material, View
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.report.diagnosis.basis import basis_sentences

HIDDEN = {"coulomb_friction@a:level": 0.057, "coulomb_friction@b:level": 0.03}
WHIRLS = 0.45
"""Tones of the motor [N m] by which the second link goes round."""
SWINGS = 0.1
"""By which it swings, so that one fit can follow it."""


def out_of_step(measured, bank, whitening, settings, progress):
    """As `looked` where simulated rigs in order leave a thousand sigma, without simulating any."""
    limits = replace(noise_thresholds(bank, whitening, settings.alpha), in_order=1000.0)
    pull = pull_limit(bank, settings.alpha)
    return limits, assess(measured, bank, whitening, limits.effect, limits.misfit, pull)


@pytest.fixture(scope="module")
def forward(tmp_path_factory: pytest.TempPathFactory) -> MjcfForward:
    return MjcfForward.of(lively(tmp_path_factory.mktemp("lively")))


def view(forward: MjcfForward, recordings: list[Recording], laws: bool = False) -> View:
    one, other = recordings
    material = Material((one,), (other,), None, (), (), (), None)
    settings = Settings(causes=12, laws=laws)
    return View.of(forward, material, settings, Workers(1), silent)


def recorded(forward: MjcfForward, hidden: dict[str, float]) -> list[Recording]:
    values = {p.name: p.nominal for p in forward.parameters} | hidden
    return [measured(forward.rig, values, 5.0, seed, WHIRLS) for seed in (61, 62)]


@pytest.fixture(scope="module")
def verdict(forward: MjcfForward) -> Verdict:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(view_module, "looked", out_of_step)
        seen = view(forward, recorded(forward, HIDDEN)).seen_by_motion(silent)
    assert seen is not None
    return judge_as_seen(seen, silent)


def test_frictions_of_an_arm_that_whirls_are_proved_with_their_sizes(verdict):
    proved = {one.label: one for one in verdict.proved}
    assert proved.keys() == {"coulomb_friction@a", "coulomb_friction@b"}
    for label, one in proved.items():
        (size,) = one.parameters.values()
        assert size.low <= HIDDEN[f"{label}:level"] <= size.high
        assert size.value == pytest.approx(HIDDEN[f"{label}:level"], rel=0.25)


def test_the_report_says_that_efforts_were_compared_and_why(verdict):
    assert verdict.basis.by_motion
    assert verdict.residuals.keys() == {"a.missing", "b.missing"}
    assert verdict.gain is not None
    assert all(after < before for before, after in verdict.gain.errors.values())
    (told,) = (text for text in basis_sentences(verdict) if "cannot be compared" in text)
    assert "efforts are compared in place of motions" in told


@pytest.mark.nightly
def test_a_law_of_an_arm_that_whirls_is_told_beside_what_is_proved(forward, monkeypatch):
    monkeypatch.setattr(view_module, "looked", out_of_step)
    knots = np.linspace(-30.0, 30.0, 31)
    drag = -0.008 * knots * np.abs(knots)
    law = Law("a", LawKind.EFFORT, LawShape.TABLE, ("speed@a",), (tuple(knots),), tuple(drag))
    records = [measured(forward.rig, {}, 8.0, seed, WHIRLS, [law]) for seed in (61, 62)]
    seen = view(forward, records, laws=True).seen_by_motion(silent)
    assert seen is not None
    found = judge_as_seen(seen, silent).law
    assert found is not None
    assert found.claimed
    assert (found.place, found.of) == ("a", ("speed@a",))
    assert found.gain is not None
    before, after = found.gain.errors["a.missing"]
    assert after < 0.8 * before


def test_what_simulations_can_follow_is_not_seen_by_its_motion(forward, monkeypatch):
    def followed(*given: object) -> tuple[object, object]:
        limits, first = out_of_step(*given)
        return replace(limits, in_order=None), first

    monkeypatch.setattr(view_module, "looked", followed)
    assert view(forward, recorded(forward, {})).seen_by_motion(silent) is None


def test_a_single_cause_that_leaves_noise_is_asked_before_the_motion(forward, monkeypatch):
    """Half the time of a crane went into its motion, whose answer was not needed."""

    def asked(*_given: object) -> None:
        raise AssertionError("the motion was asked")

    monkeypatch.setattr(view_module, "looked", out_of_step)
    values = {p.name: p.nominal for p in forward.parameters}
    values |= {"coulomb_friction@a:level": HIDDEN["coulomb_friction@a:level"]}
    followed = [measured(forward.rig, values, 2.0, seed, SWINGS) for seed in (61, 62)]
    monkeypatch.setattr(View, "seen_by_motion", asked)
    found = judge_view(view(forward, followed), silent)
    assert [(cause.effect, cause.target) for cause in found.causes] == [("coulomb_friction", "a")]
    assert not found.basis.by_motion
    assert not found.lacks
