"""Every notebook runs from top to bottom, holds no logic of its own, and is kept without outputs."""

import ast
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from sizes import nightly_but

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
LONGEST = 200  # s a cell, so that a hanging one ends before the test's own limit


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_a_notebook_defines_nothing_and_carries_no_outputs(path):
    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    assert book.cells[0].source.startswith("# ")
    code = [cell for cell in book.cells if cell.cell_type == "code"]
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code)
    trees = [node for cell in code for node in ast.walk(ast.parse(cell.source))]
    assert not [n for n in trees if isinstance(n, ast.FunctionDef | ast.ClassDef)]
    assert len(book.cells) - len(code) >= 3  # it explains


@pytest.mark.slow
@pytest.mark.parametrize("path", nightly_but(1, NOTEBOOKS), ids=lambda p: p.stem)
def test_a_notebook_runs(path, tmp_path):
    book = nbformat.read(path, as_version=4)
    where = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(book, timeout=LONGEST, resources=where).execute()
    said = [o for cell in book.cells if cell.cell_type == "code" for o in cell.outputs]
    assert not [o for o in said if o.get("name") == "stderr" and "Warning" in o.text]
    assert any(o.output_type == "stream" for o in said)
