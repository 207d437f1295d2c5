"""notebook_pages: the notebooks as pages, with what they print and draw."""

from __future__ import annotations

import base64
import re
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient

_INDEX = """# Notebooks

Seven notebooks in `notebooks/`, each of which `make test` runs from top to bottom. `make docs` runs them, too, and shows here what they print and
draw. To change something and run them again:

    .venv/bin/python -m pip install jupyterlab     # or any other notebook program
    .venv/bin/jupyter lab notebooks/

"""

_COLOURS = re.compile(r"\x1b\[[0-9;]*m")

LONGEST = 600
"""Time a cell may take [s]; the first one on a machine may compile."""

QUIET = ["--log-level=ERROR"]
"""Of the kernel, which warns of its transport."""


def notebook_pages(folder: Path, run: bool) -> dict[str, str | bytes]:
    """Name of a page -> its text, and a list of them; pictures beside them.

    Args:
        folder: of the notebooks.
        run: whether they are run; else the pages have no outputs.
    """
    pages: dict[str, str | bytes] = {}
    index = [_INDEX]
    for path in sorted(folder.glob("*.ipynb")):
        notebook = nbformat.read(path, as_version=4)
        if run:
            with tempfile.TemporaryDirectory() as where:
                resources = {"metadata": {"path": where}}
                NotebookClient(
                    notebook, timeout=LONGEST, resources=resources, extra_arguments=QUIET
                ).execute()
        text = "\n\n".join(_cell(cell, f"notebooks/{path.stem}", pages) for cell in notebook.cells)
        title = notebook.cells[0].source.splitlines()[0].removeprefix("# ")
        pages[f"notebooks/{path.stem}.md"] = f"{text}\n\n*`notebooks/{path.name}`*\n"
        index.append(f"- [{title}]({path.stem}.md)")
    return {"notebooks/index.md": "\n".join(index) + "\n", **pages}


def _cell(cell: nbformat.NotebookNode, stem: str, pages: dict[str, str | bytes]) -> str:
    """A cell as Markdown; its pictures go to the pages."""
    if cell.cell_type == "markdown":
        return str(cell.source)
    parts = [f"```python\n{cell.source}\n```"]
    said = ""
    for output in cell.outputs:
        data = output.get("data", {})
        if "image/png" in data:
            name = f"{stem}_{sum(name.startswith(stem) for name in pages) + 1}.png"
            pages[name] = base64.b64decode(data["image/png"])
            parts.append(f"![What the cell draws]({Path(name).name})")
        elif output.get("name") != "stderr":
            said += _COLOURS.sub("", output.get("text", data.get("text/plain", "")))
    if said:
        parts.insert(1, f"```text\n{said.rstrip()}\n```")
    return "\n\n".join(parts)
