"""home_page: README.md as the first page of the site."""

from __future__ import annotations

from pathlib import Path


def home_page(root: Path) -> str:
    """README.md with its links into docs/ as links of the site."""
    text = (root / "README.md").read_text(encoding="utf-8")
    return text.replace("](docs/decisions/)", "](decisions/README.md)").replace("](docs/", "](")
