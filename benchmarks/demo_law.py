"""Hide a law in the pendulum, find it from the recordings alone, hold it against the truth.

python benchmarks/demo_law.py [--kind drawn|drag] [--seed N] [--out runs/demo-law]

"drawn" is a curve of speed that chance draws, from the clock unless a seed is given; "drag" goes
with the square of speed. The diagnosis is a command of its own and sees the files alone.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

from ves_twin.cli.main import main as ves_twin
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.suites.hidden_law import Acts, HiddenLaw, draw_law
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.mjcf import BlindMjcf
from ves_twin.suites.save_bare import save_bare

DRAG = (0.005, 0.05)
"""Smallest and largest drag that is hidden [N m s^2/rad^2]."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kind", choices=("drawn", "drag"), default="drawn")
    parser.add_argument("--seed", type=int, default=None, help="default: the clock")
    parser.add_argument("--out", type=Path, default=Path("runs/demo-law"))
    told = parser.parse_args()
    seed = int(time.time()) if told.seed is None else told.seed
    rng = np.random.default_rng(seed)
    law = _law(told.kind, rng)
    _record(law, rng, told.out)
    files = {name: str(told.out / f"{name}.parquet") for name in ("measured", "held", "still")}
    ves_twin(
        ["diagnose", files["measured"], "--plant", "pendulum", "--held-out", files["held"],
         "--standstill", files["still"], "--law", "--out", str(told.out / "diagnosis")]
    )  # fmt: skip
    print("\n".join(_compared(law, seed, told.out / "diagnosis")))


def _law(kind: str, rng: np.random.Generator) -> HiddenLaw:
    if kind == "drawn":
        return draw_law("random_of_speed", rng)
    drag = float(np.exp(rng.uniform(*np.log(DRAG))))
    name = f"-{drag:.4g} |x| x"
    return HiddenLaw(name, Acts.SPEED, "joint", "speed@joint", lambda v: -drag * np.abs(v) * v)


def _record(law: HiddenLaw, rng: np.random.Generator, folder: Path) -> None:
    """A pendulum within its tolerances: measured, on another day, and standing still."""
    machine = BlindMjcf(Rig.load("pendulum"))
    values = machine.commissioned(rng)
    other = machine.again(values, rng, 1.0, 0.0)
    for name, programme, numbers in (
        ("measured", "train", values),
        ("held", "held_out", other),
        ("still", "standstill", values),
    ):
        rig = BlindRig(numbers, law=law)
        save_bare(machine.record(rig, programme, rng), folder / f"{name}.parquet")


def _compared(law: HiddenLaw, seed: int, folder: Path) -> list[str]:
    found = json.loads((folder / "verdict.json").read_text(encoding="utf-8"))["law"]
    hidden = f"{law.kind.replace('_', ' ')}: an effort at {law.place} of {law.of} (seed {seed})"
    lines = ["", f"hidden    {hidden}"]
    if (
        found is None
        or found["shape"] != "table"
        or (found["place"], found["of"])
        != (
            law.place,
            [law.of],
        )
    ):
        return [*lines, "          the diagnosis found no law of that variable"]
    (low, high), *_ = found["seen"]
    lines += ["", "  speed, rad/s   found, N m   truth, N m"]
    for x in np.linspace(low, high, 9):
        there = float(np.interp(x, found["knots"][0], found["values"]))
        lines.append(f"  {x:12.2f}{there:13.4f}{float(law.function(np.array([x]))[0]):13.4f}")
    lines += ["", f"picture   {folder / 'law.png'}", f"report    {folder / 'report.html'}"]
    return lines


if __name__ == "__main__":
    main()
