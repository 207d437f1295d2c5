"""hooks: what mkdocs calls; adds the generated pages to the ones of docs/."""

from __future__ import annotations

import os
from pathlib import Path

from commands_page import commands_page
from credibility_page import credibility_page
from format_pages import format_pages
from home_page import home_page, rigs_page
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from notebook_pages import notebook_pages


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add home, commands, credibility, file formats with their schemas, and notebooks."""
    root = Path(config.config_file_path).parent
    pages: dict[str, str | bytes] = {
        "index.md": home_page(root),
        "rigs.md": rigs_page(root),
        "commands.md": commands_page(),
        "credibility.md": credibility_page(root),
        **format_pages(),
        **notebook_pages(root / "notebooks", os.environ.get("RUN_NOTEBOOKS") != "no"),
    }
    for name, text in pages.items():
        files.append(File.generated(config, name, content=text))
    return files


def on_page_markdown(markdown: str, **_: object) -> str:
    """Links that leave docs/ for what the site has as a page of its own."""
    return markdown.replace("](../models/machines/README.md)", "](rigs.md)")
