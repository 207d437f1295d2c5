"""A notebook's page shows its code, what that prints, and what it draws."""

import sys
from pathlib import Path

import nbformat

sys.path.append(str(Path(__file__).parents[2] / "docs" / "generate"))
from notebook_pages import notebook_pages

CODE = """import sys
import matplotlib.pyplot as plt
print("one")
print("unheard", file=sys.stderr)
print("two")
plt.plot([0, 1])
plt.show()"""


def test_a_page_shows_what_a_notebook_prints_and_draws(tmp_path):
    new = nbformat.v4
    cells = [new.new_markdown_cell("# Title"), new.new_code_cell(CODE)]
    nbformat.write(new.new_notebook(cells=cells), tmp_path / "1_try.ipynb")
    pages = notebook_pages(tmp_path, run=True)
    assert "```text\none\ntwo\n" in pages["notebooks/1_try.md"]
    assert "unheard" not in pages["notebooks/1_try.md"].split("```text")[1]
    assert "](1_try_1.png)" in pages["notebooks/1_try.md"]
    assert pages["notebooks/1_try_1.png"].startswith(b"\x89PNG")
    assert "[Title](1_try.md)" in pages["notebooks/index.md"]
    bare = notebook_pages(tmp_path, run=False)
    assert set(pages) - set(bare) == {"notebooks/1_try_1.png"}
