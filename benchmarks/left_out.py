"""Rigs tuned without one claim each, for the leave-one-out column of the thesis scorecard.

Run by `.venv/bin/python benchmarks/left_out.py`; writes models/thesis/left_out/CLAIM.toml, some
15 minutes of processor time. The leg gains stay: K1 has no scale in the thesis but these claims.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from tempfile import TemporaryDirectory

from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import RunContext
from ves_twin.procedures.registry import load_procedure
from ves_twin.procedures.stability.calibrate_plant import CalibratePlant

STRUCTURE = {
    "C072": {"mode_lowest", "mode_highest"},
    "C073": {"mode_fall"},
    "C074": {"bandwidth_low"},
    "C088": {"release_cut"},
}
"""Claim -> names in calibrate_plant that rest on it."""

TABLE_3_1 = [(f"C{41 + 2 * axis:03d}", f"C{42 + 2 * axis:03d}", axis) for axis in range(6)]
"""Rms and largest gravity error of each axis, which the sensor's noise was set from."""


def tuned_without(names: set[str], rounds: int) -> str:
    """Lines of [parameters] that the calibration finds without some of its claims."""
    whole = load_procedure("calibrate_plant")
    if not isinstance(whole, CalibratePlant):
        raise TypeError(type(whole))
    chosen = whole.model_copy(
        update={
            "claims": tuple(c for c in whole.claims if c.name not in names),
            "knobs": tuple(k for k in whole.knobs if not k.name.startswith("gain.")),
            "rounds": rounds,
            "verify": False,
        }
    )
    with TemporaryDirectory() as folder:
        chosen.carry_out(RunContext(Path(folder)))
        text = (Path(folder) / "plant.toml").read_text(encoding="utf-8")
    return text[text.index("[parameters]") :]


def noise_from(other: float, axis: int) -> str:
    """The sensor's noise on an axis as the row beside it would have set it."""
    plant = Plant.load("ves2")
    lines = []
    for name in ("sensor.noise", "sensor.wander"):
        values = plant.parameters.array(name).copy()
        values[axis] *= other
        lines.append(f'"{name}" = {[float(f"{v:.4g}") for v in values]}')
    return "[parameters]\n" + "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scorecard", type=Path, default=Path("runs/scorecard/scorecard.json"))
    parser.add_argument("--folder", type=Path, default=Path("models/thesis/left_out"))
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("claims", nargs="*", help="only these")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)

    def write(claim: str, how: str, parameters: str) -> None:
        if arguments.claims and claim not in arguments.claims:
            return
        head = f'# ves2 {how}. Written by benchmarks/left_out.py.\nschema = 1\nname = "{claim}"\n'
        text = f'{head}base = "ves2"\n\n{parameters}'
        (arguments.folder / f"{claim}.toml").write_text(text, encoding="utf-8")

    card = json.loads(arguments.scorecard.read_text(encoding="utf-8"))
    rows = {row["id"]: row for row in card["rows"]}
    table = [claim for pair in TABLE_3_1 for claim in pair[:2]]
    share = {claim: rows[claim]["thesis"][0] / rows[claim]["twin"][0] for claim in table}
    for rms, largest, axis in TABLE_3_1:
        write(rms, f"with the sensor's noise from {largest}", noise_from(share[largest], axis))
        write(largest, f"with the sensor's noise from {rms}", noise_from(share[rms], axis))
    for claim, names in STRUCTURE.items():
        if not arguments.claims or claim in arguments.claims:
            write(claim, "calibrated without this claim", tuned_without(names, arguments.rounds))


if __name__ == "__main__":
    main()
