"""Shared by the tests of commands."""

import pytest


@pytest.fixture
def unpictured(monkeypatch):
    """A comparison without its page, whose pictures take most of its time; others draw it."""
    monkeypatch.setattr("ves_twin.report.comparison.page.comparison_page", lambda comparison: "")
