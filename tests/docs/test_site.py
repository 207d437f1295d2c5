"""The site builds without warnings or network, has every page, command, option and key."""

import argparse
import html
import json
import re
import textwrap
import tomllib
from pathlib import Path

import jsonschema
import pytest
import yaml

import ves_twin as vt
from ves_twin.cli.main import build_parser
from ves_twin.diagnosis.verdict.cause import Cause, Estimate
from ves_twin.diagnosis.verdict.verdict import Basis, Kind, Statistics, Verdict
from ves_twin.scenario.schema import Scenario

ROOT = Path(__file__).parents[2]
SCENARIOS = sorted((ROOT / "scenarios").glob("*.toml"))
MACHINES = sorted((ROOT / "models" / "machines").glob("*/*.toml"))
CONFIG = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
GENERATED = ("index.md", "rigs.md", "commands.md", "credibility.md", "formats/", "notebooks/")
LOADED = re.compile(
    r'<(?:script|img|iframe)[^>]*src="(https?:[^"]+)"|<link[^>]*href="(https?:[^"]+)"'
)

pytestmark = pytest.mark.slow  # one build of some 4 s


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


def test_every_command_has_examples_and_each_is_understood(site):
    text = html.unescape((site / "commands.html").read_text(encoding="utf-8"))
    for parser in parsers(build_parser()):
        if any(isinstance(a, argparse._SubParsersAction) for a in parser._actions):
            continue  # what it holds has examples
        section = text.split(f'id="{parser.prog.replace(" ", "-")}"')[1].split("<h2")[0]
        typed = re.sub(r"<[^>]*>", "", section.split("Type for example:")[1].split("</pre>")[0])
        lines = [line for line in typed.splitlines() if line.startswith(f"{parser.prog} ")]
        lines += [line for line in typed.splitlines() if line == parser.prog]
        assert lines, parser.prog
        for line in lines:
            assert build_parser().parse_args(line.split()[1:]).command == line.split()[1]


def test_the_page_of_credibility_counts_what_is_there_and_calls_ves2_not_validated(site):
    text = html.unescape((site / "credibility.html").read_text(encoding="utf-8"))
    plain = re.sub(r"<[^>]*>", "", text)
    assert "VES II: not shown." in plain
    grades = {p.grade for p in vt.Plant.load("ves2").parameters.values()}
    assert len(re.findall(r"<td[^>]*>\d+</td>", text.split("Input pedigree")[-1])) == len(grades)
    assert "A. Janot" in plain
    functions = sum(
        bool(re.match(r"\s*def test_\w", line))
        for path in (ROOT / "tests").rglob("test_*.py")
        for line in path.read_text(encoding="utf-8").splitlines()
    )
    assert f"{functions} test functions" in plain


def parsers(parser):
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for below in action.choices.values():
                yield from parsers(below)


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda p: p.stem)
def test_shipped_files_keep_to_the_schema_of_their_page(site, path):
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    name = content.get("procedure", "scenario")
    schema = json.loads((site / "formats" / f"{name}.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(content, schema)


@pytest.mark.parametrize("path", MACHINES, ids=lambda p: p.stem)
def test_shipped_machines_keep_to_the_schema_as_they_are_written(site, path):
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    jsonschema.validate(content, schema_of(site, "rig"))
    over = {"schema": 1, "kind": "rig", "base": path.name}
    jsonschema.validate(over, schema_of(site, "rig"))
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**over, "sginals": {}}, schema_of(site, "rig"))


def test_the_schema_of_scenarios_refuses_what_the_program_refuses(site):
    schema = json.loads((site / "formats" / "scenario.schema.json").read_text(encoding="utf-8"))
    told = {"name", "question"}  # of the file's name and first line
    good = Scenario.load("position_sine").model_dump_json(exclude_none=True, exclude=told)
    good = json.loads(good)
    jsonschema.validate(good, schema)
    for wrong in ({"platform": {**good["platform"], "home": [0.0] * 5}}, {"unknown": 1}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**good, **wrong}, schema)


def schema_of(site, name):
    return json.loads((site / "formats" / f"{name}.schema.json").read_text(encoding="utf-8"))


def test_what_the_program_writes_keeps_to_the_schemas(site):
    changes = {"run.duration": 0.3, "run.settle": 0.3, "effects.valve_null.leg.3.null": 0.001}
    run = vt.simulate(vt.Scenario.load("position_sine", changes), vt.Plant.load("ves2_fast"))
    jsonschema.validate(json.loads(json.dumps(run.info.to_dict())), schema_of(site, "recording"))
    basis = Basis("measured", "declared", "none")
    sizes = {"leg.3:null": Estimate(0.001, 0.0009, 0.0011, "1", 0.0)}
    cause = Cause("valve_null", "leg.3", sizes, 0.99, True, None)
    verdict = Verdict(Kind.NAMED, basis, Statistics(9.0, 4.0, 2.0, 3.0), (cause,), ((0,),))
    content = json.loads(verdict.to_json())
    jsonschema.validate(content, schema_of(site, "verdict"))
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**content, "verdict": "perhaps"}, schema_of(site, "verdict"))


def test_the_map_of_the_page_on_measured_data_keeps_to_its_schema(site):
    page = (ROOT / "docs" / "measured-data.md").read_text(encoding="utf-8")
    block = page.split("## Map\n\n")[1].split("\n\nEvery wrong key")[0]
    content = tomllib.loads(textwrap.dedent(block))
    jsonschema.validate(content, schema_of(site, "import-map"))
    assert len(content) >= 6


def test_the_example_of_the_page_on_scenarios_is_one(site, tmp_path):
    text = html.unescape((site / "formats" / "scenario.html").read_text(encoding="utf-8"))
    blocks = [re.sub(r"<[^>]+>", "", b) for b in re.findall(r"<code>(.*?)</code>", text, re.DOTALL)]
    (block,) = [b for b in blocks if b.startswith("# Does")]
    path = tmp_path / "my_scenario.toml"
    path.write_text(block)
    scenario = vt.Scenario.load(str(path), {"run.duration": 0.3})
    assert scenario.name == "my_scenario"
    assert scenario.question.startswith("Does a heavier")
    assert vt.simulate(scenario).info.outcome == "completed"


def test_units_with_stars_are_shown_as_they_are(site):
    for page in ("formats/plant.html", "thesis-scorecard.html"):
        text = (site / page).read_text(encoding="utf-8")
        assert not re.search(r"\w<em>[^<]*</em>\w", text), page


def test_the_example_of_the_page_on_python_runs(capsys):
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    exec(compile(code, "python.md", "exec"), {})
    assert capsys.readouterr().out.startswith("completed (")


@pytest.mark.parametrize(
    "name", ["scenario", "rig", "import-map", "experiment", "recording", "verdict"]
)
def test_each_key_of_a_schema_is_on_its_page(site, name):
    schema = json.loads((site / "formats" / f"{name}.schema.json").read_text(encoding="utf-8"))
    text = (site / "formats" / f"{name}.html").read_text(encoding="utf-8")
    parts = [schema, *(p for p in schema.get("$defs", {}).values() if "properties" in p)]
    for key in {key for part in parts for key in part["properties"]}:
        assert f"<code>{key}</code>" in text, key
