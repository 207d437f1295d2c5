"""format_pages: the file formats, each with the schema that the program itself checks by."""

from __future__ import annotations

import json
from dataclasses import MISSING, fields
from typing import Any, get_type_hints

from plant_page import plant_page
from pydantic import TypeAdapter, create_model
from schema_tables import schema_tables

from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.core.signals import SIGNALS
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.machines.mjcf.recordings.experiment import MjcfExperiment
from ves_twin.machines.mjcf.rig.description import KIND, SCHEMA, RigDescription
from ves_twin.procedures.registry import PROCEDURES, procedure_class
from ves_twin.scenario.experiment import Experiment
from ves_twin.scenario.schema import Scenario

_INDEX = """# File formats

What the program reads and writes. Files for people are TOML: unknown keys are refused, with the nearest one named; numbers are SI, or texts with a
unit (`"180 deg"`, `"12 mm"`). Tables and schemas here are generated from the classes that check the files. The JSON schemas serve an editor, too.

| file | what | schema |
|---|---|---|
| [scenario](scenario.md) | one experiment on the rig | [JSON schema](scenario.schema.json) |
| [procedure](procedure.md) | an experiment of many runs with one result | a JSON schema each |
| [plant](plant.md) | every number of a rig, with unit, sd, grade and source | |
| [rig](rig.md) | a machine that is not VES II, beside its MuJoCo model | [JSON schema](rig.schema.json) |
| [import map](import-map.md) | which column of a lab file is which signal | [JSON schema](import-map.schema.json) |
| [experiment](experiment.md) | how a recording of VES II was made | [JSON schema](experiment.schema.json) |
| [rig experiment](rig-experiment.md) | how a recording of another rig was made | [JSON schema](rig-experiment.schema.json) |
| [recording](recording.md) | signals on one clock, with metadata | [JSON schema](recording.schema.json) |
| [verdict](verdict.md) | what a diagnosis says | [JSON schema](verdict.schema.json) |
"""

_SCENARIO = """# Scenario

TOML in `scenarios/`, run by `ves-twin run NAME`, or a file of your own, run by `ves-twin run my_scenario.toml`:

```toml
# Does a heavier platform follow a slow heave?
plant = "ves2_fast"

[parameters]
"platform.mass" = "75 kg"

[run]
duration = 5.0

[platform]
mode = "position"

[platform.motion]
kind = "sine"
amplitude = [0.0, 0.0, "50 mm", 0.0, 0.0, 0.0]
frequency = [0.3, 0.3, 0.3, 0.3, 0.3, 0.3]

[arm]
start = [0.0, "90 deg", 0.0]
```

The first line is a comment: the `question`. The `name` is that of the file. Neither is a key to write, all others are below. A copy of a file in
`scenarios/` is a good beginning; to change a key or two of one, `ves-twin run NAME --set KEY=VALUE` is enough."""

_HEADS = {
    "rig": "# Rig\n\nTOML beside a MuJoCo model; every key in words in [the file of a machine](../machine-file.md). It begins with"
    f' `schema = 1` and `kind = "{KIND}"`, and may name another one as its `base`; the schema is of the rest.',
    "scenario": _SCENARIO,
    "import-map": "# Import map\n\nTOML, read by `ves-twin import --map` and drafted by `ves-twin inspect --draft-map`;"
    " worked example in [measured data](../measured-data.md#map).",
    "experiment": "# Experiment\n\nTOML, read by `ves-twin compare --experiment` and `ves-twin diagnose --experiment`;"
    " see [measured data](../measured-data.md#experiment-file).",
    "rig-experiment": "# Rig experiment\n\nTOML, the `--experiment` of an MJCF machine;"
    " see [measured data](../measured-data.md#experiment-file).",
    "recording": "# Recording\n\n`recording.parquet`: a column `t` [s] and a column for each axis of each signal, as doubles. The metadata are JSON"
    " under the Parquet key `ves_twin`; while a run goes on, the same rows are in `recording.arrows`.",
    "verdict": "# Verdict\n\n`verdict.json`, written by `ves-twin diagnose`. Fields are added without a new `schema` number, never changed.",
}


def format_pages() -> dict[str, str]:
    """Name of a page or schema -> its text."""
    schemas = {
        "scenario": _written(Scenario.model_json_schema()),
        "rig": _with_head(RigDescription.model_json_schema()),
        "import-map": ImportMap.model_json_schema(),
        "experiment": Experiment.model_json_schema(),
        "rig-experiment": MjcfExperiment.model_json_schema(),
        "recording": TypeAdapter(RecordingInfo).json_schema(),
        "verdict": _verdict_schema(),
    }
    pages = {"formats/index.md": _INDEX, "formats/plant.md": plant_page()}
    pages |= _procedures()
    for name, schema in schemas.items():
        extra = _signals() if name == "recording" else ""
        tables = schema_tables(schema)
        link = f"[JSON schema]({name}.schema.json)"
        pages[f"formats/{name}.md"] = f"{_HEADS[name]}\n\n{link}\n\n{tables}\n{extra}"
        pages[f"formats/{name}.schema.json"] = json.dumps(schema, indent=1) + "\n"
    return pages


def _written(schema: dict[str, Any]) -> dict[str, Any]:
    """Without what no file has as a key: its name, and the question that is its first line."""
    told = ("name", "question")
    kept = {key: value for key, value in schema["properties"].items() if key not in told}
    required = [key for key in schema.get("required", []) if key not in told]
    return {**schema, "properties": kept, "required": required}


def _with_head(schema: dict[str, Any]) -> dict[str, Any]:
    """With the keys that a machine's file begins with; with a base nothing else is needed."""
    head = {"schema": {"const": SCHEMA}, "kind": {"const": KIND}, "base": {"type": "string"}}
    needed = schema.pop("required")
    either = [{"required": ["base"]}, {"required": needed}]
    properties = {**head, **schema["properties"]}
    return {**schema, "properties": properties, "required": ["schema", "kind"], "anyOf": either}


def _procedures() -> dict[str, str]:
    text = [
        "# Procedure",
        "",
        'TOML in `scenarios/` with `procedure = "..."`: an experiment of many runs with one result, run by `ves-twin run NAME` like a scenario.',
        "",
    ]
    pages = {}
    for name in PROCEDURES:
        schema = _written(procedure_class(name).model_json_schema())
        text += [f"## {name}", "", f"[JSON schema]({name}.schema.json)", ""]
        text += [schema_tables(schema, level=3, title=False)]
        pages[f"formats/{name}.schema.json"] = json.dumps(schema, indent=1) + "\n"
    return {"formats/procedure.md": "\n".join(text), **pages}


def _verdict_schema() -> dict[str, Any]:
    """Of the fields that verdict.json has; the traces of the report stay out of it."""
    hints = get_type_hints(Verdict)
    kept = {}
    for field in fields(Verdict):
        if field.name in ("exhibit", "schema"):
            continue
        needed = field.default is MISSING and field.default_factory is MISSING
        kept[field.name] = (hints[field.name], ... if needed else None)
    schema = create_model("Verdict", **kept).model_json_schema()
    schema["properties"]["schema"] = {"type": "integer", "const": 1}
    schema["description"] = Verdict.__doc__
    return schema


def _signals() -> str:
    lines = ["## Signals of the rig", "", "| signal | columns | unit | role | frame | meaning |"]
    lines.append("|---|---|---|---|---|---|")
    for s in SIGNALS.values():
        units = ", ".join(dict.fromkeys(s.units))
        lines.append(
            f"| `{s.name}` | {', '.join(s.axes)} | {units} | {s.role} | {s.frame} | {s.meaning} |"
        )
    return "\n".join(lines) + "\n"
