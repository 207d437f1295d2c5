"""Commands that make the figures of the pages exist, and what they run does."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = (*sorted((ROOT / "docs").rglob("*.md")), ROOT / "README.md")


def test_mutants_are_of_modules_that_exist_and_run_tests_that_do(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    mutation = importlib.import_module("mutation")
    for room in mutation.ROOMS:
        missing = [name for name in (*room.modules, *room.tests) if not (ROOT / name).exists()]
        assert not missing
    sys.modules.pop("mutation")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_scripts_and_targets_that_a_page_names_exist(page):
    text = page.read_text(encoding="utf-8")
    scripts = set(re.findall(r"\bbenchmarks/[\w/]+\.\w+", text))
    assert not sorted(name for name in scripts if not (ROOT / name).exists())
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([\w-]+):", makefile, re.M))
    named = set(re.findall(r"^\s*make ([\w-]+)", text, re.M)) | set(
        re.findall(r"`make ([\w-]+)", text)
    )
    assert named <= targets
