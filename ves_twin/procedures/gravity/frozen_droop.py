"""FrozenDroop: what a calibration reaches on a frozen platform, and what hides a tilted base."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import write_whole
from ves_twin.mechanics.gravity.interleaved_split import Pass, alternate
from ves_twin.mechanics.gravity.observations import Observations
from ves_twin.mechanics.gravity.sensitivity import AXES
from ves_twin.plant.droop import frozen_droop
from ves_twin.procedures.gravity.held_poses import HeldPosesProcedure
from ves_twin.procedures.procedure import Result, RunContext, part_of
from ves_twin.scenario.fields import Seconds, si
from ves_twin.simulator.build import belief_of
from ves_twin.simulator.outcome import Outcome

CONDITIONS = ("position control", "frozen", "tilted base", "same, no turn")


class FrozenDroop(HeldPosesProcedure):
    """Thesis 3.4.5: the same joint angles and passes under four conditions.

    Position control: the platform is where its legs say. Frozen: no command to the valves for
    `frozen` seconds; the load, what leaks through the valves' null, and spools that came to rest
    within `null_sd` of full opening let it sink and tilt, while it is taken to be where it was
    frozen. Tilted base: position control on a base off the level by `level` about X, unknown to
    the computers; once with the poses as they are, once without their turn about Z. The thesis
    does not say why its platform moved; the cause and its size are assumed.
    """

    frozen: Annotated[Seconds, Field(gt=0, le=1000)] = 5.0
    null_sd: Annotated[float, Field(ge=0, le=0.1)] = 0.0008
    level: Annotated[float, si("rad"), Field(ge=0, le=0.05)] = 0.008726646259971648
    passes: Annotated[int, Field(ge=1, le=50)] = 5

    def carry_out(self, conduct: RunContext) -> Result:
        """Hold, alternate, write `passes.csv`; the account compares the conditions."""
        plant, seed = self.world(conduct)
        belief = belief_of(self.scenario)
        poses, q = self.poses.choose(belief, plant.parameters.array("sensor.range"), seed)
        spool = self.null_sd * np.random.default_rng(seed).normal(size=(len(q), 6))
        drooped = np.array(
            [frozen_droop(plant, *row, self.frozen) for row in zip(poses, q, spool, strict=True)]
        )
        tilted = plant.with_values({"platform.level": [self.level, 0.0]})
        unturned = poses * [1.0, 1.0, 1.0, 1.0, 1.0, 0.0]
        worlds = ((plant, poses), (plant, drooped), (tilted, poses), (tilted, unturned))
        fitted: dict[str, tuple[Pass, ...]] = {}
        for k, (name, (world, true)) in enumerate(zip(CONDITIONS, worlds, strict=True)):
            seen = self.read(world, true, q, seed, part_of(conduct.progress, k, len(worlds)))
            taken = poses[:, 3:] if name == "frozen" else seen.angles
            seen = Observations.unloaded(seen.q, taken, seen.signal)
            basis, position = belief.gravity.basis, belief.sensor_position
            fitted[name] = alternate(seen, basis, position, belief.gravity.gravity, self.passes)
        droop = drooped - poses
        _write_passes(fitted, conduct)
        return _account(fitted, droop, self.level)


def _write_passes(fitted: dict[str, tuple[Pass, ...]], conduct: RunContext) -> None:
    lines = ["condition,pass," + ",".join(f"rms_{axis}" for axis in AXES)]
    for name, passes in fitted.items():
        for number, one in enumerate(passes, 1):
            lines.append(f"{name},{number}," + ",".join(f"{v:.6g}" for v in one.rms))
    write_whole(conduct.folder / "passes.csv", "\n".join(lines) + "\n")


def _account(fitted: dict[str, tuple[Pass, ...]], droop: FloatArray, level: float) -> Result:
    angles = np.degrees(droop[:, 3:])
    worst, usual = float(np.max(np.abs(angles))), float(np.sqrt(np.mean(angles**2)))
    lines = [
        f"  frozen: angles off by up to {worst:.2f} deg, rms {usual:.2f} deg, different at each"
        f" pose; sunk by up to {-1e3 * np.min(droop[:, 2]):.1f} mm",
        f"  tilted base: off by {np.degrees(level):.2f} deg about X at every pose",
        "",
        f"  {'error after the passes':<28}" + "".join(f"{axis:>9}" for axis in AXES),
    ]
    values: dict[str, JsonValue] = {"droop_max_deg": worst, "droop_rms_deg": usual}
    for name, passes in fitted.items():
        rms, peak = passes[-1].rms, np.max(np.abs(passes[-1].error), axis=0)
        lines.append(f"  {name + ', rms':<28}" + "".join(f"{v:9.3f}" for v in rms))
        lines.append(f"  {'  peak':<28}" + "".join(f"{v:9.3f}" for v in peak))
        values[name.replace(" ", "_")] = {
            "rms": rms.tolist(),
            "peak": peak.tolist(),
            "rms_of_passes": [one.rms.tolist() for one in passes],
            "total_mass": passes[-1].model.total_mass,
            "moments": passes[-1].model.moments.tolist(),
        }
    lines += ["", *_hiding(fitted, values)]
    return Result(Outcome.COMPLETED, values, tuple(lines))


def _hiding(fitted: dict[str, tuple[Pass, ...]], values: dict[str, JsonValue]) -> list[str]:
    """How much of the tilt C and its constant took in, at the arm's weight."""
    level, tilted = fitted["position control"][-1], fitted["same, no turn"][-1]
    weight = np.array([0.0, 0.0, level.model.total_mass * level.model.gravity, 0.0, 0.0, 0.0])
    moved = (tilted.calibration - level.calibration) @ weight + tilted.constant - level.constant
    values["tilt_taken_in_by_C"] = moved.tolist()
    text = ", ".join(f"{v:.2f}" for v in moved[:3])
    return [f"  without turn C and its constant take in {text} N (Fx, Fy, Fz) of the tilt"]
