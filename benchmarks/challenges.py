"""Six policies on the challenge matrix of VibrationDamping, as the table of docs/challenges.md.

One policy at a time: `ves-twin evaluate VibrationDamping-v0 --policy P --challenges`. Policies that
are through are kept below `--keep`, for the same code, models and words: a second start goes on.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from ves_twin.cli.progress import RunProgress
from ves_twin.core.whole_file import write_whole
from ves_twin.envs.challenges import CHALLENGES, Row, score_challenges
from ves_twin.envs.evaluation import Episode, Evaluation, Figure, Trial, paired
from ves_twin.thesis.store import code_hash

ENVIRONMENT = "VibrationDamping-v0"

POLICIES = {
    "still": "none: the arm stands still",
    "pped": "thesis: PPED gains (4.3)",
    "inertial_damper": "classical: joint rates by the base's displacement",
    "lqg": "LQG on the prior",
    "mpc": "MPC with the prior, bounds and all",
    "trained": "soft actor-critic, seven minutes",
}

BEGIN, END = "<!-- made by benchmarks/challenges.py -->", "<!-- end -->"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--plant", default="ves2_fast")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--keep", type=Path, default=Path("runs/challenges"))
    parser.add_argument("--page", type=Path, help="write the table between its marks in this page")
    given = parser.parse_args()
    found = {}
    with RunProgress("challenges", 1.0, unit="share") as progress:
        for policy in POLICIES:
            trial = Trial(ENVIRONMENT, policy, "none", given.plant)
            kept = given.keep / code_hash() / f"{policy}_{given.plant}_{given.seeds}.json"
            if not kept.is_file():
                rows = score_challenges(
                    trial,
                    range(given.seeds),
                    given.workers,
                    lambda s, what, p=policy: progress.share(s, p),
                )
                kept.parent.mkdir(parents=True, exist_ok=True)
                write_whole(kept, json.dumps([asdict(row) for row in rows]))
            found[policy] = [read_row(row) for row in json.loads(kept.read_text(encoding="utf-8"))]
    text = table(found)
    print(text)
    if given.page:
        page = given.page.read_text(encoding="utf-8")
        before, rest = page.split(BEGIN)
        after = rest.split(END)[1]
        given.page.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}", encoding="utf-8")


def read_row(told) -> Row:
    """A row of the matrix from a kept file; JSON keeps every bit of a number."""
    evaluation = told["evaluation"]
    return Row(
        told["challenge"],
        Evaluation(
            Trial(**evaluation["trial"]),
            tuple(Episode(**episode) for episode in evaluation["episodes"]),
            {name: Figure(**figure) for name, figure in evaluation["figures"].items()},
            evaluation["outcomes"],
        ),
    )


def table(found) -> str:
    """Rows are challenges, columns policies; what is better than none on its interval is bold."""
    lines = [
        "| challenge | " + " | ".join(f"`{policy}`" for policy in found) + " |",
        "|---" + "|--:" * len(found) + "|",
    ]
    for k, name in enumerate(CHALLENGES):
        none = found["still"][k].evaluation.episodes
        cells = [cell(found[policy][k].evaluation, none) for policy in found]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def cell(evaluation, none) -> str:
    figure = evaluation.figures["return"]
    text = f"{figure.iqm:.1f} ({figure.low:.1f} to {figure.high:.1f})"
    stopped = sum(count for name, count in evaluation.outcomes.items() if name != "completed")
    better = paired(evaluation.episodes, none)["return"]
    text = f"**{text}**" if better.low > 0.0 and not stopped else text
    cost = float(np.mean([episode.cost for episode in evaluation.episodes]))
    text += f", cost {cost:.1f}" if cost > 0.05 else ""
    return text + (f", {stopped} stopped" if stopped else "")


if __name__ == "__main__":
    main()
