"""The teacher's page names functions, commands and notebooks that exist, and marking works."""

import importlib
import importlib.util
import json
import re
import shlex
import sys
from pathlib import Path

import pytest

from ves_twin.cli.main import build_parser, main
from ves_twin.scenario.load import procedure_questions, scenario_questions
from ves_twin.thesis.claim import load_claims
from ves_twin.thesis.figures.registry import FIGURES

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "teaching.md").read_text(encoding="utf-8")
NOTEBOOKS = {int(p.name[0]) for p in (ROOT / "notebooks").glob("*.ipynb")}


@pytest.fixture(scope="module")
def table():
    spec = importlib.util.spec_from_file_location(
        "teaching_table", ROOT / "benchmarks" / "teaching.py"
    )
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def test_every_row_names_what_exists_and_stands_on_the_page(table):
    assert len(table.ROWS) >= 15
    names = {*scenario_questions(), *procedure_questions()}
    for row in table.ROWS:
        module, _, attribute = row.function.partition(":")
        assert hasattr(importlib.import_module(f"ves_twin.{module}"), attribute), row.function
        words = shlex.split(row.command)
        build_parser().parse_args(words)
        known = names if words[0] == "run" else {*load_claims(), *FIGURES}
        assert words[1] in known, row.command
        assert row.notebook is None or row.notebook in NOTEBOOKS
        start = re.escape(table.line(row, "").rstrip("| "))
        assert re.search(rf"^{start}[ |]+\d+ \|$", PAGE, re.MULTILINE), row.what


def test_scenarios_and_notebooks_that_the_text_names_exist():
    names = {*scenario_questions(), *procedure_questions()}
    for name in re.findall(r"ves-twin run (\w+)", PAGE):
        assert name in names
    assert {int(n) for n in re.findall(r"notebook (\d)", PAGE)} <= NOTEBOOKS


@pytest.mark.slow
def test_a_student_is_marked_as_the_page_says(tmp_path, capsys):
    """Two cases, one answered as it is, one not at all; then the truth."""
    folder = str(tmp_path / "course")
    assert main(["blind", "make", "--cases", "2", "--out", folder, "--seed", "9"]) == 0
    capsys.readouterr()
    assert main(["blind", "reveal", "--out", folder]) == 0
    told = capsys.readouterr().out.splitlines()
    case, cause = re.match(r"(case-\d+)\s+(\S+) \(", told[0]).groups()
    (example,) = re.findall(r'^    (\{"case-.*\})$', PAGE, re.MULTILINE)
    (answer,) = json.loads(example).values()
    answers = tmp_path / "answers.json"
    answers.write_text(json.dumps({case: {**answer, "causes": [cause]}}))
    marks = tmp_path / "marks.md"
    words = ["blind", "score", "--out", folder, "--answers", str(answers), "--page", str(marks)]
    assert main(words) == 0
    assert "right if named | 1 of 1" in marks.read_text()
