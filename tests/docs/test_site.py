"""The site builds without warnings or network, has every page, command, option and key."""

import argparse
import html
import json
import re
import tomllib
from pathlib import Path

import jsonschema
import pytest
import yaml

from ves_twin.cli.main import build_parser
from ves_twin.scenario.schema import Scenario

ROOT = Path(__file__).parents[2]
SCENARIOS = sorted((ROOT / "scenarios").glob("*.toml"))
CONFIG = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
GENERATED = ("index.md", "commands.md", "formats/", "notebooks/")
LOADED = re.compile(
    r'<(?:script|img|iframe)[^>]*src="(https?:[^"]+)"|<link[^>]*href="(https?:[^"]+)"'
)

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("site")]  # one build of some 4 s


def listed(entry):
    """Pages of the navigation, however deep."""
    if isinstance(entry, str):
        return [entry]
    below = entry.values() if isinstance(entry, dict) else entry
    return [page for part in below for page in listed(part)]


def test_the_navigation_lists_every_page():
    pages = listed(yaml.safe_load(CONFIG)["nav"])
    docs = {p.relative_to(ROOT / "docs").as_posix() for p in (ROOT / "docs").rglob("*.md")}
    assert {page for page in pages if not page.startswith(GENERATED)} == docs
    shown = {f"notebooks/{p.stem}.md" for p in (ROOT / "notebooks").glob("*.ipynb")}
    assert {p for p in pages if p.startswith("notebooks/")} == shown | {"notebooks/index.md"}
    assert len(pages) == len(set(pages))


def test_the_site_builds_without_warnings(site):
    """mkdocs ends with an error at a broken link, anchor or page that is not listed."""
    assert (site / "index.html").stat().st_size > 10_000


def test_no_page_loads_anything_from_the_network(site):
    for page in site.rglob("*.html"):
        assert not LOADED.search(page.read_text(encoding="utf-8")), page.name


def test_every_command_and_option_is_on_its_page(site):
    text = html.unescape((site / "commands.html").read_text(encoding="utf-8"))
    seen = 0
    for parser in parsers(build_parser()):
        section = text.split(f'id="{parser.prog.replace(" ", "-")}"')[1].split("<h2")[0]
        options = [name for a in parser._actions for name in a.option_strings]
        for option in set(options) - {"-h", "--help"}:
            assert option in section, f"{parser.prog} {option}"
            seen += 1
    assert seen > 50


def parsers(parser):
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for below in action.choices.values():
                yield from parsers(below)


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda p: p.stem)
def test_shipped_files_keep_to_the_schema_of_their_page(site, path):
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    content = {"name": path.stem, "question": "?", **content}
    name = content.get("procedure", "scenario")
    schema = json.loads((site / "formats" / f"{name}.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(content, schema)


def test_the_schema_of_scenarios_refuses_what_the_program_refuses(site):
    schema = json.loads((site / "formats" / "scenario.schema.json").read_text(encoding="utf-8"))
    good = json.loads(Scenario.load("position_sine").model_dump_json(exclude_none=True))
    jsonschema.validate(good, schema)
    for wrong in ({"platform": {**good["platform"], "home": [0.0] * 5}}, {"unknown": 1}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**good, **wrong}, schema)


@pytest.mark.parametrize("name", ["scenario", "import-map", "experiment", "recording", "verdict"])
def test_each_key_of_a_schema_is_on_its_page(site, name):
    schema = json.loads((site / "formats" / f"{name}.schema.json").read_text(encoding="utf-8"))
    text = (site / "formats" / f"{name}.html").read_text(encoding="utf-8")
    parts = [schema, *(p for p in schema.get("$defs", {}).values() if "properties" in p)]
    for key in {key for part in parts for key in part["properties"]}:
        assert f"<code>{key}</code>" in text, key
