"""What was considered beside an answer: each set of causes once, by its nearest fit."""

from __future__ import annotations

from types import SimpleNamespace

from ves_twin.diagnosis.explain import rivals as rivals_module
from ves_twin.diagnosis.explain.rivals import Rival, Standing, rivals_of


def test_causes_that_were_fitted_twice_stand_once_where_they_lose_least(monkeypatch):
    """A mass centre that was its own nearest rival, 0 of chi^2 behind."""

    def told(found, fit, standing):
        return Rival(fit.causes, (), standing, fit.chi2 - found.best.chi2, None, None, None)

    def fit(chi2, *causes):
        return SimpleNamespace(chi2=chi2, causes=causes)

    monkeypatch.setattr(rivals_module, "_fitted", told)
    best, again, other, far = fit(9.0, "a"), fit(9.1, "a"), fit(12.0, "b"), fit(40.0, "b")
    found = SimpleNamespace(
        best=best, chosen=(best,), fits=(best, again, other, far), hopeless=(far,), alone=()
    )
    found_of = rivals_of(SimpleNamespace(suspects=()), found)
    assert [(one.causes, one.standing, one.behind) for one in found_of] == [
        (("a",), Standing.KEPT, 0.0),
        (("b",), Standing.LOST, 3.0),
    ]
