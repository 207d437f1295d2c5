"""DroopShowcase: why a calibration of 47 poses stalls, found from its own readings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.core.recording.files import load_recording, save_recording
from ves_twin.core.recording.recording import POSES, Recording, RecordingInfo
from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import write_whole
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.machines.static_poses import StaticPoses, tilt_name
from ves_twin.mechanics.gravity.interleaved_split import alternate
from ves_twin.mechanics.gravity.observations import Observations
from ves_twin.mechanics.gravity.sensitivity import AXES
from ves_twin.plant.droop import frozen_droop
from ves_twin.plant.plant import Plant
from ves_twin.procedures.gravity.held_poses import HeldPosesProcedure
from ves_twin.procedures.procedure import Result, RunContext
from ves_twin.report.diagnosis.answer import headline
from ves_twin.report.diagnosis.page import diagnosis_page
from ves_twin.report.page import write_page
from ves_twin.scenario.fields import Seconds
from ves_twin.simulator.build import belief_of
from ves_twin.simulator.outcome import Outcome

TABLE_3_1 = (0.46, 0.24, 0.46, 0.62, 1.01, 0.06)
"""Printed rms of the gravity error [N, N m]. Source: thesis Table 3-1."""

FILE = "recording.parquet"


class DroopShowcase(HeldPosesProcedure):
    """Thesis 3.4.5: the platform is frozen while it is read, and taken to be where it was frozen.

    As in `frozen_droop` it sinks and tilts, by another angle at each pose. The diagnosis gets the
    readings, the joint angles and the poses that were meant; payload, gains, cross-talk and zero
    are open as far as weighing, drawings and the sensor's sheet leave them.
    """

    frozen: Annotated[Seconds, Field(ge=0, le=1000)] = 5.0
    null_sd: Annotated[float, Field(ge=0, le=0.1)] = 0.0008
    passes: Annotated[int, Field(ge=1, le=50)] = 5
    nulls: Annotated[int, Field(ge=12, le=10000)] = 60

    def carry_out(self, conduct: RunContext) -> Result:
        """Read, diagnose, calibrate with the angles as taken and as found; write the files."""
        plant, seed = self.world(conduct)
        belief = belief_of(self.scenario)
        poses, q = self.poses.choose(belief, plant.parameters.array("sensor.range"), seed)
        true = self._drooped(plant, poses, q, seed)
        seen = self.read(plant, true, q, seed, conduct.progress)
        _save(seen, poses, conduct)
        rig = StaticPoses(Plant.load(self.belief), len(poses), self.average)
        verdict = diagnose(
            rig,
            [load_recording(conduct.folder / FILE)],
            settings=Settings(nulls=self.nulls),
            progress=conduct.progress,
        )
        verdict.save(conduct.folder / "verdict.json")
        page = diagnosis_page(verdict, f"{self.name}: {self.question}")
        write_page(conduct.folder / "report.html", page)
        found = tilts_of(verdict, len(poses))
        _write_tilts(found, true - poses, conduct)
        angles = (poses[:, 3:], poses[:, 3:] + found, true[:, 3:])
        before, after, best = (self._calibrated(seen, a) for a in angles)
        tilts = (found[:, :2], (true - poses)[:, 3:5])
        return _account(verdict, Levels(before, after, best, *tilts))

    def _drooped(self, plant: Plant, poses: FloatArray, q: FloatArray, seed: int) -> FloatArray:
        """Where the platform really is at each pose (n, 6)."""
        if self.frozen == 0.0:
            return poses
        spool = self.null_sd * np.random.default_rng(seed).normal(size=(len(q), 6))
        rows = zip(poses, q, spool, strict=True)
        return np.array([frozen_droop(plant, *row, self.frozen) for row in rows])

    def _calibrated(self, seen: Observations, angles: FloatArray) -> FloatArray:
        """Rms [N, N m] (6,) that the thesis's alternation leaves with these angles."""
        belief = belief_of(self.scenario)
        rows = Observations.unloaded(seen.q, angles, seen.signal)
        basis, position = belief.gravity.basis, belief.sensor_position
        return alternate(rows, basis, position, belief.gravity.gravity, self.passes)[-1].rms


@dataclass(frozen=True)
class Levels:
    """What the finding is worth.

    Attributes:
        before, after, best: rms of the wrench error [N, N m] (6,) with the angles as taken, as
            found, as they were.
        found, true: tilts about x and y of each pose [rad] (n, 2).
    """

    before: FloatArray
    after: FloatArray
    best: FloatArray
    found: FloatArray
    true: FloatArray


def tilts_of(verdict: Verdict, count: int) -> FloatArray:
    """Orientation errors that a verdict names [rad] (n, 3); zeros where it names none."""
    sizes = {name: p.value for cause in verdict.causes for name, p in cause.parameters.items()}
    base = [sizes.get("base.x", 0.0), sizes.get("base.y", 0.0), 0.0]
    rows = [[sizes.get(tilt_name(k + 1, a), 0.0) for a in "xy"] + [0.0] for k in range(count)]
    return np.asarray(np.array(rows) + base)


def _save(seen: Observations, poses: FloatArray, conduct: RunContext) -> None:
    signals = {"platform.pose": poses, "arm.q": seen.q, "sensor.wrench": seen.signal}
    info = RecordingInfo("measured", scenario="held poses", log=POSES)
    recording = Recording(np.arange(len(poses), dtype=float), signals, info)
    save_recording(recording, conduct.folder / FILE)


def _write_tilts(found: FloatArray, droop: FloatArray, conduct: RunContext) -> None:
    lines = ["pose,found_x,found_y,true_x,true_y"]
    for k, (here, there) in enumerate(zip(found, droop[:, 3:], strict=True), 1):
        values = (here[0], here[1], there[0], there[1])
        lines.append(f"{k}," + ",".join(f"{value:.6g}" for value in values))
    write_whole(conduct.folder / "tilts.csv", "\n".join(lines) + "\n")


def _account(verdict: Verdict, levels: Levels) -> Result:
    off = levels.found - levels.true
    common = off.mean(axis=0)  # the same at every pose: gains and zero hide it
    hidden, missed = _mrad(levels.true), _mrad(off - common)
    rows = {
        "angles as they were taken": levels.before,
        "angles as they were found": levels.after,
        "angles as they were": levels.best,
        "printed, Table 3-1": np.array(TABLE_3_1),
    }
    lines = [
        f"  hidden    orientation off by {hidden:.2f} mrad rms, by another angle at each pose",
        f"  said      {headline(verdict)}",
        f"  found     to {missed:.2f} mrad rms, but for {_mrad(common):.2f} mrad common to all",
        "",
        f"  {'rms of the wrench error':<28}" + "".join(f"{axis:>9}" for axis in AXES),
        *(f"  {name:<28}" + "".join(f"{v:9.3f}" for v in row) for name, row in rows.items()),
    ]
    values: dict[str, JsonValue] = {
        "verdict": verdict.verdict.value,
        "causes": [f"{cause.effect}@{cause.target}" for cause in verdict.causes],
        "hidden_rms_mrad": hidden,
        "missed_rms_mrad": missed,
        "missed_common_mrad": _mrad(common),
        "wrench_rms_before": levels.before.tolist(),
        "wrench_rms_after": levels.after.tolist(),
        "wrench_rms_of_true_angles": levels.best.tolist(),
    }
    return Result(Outcome.COMPLETED, values, tuple(lines))


def _mrad(tilts: FloatArray) -> float:
    return float(1e3 * np.sqrt(np.mean(tilts**2)))
