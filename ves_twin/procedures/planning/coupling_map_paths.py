"""CouplingMapPaths: the same move along a planned, a straight and a bad path, zero-g and rig."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.path_motion import path_lengths
from ves_twin.mechanics.planning.base_motion import base_motion
from ves_twin.mechanics.planning.chain import SerialChain
from ves_twin.mechanics.planning.coupling import coupling_length
from ves_twin.mechanics.planning.flexible_base import strain_energy
from ves_twin.mechanics.planning.hot_spot import hot_spot_path
from ves_twin.mechanics.planning.timed_path import evenly, rounded, timed_path
from ves_twin.plant.plant import Plant
from ves_twin.plant.puma_chain import puma_chain
from ves_twin.procedures.number_table import write_table
from ves_twin.procedures.planning.paths_on_rig import PathsOnRig
from ves_twin.procedures.planning.rig_energy import RigOptions
from ves_twin.procedures.procedure import Procedure, Progress, Result, RunContext
from ves_twin.scenario.fields import Joints, Seconds
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.zero_gravity import zero_gravity_motion

CYCLE = 1.0 / 80.0
"""Time between two commands to the joints [s]. Source: the beam models' rate, thesis App. E."""

PATHS = ("good", "straight", "bad")


@dataclass(frozen=True)
class PathRun:
    """One way from start to end.

    Attributes:
        commands: one a cycle (m, 3) [rad].
        length: in joint space [rad].
        coupling: darkness crossed, the integral of sqrt(dq' Q dq).
        energy: strain energy of the base in the nonlinear zero-g reference [J] (m,).
        energy_linear: by the linear base under joints that follow exactly [J] (m,).
    """

    commands: FloatArray
    length: float
    coupling: float
    energy: FloatArray
    energy_linear: FloatArray


class CouplingMapPaths(Procedure):
    """Plan on the coupling map, then run the plan against other ways between the same ends.

    `corners` are the places near which the bad path turns; it is rounded like the planned one, so
    that no jump of a joint rate speaks against it. `low` and `high` bound the planned path.
    `on_rig` runs all paths on the rig too, with the Model Method and without compensation.
    """

    emulated: str
    start: Joints
    end: Joints
    corners: Annotated[tuple[Joints, ...], Field(min_length=1)]
    low: Joints
    high: Joints
    cells: Annotated[int, Field(ge=2, le=200)] = 40
    straightness: Annotated[float, Field(ge=0)] = 0.1
    duration: Annotated[Seconds, Field(gt=0)]
    rest: Annotated[Seconds, Field(ge=0)]
    on_rig: bool = True
    rig: RigOptions = RigOptions()

    def paths(self, chain: SerialChain, base: EmulatedSystem) -> dict[str, FloatArray]:
        """The three ways by name, evenly spaced (k, 3)."""
        start, end = np.array(self.start), np.array(self.end)
        good = hot_spot_path(
            chain,
            base,
            start,
            end,
            np.array(self.low),
            np.array(self.high),
            self.cells,
            self.straightness,
        )
        straight = evenly(np.array([start, end]), len(good))
        bad = rounded(np.array([start, *map(np.array, self.corners), end]))
        return dict(zip(PATHS, (good, straight, bad), strict=True))

    def runs(self, plant: Plant) -> dict[str, PathRun]:
        """Every path planned, timed and run in zero gravity with the plant's own servo."""
        chain, base = puma_chain(plant), EmulatedSystem.load(self.emulated)
        found = {}
        for name, path in self.paths(chain, base).items():
            commands = timed_path(path, self.duration, CYCLE, self.rest)
            motion = zero_gravity_motion(plant, base, commands, CYCLE)
            found[name] = PathRun(
                commands=commands,
                length=float(path_lengths(path)[-1]),
                coupling=coupling_length(chain, base, path),
                energy=strain_energy(base, motion.pose),
                energy_linear=strain_energy(base, base_motion(chain, base, commands, CYCLE)),
            )
        return found

    def rig_runs(
        self,
        plant: Plant,
        seed: int | None = None,
        progress: Progress = lambda share, what: None,
        bare: Collection[str] = PATHS,
    ) -> PathsOnRig:
        """Every path on the rig with the Model Method; those of `bare` without it too."""
        paths = self.paths(puma_chain(plant), EmulatedSystem.load(self.emulated))
        times = (self.duration, self.rest)
        return PathsOnRig.run(self.rig, plant, seed, self.emulated, paths, times, bare, progress)

    def carry_out(self, conduct: RunContext) -> Result:
        """Run the paths; write `paths.csv` and `paths_on_rig.csv` with energies over time.

        Raises:
            VesTwinError: a base or a path that cannot be.
        """
        conduct.progress(0.0, "paths in zero gravity")
        plant = conduct.plant or Plant.load(self.plant)
        runs = self.runs(plant)
        count = len(runs["good"].energy)
        columns: dict[str, FloatArray] = {"t [s]": CYCLE * np.arange(count, dtype=float)}
        for name, run in runs.items():
            for j in range(3):
                columns[f"{name}.q.{j + 1} [rad]"] = run.commands[:, j]
            columns[f"{name}.energy [J]"] = run.energy
        rig = self.rig_runs(plant, conduct.seed, conduct.progress) if self.on_rig else None
        write_table(conduct.folder / "paths.csv", columns)
        values: dict[str, JsonValue] = {"zero_g": path_figures(runs)}
        lines = _lines(runs)
        if rig is not None:
            rig.write(conduct.folder)
            values |= rig.figures(peak_ratio(runs))
            lines += rig.lines()
        conduct.progress(1.0, "written")
        return Result(Outcome.COMPLETED, values, lines)


def peak_ratio(runs: dict[str, PathRun]) -> float:
    """Peak energy of the good path over that of the bad one, in zero gravity."""
    return float(runs["good"].energy.max() / runs["bad"].energy.max())


def path_figures(runs: dict[str, PathRun]) -> dict[str, JsonValue]:
    """Numbers of the three paths, and the ratios of their peak energies."""
    peaks = {name: float(run.energy.max()) for name, run in runs.items()}
    values: dict[str, JsonValue] = {}
    for name, run in runs.items():
        values[name] = {
            "peak_energy": peaks[name],
            "peak_energy_linear": float(run.energy_linear.max()),
            "mean_energy": float(run.energy.mean()),
            "joint_length": run.length,
            "coupling_length": run.coupling,
        }
    values["good_over_bad"] = peak_ratio(runs)
    values["good_over_straight"] = peaks["good"] / peaks["straight"]
    return values


def _lines(runs: dict[str, PathRun]) -> tuple[str, ...]:
    head = "  path        peak energy   linear   joint length   coupling crossed"
    rows = [
        f"  {name:<10} {run.energy.max():9.4f} J {run.energy_linear.max():9.4f} J"
        f" {np.degrees(run.length):9.1f} deg {run.coupling:12.3f}"
        for name, run in runs.items()
    ]
    return (head, *rows, "", f"  good over bad, peak energy: {peak_ratio(runs):.3f}")
