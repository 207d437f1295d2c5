"""Where the plant breaks off at a full fit, choosing goes on from what was before it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from linear import Linear, recorded, seen

from ves_twin.diagnosis.build_up import builder as builder_module
from ves_twin.diagnosis.build_up.builder import Builder
from ves_twin.diagnosis.build_up.plain_selector import PlainSelector
from ves_twin.diagnosis.record.runs import silent


def built() -> Builder:
    plant = Linear(("viscous_friction", "coulomb"))
    hidden = {"viscous_friction@a:size": 1.0}
    one, two = (seen(plant, recorded(plant, hidden, seed)) for seed in (5, 6))
    screen = SimpleNamespace(bank=SimpleNamespace(hypotheses=plant.hypotheses))
    desk = SimpleNamespace(first=SimpleNamespace(screen=screen), progress=silent)
    return Builder(desk, one, two)


def test_a_fit_at_which_nothing_is_predicted_moves_no_column(monkeypatch):
    """Columns about it are no numbers: `cho_factor` of them ended a servo's diagnosis."""
    builder = built()
    halves = builder.halves(builder.fitted.runs.origin, ())
    begin, chosen = builder.fitted.runs.origin, PlainSelector(halves.regression).run([])
    fit = builder_module.in_full

    def broken(*given, **named):
        found = fit(*given, **named)
        return replace(found, shift=np.full_like(found.shift, np.nan))

    monkeypatch.setattr(builder_module, "in_full", broken)
    monkeypatch.setattr(
        builder_module, "bare_residual", lambda evidence, _: np.full_like(evidence.measured, np.nan)
    )
    kept, point, still = builder.settled(PlainSelector, halves, chosen, begin)
    assert kept is halves
    assert point is begin
    assert still == chosen


def test_a_fit_at_which_held_out_rows_alone_break_off_moves_no_column(monkeypatch):
    """A square wave that was held out ended the diagnosis of a servo's sweep in a traceback."""
    builder = built()
    halves = builder.halves(builder.fitted.runs.origin, ())
    chosen = PlainSelector(halves.regression).run([])
    assert halves.sound
    whole = Builder.halves

    def broken(self, *given, **named):
        found = whole(self, *given, **named)
        lost = np.full_like(found.held.target, np.nan)
        return replace(found, held=replace(found.held, target=lost))

    monkeypatch.setattr(Builder, "halves", broken)
    begin = builder.fitted.runs.origin
    kept, point, still = builder.settled(PlainSelector, halves, chosen, begin)
    assert kept is halves
    assert point is begin
    assert still == chosen
