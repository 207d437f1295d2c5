"""TARGETS: what reads a file of a user, a good file for each, and what is done with what it reads."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import ves_twin as vt
from ves_twin.core.recording.files import load_recording, save_recording
from ves_twin.core.recording.stream import RecordingStream
from ves_twin.core.resources import resource_folder
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.import_log import import_log
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.machines.machine import Machine
from ves_twin.machines.tolerance import Tolerance
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.gravity.calibration import GravityCalibration
from ves_twin.mechanics.gravity.learned import LearnedGravity
from ves_twin.procedures.registry import load_procedure
from ves_twin.scenario.experiment import Experiment
from ves_twin.scenario.load import parse_setting
from ves_twin.scenario.operator import operator_motion
from ves_twin.sweeps.ledger import Ledger
from ves_twin.sweeps.plan import SweepPlan, plan_sweep
from ves_twin.sweeps.result import PointResult

SHORT = {
    "run.duration": 0.03, "run.settle": 0.03, "run.log": "admittance", "run.substeps": 1,
    "platform.rate": 80.0,
}  # fmt: skip
"""What makes any scenario a few milliseconds long."""


@dataclass(frozen=True)
class Target:
    """One kind of file.

    Attributes:
        name: of the kind, with the suffix that files of it have.
        share: its part of all mutations.
        good: files that are harmed, as bytes.
        read: reads a file, and uses what it holds as a command would.
        text: whether it is text.
        run: runs what the file describes, where that can be done in some milliseconds.
    """

    name: str
    share: float
    good: Callable[[], list[bytes]]
    read: Callable[[Path], object]
    text: bool = True
    run: Callable[[Path], object] | None = None


def _shipped(folder: str, pattern: str = "*.toml") -> list[bytes]:
    return [path.read_bytes() for path in sorted(resource_folder(folder).glob(pattern))]


def _read_scenario(path: Path) -> object:
    procedure = load_procedure(str(path))
    return procedure if procedure is not None else vt.Scenario.load(str(path))


def _run_scenario(path: Path) -> object:
    if load_procedure(str(path)) is not None:
        return None
    return vt.simulate(vt.Scenario.load(str(path), SHORT))


def _plants() -> list[bytes]:
    overlay = (
        b'schema = 1\nname = "rig"\nbase = "ves2"\nfidelity = "full"\n\n[parameters]\n'
        b'"leg.rod_mass" = "2700 g"\n"sensor.noise" = [0.5, 0.5, 0.5, 0.05, 0.05, 0.05]\n\n'
        b'[effects.valve_null."leg.3"]\nnull = 0.01\n[effects.payload_mass."arm.tool"]\nmass = 1.0\n'
    )
    return [overlay, overlay, *_shipped("models")]


def _read_plant(path: Path) -> object:
    plant = vt.Plant.load(str(path))
    return plant.hash, plant.changes(), plant.gravity_model


def _run_plant(path: Path) -> object:
    return vt.simulate(vt.Scenario.load("position_sine", SHORT), vt.Plant.load(str(path)))


@cache
def _short_run() -> vt.Recording:
    return vt.simulate(vt.Scenario.load("beam_horizontal_truth", {**SHORT, "run.duration": 0.5}))


def _parquet() -> list[bytes]:
    return [
        _written(
            lambda folder: save_recording(_short_run(), folder / "good.parquet"), "good.parquet"
        )
    ]


def _stream() -> list[bytes]:
    def write(folder: Path) -> None:
        run = _short_run()
        with RecordingStream(folder, tuple(run.signals), run.info) as stream:
            for rows in (slice(0, 20), slice(20, 40)):
                stream.write(run.time[rows], {n: v[rows] for n, v in run.signals.items()})

    return [_written(write, "recording.arrows")]


def _settings() -> list[bytes]:
    """The JSON in a recording's metadata, harmed inside a whole file."""
    return [json.dumps(_short_run().info.to_dict()).encode()]


def _with_settings(path: Path) -> object:
    run = _short_run()
    table = pa.table({"t": run.time}).replace_schema_metadata({b"ves_twin": path.read_bytes()})
    pq.write_table(table, path)
    recording = load_recording(path)
    return Experiment().scenario_of(recording)


def _written(write: Callable[[Path], None], name: str) -> bytes:
    with TemporaryDirectory() as folder:
        write(Path(folder))
        return (Path(folder) / name).read_bytes()


def _operator() -> list[bytes]:
    return _shipped("scenarios/data", "*.csv")


EXPERIMENT = b"""scenario = "position_sine"
drive = ["leg.command", "arm.command"]
compare = ["leg.length"]
payload = "500 g"

[settings]
"legs.gain" = 14.0

[start]
state = "given"
pose = [0, 0, "1 mm", 0, 0, 0]
joints = ["90 deg", 0, 0]

[window]
start = 1.0
stop = 5.0
"""

TOLERANCE = b"""schema = 1
[rms]
"leg.length" = 0.001
"sensor.wrench" = "5 N"
[peak]
"leg.length.3" = "2 mm"
"""

MAP = b"""schema = 1
rate = "50 Hz"
gaps = "hold"

[clock]
column = "t [s]"
repeats = "last"
backward = "drop"

[clocks.plc]
column = "plc"
unit = "ms"
offset = "estimate"
own = "seen [mm]"
main = "L1 [mm]"
search = 1.0
keep = "hypothesis"

[[channel]]
from = "L1 [mm]"
to = "leg.length.1"
scale = 0.5
offset = 500.0
sign = -1
way = "filter"

[[channel]]
from = "seen [mm]"
to = "leg.length.2"
clock = "plc"
way = "linear"

[[channel]]
from = "i [mA]"
to = "motor.current.2"

[[channel]]
from = "v1"
to = "tool.speed.1"
unit = "mm/s"
frame = "tool"

[[channel]]
from = "v2"
to = "tool.speed.2"
unit = "mm/s"
frame = "tool"

[[channel]]
from = "v3"
to = "tool.speed.3"
unit = "mm/s"
frame = "tool"

[signals."motor.current"]
unit = "A"
role = "measurement"
axes = ["a", "b"]
meaning = "drive"

[signals."tool.speed"]
unit = ["m/s", "m/s", "m/s"]
frame = "tool"

[frames.tool]
axes = ["-y", "x", "z"]

[window]
start = 0.1
stop = "2 s"
"""


LAB = TemporaryDirectory()
"""Gone with the process."""


@cache
def _lab() -> Path:
    """A lab file that the map fits; two recorders, the second with a clock in ms."""
    t = np.arange(300) * 0.01
    seen = np.sin(3.0 * t) + 0.3 * np.sin(7.0 * t)
    columns = {"t [s]": t, "plc": 1e3 * t + 250.0, "L1 [mm]": 1e3 + seen, "seen [mm]": seen}
    columns |= {"i [mA]": 100.0 * t, "v1": t, "v2": -t, "v3": 0.0 * t}
    path = Path(LAB.name) / "lab.csv"
    rows = (",".join(f"{v:.9g}" for v in row) for row in np.column_stack(list(columns.values())))
    path.write_text("\n".join([",".join(columns), *rows]) + "\n")
    return path


def _read_map(path: Path) -> object:
    return import_log(open_log(_lab()), ImportMap.load(path)).account.to_text()


VARIES = b"""legs.gain=8,12.5
legs.gain=8..20:5
arm.start=[0,0,0],[0.1,0,0]
effects.valve_null.leg.3.null=0,0.01
parameters.leg.rod_mass=2.5,2.6
"""


SETS = b"""legs.gain=8
arm.start=[0, "90 deg", 0]
effects.valve_null.leg.3.null=0.01
parameters.leg.rod_mass=2600 g
operation.begin=run
"""


def _vary(path: Path) -> object:
    lines = path.read_bytes().decode(errors="replace").split("\n")
    return [plan_sweep("position_sine", [line]) for line in lines if line]


def _set(path: Path) -> object:
    lines = path.read_bytes().decode(errors="replace").split("\n")
    for line in filter(None, lines):
        vt.Scenario.load("position_sine", dict([parse_setting(line)]))
    return None


@cache
def _plan() -> SweepPlan:
    return plan_sweep("position_sine", ["seed=0..9:10"])


def _ledger_files() -> list[bytes]:
    done = PointResult(number=3, run_id=_plan().points[3].run_id, outcome="completed", duration=1.0)
    row = done.model_dump_json() + "\n"
    return [row.encode() * 2, json.dumps(_plan().identity).encode()]


def _read_ledger(path: Path) -> object:
    folder = path.parent / f"{path.name}-sweep"
    folder.mkdir(exist_ok=True)
    content = path.read_bytes()
    rows = b'"outcome"' in content
    identity = json.dumps(_plan().identity).encode() if rows else content
    (folder / "sweep.json").write_bytes(identity)
    (folder / "rows.jsonl").write_bytes(content if rows else b"")
    with Ledger(folder, _plan()) as ledger:
        return ledger.results


def _tolerance(path: Path) -> Tolerance:
    return Tolerance.load(path, Machine.load("ves2").signals)


TARGETS = (
    Target("scenario.toml", 0.22, lambda: _shipped("scenarios"), _read_scenario, run=_run_scenario),
    Target("plant.toml", 0.16, _plants, _read_plant, run=_run_plant),
    Target("emulated.toml", 0.08, lambda: _shipped("models/emulated"), lambda p: EmulatedSystem.load(str(p))),
    Target("calibration.toml", 0.05, lambda: _shipped("models/gravity"), lambda p: GravityCalibration.load(str(p))),
    Target("experiment.toml", 0.05, lambda: [EXPERIMENT], Experiment.load),
    Target("map.toml", 0.08, lambda: [MAP], _read_map),
    Target("tolerance.toml", 0.04, lambda: [TOLERANCE], _tolerance),
    Target("operator.csv", 0.03, _operator, lambda p: operator_motion(str(p), np.zeros(3))),
    Target("set.txt", 0.06, lambda: [SETS], _set),
    Target("vary.txt", 0.04, lambda: [VARIES], _vary),
    Target("rows.jsonl", 0.04, _ledger_files, _read_ledger),
    Target("settings.json", 0.05, _settings, _with_settings),
    Target("recording.parquet", 0.04, _parquet, load_recording, text=False),
    Target("recording.arrows", 0.03, _stream, load_recording, text=False),
    Target("learned.parquet", 0.03, _parquet, lambda p: LearnedGravity.load(str(p)), text=False),
)  # fmt: skip
