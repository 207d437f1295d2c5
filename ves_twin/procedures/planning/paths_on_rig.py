"""PathsOnRig: the paths of the coupling map on the rig, with the Model Method and without."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import JsonValue

from ves_twin.core.types import FloatArray
from ves_twin.plant.plant import Plant
from ves_twin.procedures.number_table import write_table
from ves_twin.procedures.planning.rig_energy import RigEnergy, RigOptions
from ves_twin.procedures.procedure import Progress


@dataclass(frozen=True)
class PathsOnRig:
    """Runs by name of the path.

    Attributes:
        emulated: gravity compensated by the Model Method.
        uncompensated: with the weight of the first moment tared and nothing else; some of them.
    """

    emulated: dict[str, RigEnergy]
    uncompensated: dict[str, RigEnergy]

    @staticmethod
    def run(
        options: RigOptions,
        plant: Plant,
        seed: int | None,
        emulated: str,
        paths: dict[str, FloatArray],
        times: tuple[float, float],
        bare: Collection[str],
        progress: Progress = lambda share, what: None,
    ) -> PathsOnRig:
        """Every path with compensation, and some without.

        Args:
            options: how the rig is run.
            plant: the world.
            seed: of the noise; None: the options' own.
            emulated: name of the base.
            paths: joint angles by name (k, 3) [rad].
            times: of the motion and of the rest after it [s].
            bare: names of the paths that are run without compensation too.
            progress: called with the share done.
        """
        moving, rest = times
        found, total = PathsOnRig({}, {}), len(paths) + len(bare)
        for compensated, runs in ((True, found.emulated), (False, found.uncompensated)):
            chosen = paths if compensated else {name: paths[name] for name in bare}
            for name, path in chosen.items():
                done = len(found.emulated) + len(found.uncompensated)
                method = "Model Method" if compensated else "no compensation"
                progress(done / total, f"rig, {name} path, {method}")
                way = {"start": 0.0, "duration": moving, "through": path[1:].tolist()}
                arm = {"start": path[0].tolist(), "path": way}
                runs[name] = options.run(
                    plant, seed, emulated, moving + rest, arm, compensated=compensated
                )
        return found

    def figures(self, zero_g_ratio: float) -> dict[str, JsonValue]:
        """Peak energies, their ratios, and how the uncompensated runs end.

        Args:
            zero_g_ratio: peak of the good path over that of the bad one in zero gravity.
        """
        peaks = {name: run.peak for name, run in self.emulated.items()}
        ratio = peaks["good"] / peaks["bad"]
        emulated: dict[str, JsonValue] = {
            name: {
                "peak_energy": run.peak,
                "peak_energy_ideal": float(run.ideal.max()),
                "peak_energy_leg_lag": float(run.leg_lag.max()),
                "outcome": run.outcome.value,
            }
            for name, run in self.emulated.items()
        }
        emulated["good_over_bad"] = ratio
        emulated["good_over_bad_against_zero_g"] = ratio / zero_g_ratio
        bare: dict[str, JsonValue] = {
            name: {
                "peak_energy": run.peak,
                "over_emulated": run.peak / peaks[name],
                "ended": float(run.time[-1]),
                "outcome": run.outcome.value,
            }
            for name, run in self.uncompensated.items()
        }
        return {"emulated": emulated, "uncompensated": bare}

    def lines(self) -> tuple[str, ...]:
        """The same for a person."""
        head = "  on the rig  Model Method   not compensated"
        rows = []
        for name, run in self.emulated.items():
            row, bare = f"  {name:<10} {run.peak:9.4f} J", self.uncompensated.get(name)
            if bare is not None:
                row += f" {bare.peak:14.2f} J   {bare.outcome.value} after {bare.time[-1]:.1f} s"
            rows.append(row)
        ratio = self.emulated["good"].peak / self.emulated["bad"].peak
        return ("", head, *rows, "", f"  good over bad on the rig, Model Method: {ratio:.3f}")

    def write(self, folder: Path) -> None:
        """Write `paths_on_rig.csv`; an uncompensated run that ended is blank (nan) from there on.

        Raises:
            FileAccessError: a file that cannot be written.
        """
        longest = max((run.time for run in self.emulated.values()), key=len)
        columns: dict[str, FloatArray] = {"t [s]": longest}
        for kind, runs in (("emulated", self.emulated), ("uncompensated", self.uncompensated)):
            for name, run in runs.items():
                column = np.full(len(longest), np.nan)
                column[: len(run.energy)] = run.energy
                columns[f"{name}.{kind}.energy [J]"] = column
        write_table(folder / "paths_on_rig.csv", columns)
