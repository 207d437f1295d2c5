"""KINDS: what an attack brings, how inputs of each kind are drawn, and what a user does with them."""

from __future__ import annotations

import json
import random
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "fuzz"))

from grammar import toml_text
from lab import LAB
from mutate import mutate_bytes, mutate_text
from targets import TARGETS, Target

from ves_twin.core.resources import resource_folder
from ves_twin.data.draft_map import draft_map
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.import_log import import_log
from ves_twin.data.inspect_log import TableReport, inspect_log
from ves_twin.data.inspection_text import inspection_text
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.envs.rig_set import RigSet
from ves_twin.machines.mjcf.recordings.experiment import MjcfExperiment
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.scenario.setpoint_file import read_setpoints
from ves_twin.suites.answers import read_answers
from ves_twin.suites.suite import load_suite
from ves_twin.thesis.claim import load_claims


@dataclass(frozen=True)
class Kind:
    """One kind of input.

    Attributes:
        name: of the file, with the suffix that files of it have.
        share: its part of all inputs.
        draw: bytes of an input, the same for the same state of chance.
        use: what a user does with the file.
    """

    name: str
    share: float
    draw: Callable[[random.Random], bytes]
    use: Callable[[Path], object]


def _text(good: Callable[[], list[bytes]], grammar: bool) -> Callable[[random.Random], bytes]:
    """Half of them harmed copies of good files, half drawn from the grammar of TOML."""

    def draw(chance: random.Random) -> bytes:
        files = good()
        if grammar and chance.random() < 0.5:
            return toml_text(files, chance)
        text = chance.choice(files).decode()
        return mutate_text(text, str(chance.random()), chance.choice((1, 1, 2, 5)))

    return draw


def _bytes(good: Callable[[random.Random], bytes]) -> Callable[[random.Random], bytes]:
    """Half of them whole, half harmed."""

    def draw(chance: random.Random) -> bytes:
        content = good(chance)
        return content if chance.random() < 0.5 else mutate_bytes(content, str(chance.random()))

    return draw


def _look(path: Path) -> object:
    """Inspect, draft a map, and import by one that takes every column it can."""
    inspection = inspect_log(open_log(path))
    inspection_text(inspection)
    draft_map(inspection)
    content = [table for table in inspection.tables if table.clock is not None and table.channels]
    if not content:
        return None
    told = path.with_name(f"{path.name}.toml")
    told.write_text(_map(max(content, key=lambda table: table.rows)), encoding="utf-8")
    try:
        imported = import_log(open_log(path), ImportMap.load(str(told)))
    finally:
        told.unlink()
    return imported.account.to_text()


def _map(table: TableReport) -> str:
    clock = json.dumps(table.clock.column if table.clock else "")
    lines = [f'schema = 1\n[clock]\ncolumn = {clock}\nunit = "s"\nbackward = "sort"']
    numbers = [channel for channel in table.channels if channel.low is not None]
    for place, channel in enumerate(numbers[:6], 1):
        name = json.dumps(channel.name)
        lines.append(f'[[channel]]\nfrom = {name}\nto = "leg.length.{place}"\nunit = "m"')
    return "\n".join(lines) + "\n"


def _of_target(target: Target) -> Kind:
    """A kind of the fuzz; one read in eight is also run, where that can be done."""
    if not target.text:
        return Kind(target.name, target.share, _bytes(lambda chance: chance.choice(target.good())),
                    target.read)  # fmt: skip

    def use(path: Path) -> object:
        found = target.read(path)
        if target.run is not None and path.stat().st_size % 8 == 0:
            return target.run(path)
        return found

    grammar = target.name.endswith(".toml")
    return Kind(target.name, target.share, _text(target.good, grammar), use)


def _files(folder: str, pattern: str) -> Callable[[], list[bytes]]:
    return lambda: [path.read_bytes() for path in sorted(resource_folder(folder).glob(pattern))]


def _machine(path: Path) -> object:
    """A rig of two files: beside the models it may name."""
    for xml in resource_folder("models/machines").glob("*/*.xml"):
        shutil.copy(xml, path.parent)
    try:
        return Rig.load(str(path)).model.nq
    finally:
        for xml in path.parent.glob("*.xml"):
            xml.unlink()


def _model(path: Path) -> object:
    """The MJCF model of a rig whose file is in order."""
    rig = path.with_name("rig.toml")
    text = (resource_folder("models/machines") / "emps" / "emps.toml").read_text(encoding="utf-8")
    rig.write_text(text.replace("emps.xml", path.name), encoding="utf-8")
    try:
        return Rig.load(str(rig)).model.nq
    finally:
        rig.unlink()


def _suite(path: Path) -> object:
    folder = path.with_name("suite")
    folder.mkdir()
    try:
        shutil.copy(path, folder / "suite.json")
        return load_suite(folder)
    finally:
        shutil.rmtree(folder)


RIG_EXPERIMENT = b"""plant = "emps"
drive = ["motor.force"]
compare = ["slide.position"]
noise = "declared"
[parameters]
"friction" = 1.0
[start]
state = "estimated"
forget = "0.5 s"
[window]
start = 1.0
stop = "5 s"
[recordings.a]
payload = { body = "cart", mass = 1.0 }
"""

SUITE = b"""{"schema": 1, "bench": "pendulum", "cases": ["case-0001"], "commissioned": 2,
"excluded": {"case-0001": ["joint.friction"]}, "baseline": false}
"""
ANSWERS = b"""{"case-0001": {"verdict": "named", "causes": ["effect@target"]}}
"""
SETPOINTS = ("t,leg.command.1,leg.command.2,leg.command.3,leg.command.4,leg.command.5,leg.command.6,"
             "arm.command.1,arm.command.2,arm.command.3\n"
             + "".join(f"{0.01 * i:.2f},1,1,1,1,1,1,0.1,0,0\n" for i in range(20))).encode()  # fmt: skip

OWN = (
    Kind("rig.toml", 0.06, _text(_files("models/machines", "*/*.toml"), True), _machine),
    Kind("model.xml", 0.03, _text(_files("models/machines", "emps/emps.xml"), False), _model),
    Kind("rig_experiment.toml", 0.04, _text(lambda: [RIG_EXPERIMENT], True), MjcfExperiment.load),
    Kind("set.toml", 0.03, _text(_files("models/rig_sets", "*.toml"), True),
         lambda p: RigSet.load(str(p))),
    Kind("claims.toml", 0.02, _text(_files("models/thesis", "claims.toml"), True),
         lambda p: load_claims(str(p))),
    Kind("setpoints.csv", 0.03, _text(lambda: [SETPOINTS], False), lambda p: read_setpoints(str(p))),
    Kind("suite.json", 0.02, _text(lambda: [SUITE], False), _suite),
    Kind("answers.json", 0.02, _text(lambda: [ANSWERS], False), read_answers),
)  # fmt: skip

KINDS = (
    *(_of_target(target) for target in TARGETS),
    *OWN,
    *(Kind(name, 0.1, _bytes(draw), _look) for name, draw in LAB.items()),
)
"""Every reader of a user's files and every kind of TOML; shares are scaled to one."""
