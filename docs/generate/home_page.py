"""home_page and rigs_page: the READMEs of the project and of its rigs as pages of the site."""

from __future__ import annotations

from pathlib import Path


def home_page(root: Path) -> str:
    """README.md with its links into docs/ as links of the site."""
    text = (root / "README.md").read_text(encoding="utf-8")
    return text.replace("](docs/decisions/)", "](decisions/README.md)").replace("](docs/", "](")


def rigs_page(root: Path) -> str:
    """models/machines/README.md, at the top of the site."""
    text = (root / "models" / "machines" / "README.md").read_text(encoding="utf-8")
    page = "bring-your-own-rig.md"
    return text.replace(f"[../../docs/{page}](../../docs/{page})", f"[{page}]({page})")
