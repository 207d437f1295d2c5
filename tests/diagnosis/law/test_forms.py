"""Forms: the dictionary of closed laws."""

from __future__ import annotations

import pickle

from ves_twin.diagnosis.law.forms import FORMS, TONE


def test_every_form_goes_to_another_process_and_is_itself_there() -> None:
    for form in (TONE, *(form for forms in FORMS.values() for form in forms)):
        assert pickle.loads(pickle.dumps(form)) is form
