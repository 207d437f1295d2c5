"""notebook_pages: the notebooks as pages, text and code without outputs."""

from __future__ import annotations

from pathlib import Path

import nbformat

_INDEX = """# Notebooks

Seven notebooks in `notebooks/`, each of which `make test` runs from top to bottom. The pages here show text and code; run them to see numbers and
plots:

    .venv/bin/python -m pip install jupyterlab     # or any other notebook program
    .venv/bin/jupyter lab notebooks/

"""


def notebook_pages(folder: Path) -> dict[str, str]:
    """Name of a page -> its text, and a list of them."""
    pages, index = {}, [_INDEX]
    for path in sorted(folder.glob("*.ipynb")):
        notebook = nbformat.read(path, as_version=4)
        text = "\n\n".join(_cell(cell) for cell in notebook.cells)
        title = notebook.cells[0].source.splitlines()[0].removeprefix("# ")
        pages[f"notebooks/{path.stem}.md"] = f"{text}\n\n*`notebooks/{path.name}`*\n"
        index.append(f"- [{title}]({path.stem}.md)")
    return {"notebooks/index.md": "\n".join(index) + "\n", **pages}


def _cell(cell: nbformat.NotebookNode) -> str:
    return cell.source if cell.cell_type == "markdown" else f"```python\n{cell.source}\n```"
