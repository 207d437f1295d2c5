"""The six rows of the peers' table through this engine, as the end of a page.

    python benchmarks/diagnosis_pendulum.py docs/diagnosis-method.md

Everything below the line `## Beside mujoco.sysid` is written anew.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from pendulum import PLANT
from rows import PEER, ROWS, row_record

from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.settings import Settings

MARK = "## Beside mujoco.sysid"

HEAD = """{mark}

Written by `.venv/bin/python benchmarks/diagnosis_pendulum.py docs/diagnosis-method.md`. Six
pendulums whose data is made as the peers' was (8 s, 500 Hz, the same integrator, white noise);
`mujoco.sysid` fitted damping (0.05) and mass (1.0). Its answers are quoted: it cannot be imported
from the mujoco package without an extra. Blind pendulums are on the
[scorecard](diagnosis-scorecard.md).

| hidden | mujoco.sysid 4.0.0 (quoted) | verdict | size found | hidden size |
|---|---|---|---|---|
"""


def peer_rows(settings: Settings) -> list[str]:
    """One row of the table for each pendulum."""
    lines = []
    for name, (hidden, told) in ROWS.items():
        verdict = diagnose(PLANT, [row_record(hidden)], settings=settings)
        found = [p.words for cause in verdict.causes for p in cause.parameters.values()]
        said = " ".join([str(verdict.verdict), *(cause.effect for cause in verdict.causes)])
        size = ", ".join(found) or "-"
        lines.append(f"| {name} | {PEER[name]} | {said} | {size} | {told} |")
        print(lines[-1], file=sys.stderr, flush=True)
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path)
    parser.add_argument("--cache", type=Path, help="folder that keeps the bank")
    options = parser.parse_args()
    rows = peer_rows(Settings(nulls=100, cache=options.cache))
    page = options.page.read_text(encoding="utf-8") if options.page.exists() else ""
    text = page.split(MARK)[0] + HEAD.format(mark=MARK) + "\n".join(rows) + "\n"
    options.page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
