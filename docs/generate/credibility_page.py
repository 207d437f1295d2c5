"""credibility_page: what is verified, validated and assumed, counted from claims, tests and data."""

from __future__ import annotations

import ast
import tomllib
from collections import Counter
from pathlib import Path

from ves_twin.plant.plant import Plant

_HEAD = """# Credibility

Each report of a diagnosis ends with a table such as this one:

| factor | standing | on what |
|---|---|---|
| validation | not shown | Not shown: no recording was held out. |
| results uncertainty | assumed | Noise: declared; tolerances: declared. |

The factors are the eight of NASA-STD-7009 (2008), a standard for models and simulations. This page has them for the project itself.
It is generated from the claims, the tests and the data sets when the site is built.

**A report says *validated* in one case only**: the recordings come from logs of a machine, some were held out, and the extended model
predicts those clearly better. A log says that it is one by being imported, or read as CSV, Parquet, MAT or MCAP. Nobody can check that a machine wrote it.
"""


def credibility_page(root: Path) -> str:
    """The page."""
    parts = (
        _HEAD,
        _verification(root / "tests"),
        _validation(root),
        _inputs(),
        _results(root / "docs" / "diagnosis-scorecard.md"),
        _REST,
    )
    return "\n".join(parts)


def _verification(tests: Path) -> str:
    """Tests by room."""
    counts: Counter[str] = Counter()
    for path in tests.rglob("test_*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        found = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)]
        room = path.relative_to(tests).parts[0].removesuffix(".py")
        counts[room] += sum(one.name.startswith("test_") for one in found)
    rows = [f"| `{room}` | {count} |" for room, count in sorted(counts.items())]
    return "\n".join(
        (
            "## Verification: is the code right?",
            "",
            f"{sum(counts.values())} test functions, of which many run over every registered thing."
            " Physics is held against closed forms and other programs;",
            "[figures](figures.md) has what was measured beside what was asked.",
            "",
            "| room | test functions |",
            "|---|--:|",
            *rows,
            "",
        )
    )


def _validation(root: Path) -> str:
    """External data sets, and the claims of the thesis."""
    sets = []
    for path in sorted((root / "models" / "machines").rglob("*.toml")):
        told = tomllib.loads(path.read_text(encoding="utf-8"))
        data = told.get("data", [])
        sources = {one["source"].split(";")[0] for one in data if "source" in one}
        sets += [f"| {told['name']} | {source} |" for source in sorted(sources)]
    claims = tomllib.loads((root / "models/thesis/claims.toml").read_text(encoding="utf-8"))
    kinds = Counter(c["kind"] for c in claims.values() if isinstance(c, dict))
    scores = (root / "docs" / "thesis-scorecard.md").read_text(encoding="utf-8").splitlines()[2]
    counted = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    return "\n".join(
        (
            "## Validation: is it the machine?",
            "",
            "**VES II: not shown.** No recording of the machine is at hand. The twin is held against the"
            f" printed claims of its thesis instead ({counted}).",
            f"The [scorecard](thesis-scorecard.md) says: {scores.strip('*')}",
            "",
            "**Other machines: public recordings**, told in [measured machines](real-machines.md):",
            "",
            "| machine | data |",
            "|---|---|",
            *sets,
            "",
        )
    )


def _inputs() -> str:
    """Grades of the numbers of VES II."""
    grades = Counter(str(p.grade) for p in Plant.load("ves2").parameters.values())
    words = {
        "thesis": "printed in the thesis",
        "derived": "follows from printed numbers",
        "calibrated": "tuned so that the claims hold together",
        "assumed": "assumed",
    }
    rows = [f"| {words.get(grade, grade)} | {count} |" for grade, count in grades.most_common()]
    return "\n".join(
        (
            "## Input pedigree: where do the numbers come from?",
            "",
            "| numbers of VES II | how many |",
            "|---|--:|",
            *rows,
            "",
            "Each stands with its source on the page [plant](formats/plant.md). Of your own machine, the"
            " file says what you know, and the report repeats it.",
            "",
        )
    )


def _results(page: Path) -> str:
    """What the blind suites asked and found."""
    lines = page.read_text(encoding="utf-8").splitlines()
    marked = next((line for line in lines if line.startswith("**Made before")), "")
    asked = [
        line for line in lines if line.startswith("- ") and (": met" in line or ": not" in line)
    ]
    met = sum(": met" in line for line in asked)
    return "\n".join(
        (
            "## Results: uncertainty and robustness",
            "",
            "We hide faults in simulated recordings and count how often they are found, how often a name"
            " is wrong, and how often an interval holds the hidden size.",
            f"Of {len(asked)} figures asked, {met} are met ([scorecard](diagnosis-scorecard.md)).",
            *(["The scorecard was made before the present code.", ""] if marked else [""]),
        )
    )


_REST = """## Use history, management, people

- Use history: the blind suites and the public recordings above. Nobody outside the project has reported a use yet.
- Management: every release has a changelog, pinned versions and hashes; a run repeats to the last bit on one kind of processor.
- People: the project cannot say who uses it.
"""
