"""Dry friction of the cylinders: the engine's friction loss against a smooth tanh.

Prints the table of docs/decisions/0008-dry-friction.md: how far 100 N of friction in every leg of
the pressure form moves the leg lengths of a run, for each way of making the friction.
"""

from __future__ import annotations

import mujoco
import numpy as np

import ves_twin as vt
from ves_twin.core.types import FloatArray
from ves_twin.simulator.recorder import MemorySink

LEVEL = 100.0
"""Coulomb friction of each leg [N]."""

SECONDS = 8.0
"""Simulated time of each run: the beam's arm move and 5.5 s after it."""

DEFAULT_SOLREF, DEFAULT_SOLIMP = (0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0)
"""MuJoCo's own numbers of a friction constraint."""

FINEST = 8
"""Steps a tick of the comparison."""


def legs_after(scenario: str, substeps: int = 1, level: float = 0.0, soft: bool = False,
               width: float = 0.0) -> FloatArray:  # fmt: skip
    """Leg lengths of a run (rows, 6) [m].

    Args:
        scenario: its name.
        substeps: physics steps in a tick.
        level: friction [N].
        soft: whether the friction loss keeps the engine's own softness.
        width: of a -level tanh(v / width), held over a tick, in its place [m/s].
    """
    changes = {
        "plant": "ves2_pressure", "run.duration": SECONDS, "run.noise": False,
        "run.log": "leg", "run.substeps": substeps,
        "parameters.leg.dry_friction": 0.0 if width else level,
    }  # fmt: skip
    sink = MemorySink()
    sim = vt.Simulator(None, vt.Scenario.load(scenario, changes), sink=sink)
    sim.recorder.drop_references()
    dofs = sim.rig.layout.slide_dof
    if soft:
        sim.model.dof_solref[dofs], sim.model.dof_solimp[dofs] = DEFAULT_SOLREF, DEFAULT_SOLIMP
    if width:
        _push_back(sim, level, width)
    sim.advance(SECONDS)
    return sink.collect()[1]["leg.length"]


def _push_back(sim: vt.Simulator, level: float, width: float) -> None:
    """Make the rig run tick by tick with a tanh friction at the slides."""
    data, dofs, run = sim.data, sim.rig.layout.slide_dof, sim.rig.run

    def tick_by_tick(count: int, log: FloatArray, logged: int) -> tuple[int, int]:
        code = 0
        for _ in range(count):
            data.qfrc_applied[dofs] = -level * np.tanh(data.qvel[dofs] / width)
            code, logged = run(1, log, logged)
            if code:
                break
        return code, logged

    sim.rig.run = tick_by_tick  # type: ignore[method-assign]


def _largest(change: FloatArray) -> float:
    return float(np.max(np.abs(change))) * 1e3


def table(scenario: str) -> None:
    """Largest change by friction, and how far that change is from the finest one [mm]."""
    free = {n: legs_after(scenario, n) for n in (1, 2, 4, FINEST)}
    effect = {n: legs_after(scenario, n, LEVEL) - free[n] for n in free}
    print(f"\n{scenario + ', 100 N in every leg':52s}    change   off finest  [mm]")

    def row(name: str, change: FloatArray) -> None:
        gap = _largest(change - effect[FINEST])
        print(f"  {name:50s}{_largest(change):10.3f}{gap:10.3f}", flush=True)

    for width in (8e-3, 2e-3, 5e-4, 2e-4):
        smooth = legs_after(scenario, 1, LEVEL, width=width)
        row(f"tanh(v / {width * 1e3:g} mm/s)", smooth - free[1])
    row("friction loss, engine's own softness", legs_after(scenario, 1, LEVEL, soft=True) - free[1])
    for n in effect:
        row(f"friction loss, stiff, {n} step(s) a tick", effect[n])
    steps = ", ".join(f"{n}: {_largest(free[n] - free[FINEST]):.3f}" for n in (1, 2, 4))
    print(f"  without friction, steps a tick against {FINEST}: {steps} mm")


def main() -> None:
    """Both scenarios: a run that tracks, and one whose soft modes amplify small changes."""
    print(f"MuJoCo {mujoco.__version__}")
    for scenario in ("position_sine", "beam_horizontal_truth"):
        table(scenario)


if __name__ == "__main__":
    main()
