"""Rotors and frictions of all joints are offered together, where no search chooses any."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from linear import Linear, recorded, seen

from ves_twin.diagnosis.build_up import builder as builder_module
from ves_twin.diagnosis.build_up.builder import Builder
from ves_twin.diagnosis.build_up.plain_selector import DRY, GEARED, USUAL, PlainSelector
from ves_twin.diagnosis.build_up.select import Selector
from ves_twin.diagnosis.record.runs import silent

HIDDEN = {"rotor@a:size": 0.25, "rotor@b:size": 0.2, "viscous@a:size": 0.5, "viscous@b:size": 0.4}


@pytest.fixture
def builder(monkeypatch) -> Builder:
    """Of two records; neither search chooses anything, as beside 320 trials of a short log."""
    monkeypatch.setattr(Selector, "run", lambda self, begin=(): list(begin))
    monkeypatch.setattr(PlainSelector, "path", lambda self, begin=(): [list(begin)])
    monkeypatch.setattr(Selector, "best", lambda self: [])
    plant = Linear()
    screen = SimpleNamespace(bank=SimpleNamespace(hypotheses=plant.hypotheses))
    desk = SimpleNamespace(first=SimpleNamespace(screen=screen), progress=silent)
    one, two = (seen(plant, recorded(plant, HIDDEN, seed)) for seed in (11, 12))
    return Builder(desk, one, two)


def proved(found) -> set[str]:
    trials = found.halves.regression.trials
    return {trials[n].cause.label for n in found.proof.proved}


def test_what_a_geared_machine_lacks_is_proved_at_every_joint(builder, monkeypatch):
    monkeypatch.setattr(builder_module, "USUAL", ("coulomb", "viscous"))
    monkeypatch.setattr(builder_module, "GEARED", ("coulomb", "viscous", "rotor"))
    assert proved(builder.best()) == {name.split(":")[0] for name in HIDDEN}


def test_frictions_alone_leave_the_rotors(builder, monkeypatch):
    """The case above is one that frictions alone do not serve."""
    monkeypatch.setattr(builder_module, "USUAL", ("coulomb", "viscous"))
    monkeypatch.setattr(builder_module, "GEARED", ("coulomb", "viscous"))
    assert not any("rotor" in name for name in proved(builder.best()))


def test_dry_friction_of_all_joints_is_offered_by_itself(builder, monkeypatch):
    """Of 25 s of a youBot at 8 Hz both frictions of each joint left all but two out."""
    monkeypatch.setattr(builder_module, "DRY", ("viscous",))
    for kinds in ("USUAL", "GEARED"):
        monkeypatch.setattr(builder_module, kinds, ())
    assert proved(builder.best()) == {"viscous@a", "viscous@b"}


def test_kinds_of_geared_machines_are_usual_ones_and_a_rotor():
    assert set(GEARED) - set(USUAL) == {"rotor_inertia"}
    assert set(DRY) < set(USUAL)
