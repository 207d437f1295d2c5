"""Forms: the dictionary of closed laws."""

from __future__ import annotations

import pickle

from ves_twin.diagnosis.law.forms import FORMS, TONE


def test_every_form_goes_to_another_process_and_is_itself_there() -> None:
    for form in (TONE, *(form for forms in FORMS.values() for form in forms)):
        assert pickle.loads(pickle.dumps(form)) is form


def test_a_step_of_a_position_is_not_called_coulomb_friction() -> None:
    names = {what: {form.name for form in forms} for what, forms in FORMS.items()}
    assert [what for what, known in names.items() if "Coulomb" in known] == ["speed"]
    assert "step at zero" in names["position"] & names["command"]
