"""Plugins, and figures that tests measure and docs print."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import redirect_stderr
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

import pytest

# threads of small matrix products wait for each other where workers share the cores
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from ves_twin.cli import progress
from ves_twin.core.compiled import say_that_it_compiles
from ves_twin.simulator.loop import run_ticks

pytest_plugins = ["costs", "once", "shipped"]


@dataclass(frozen=True)
class Figure:
    """One measured number beside what was asked of it."""

    what: str
    value: float
    limit: float
    unit: str
    test: str


FIGURES = pytest.StashKey[list[Figure]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--mutations", metavar="N", type=int, default=1000, help="harmed files of tests/fuzz"
    )
    parser.addoption("--figures", metavar="FILE", help="write the measured figures as a page")


def pytest_configure(config: pytest.Config) -> None:
    progress.FIRST = 3600.0  # lines of progress come by the clock, which no test may depend on
    with redirect_stderr(StringIO()):
        say_that_it_compiles(run_ticks)  # once: no line depends on caches
    config.stash[FIGURES] = []


@pytest.fixture
def figure(request: pytest.FixtureRequest) -> Callable[[str, float, float, str], None]:
    """`figure(what, value, limit, unit)`: assert value <= limit, and keep it for the page."""

    def measure(what: str, value: float, limit: float, unit: str) -> None:
        test = request.node.nodeid.split("[")[0]
        request.config.stash[FIGURES].append(Figure(what, float(value), limit, unit, test))
        request.node.user_properties.append(("result", (what, float(value), float(limit), unit)))
        assert value <= limit, f"{what}: {value:.3g} {unit}, limit {limit:.3g}"

    return measure


def pytest_sessionfinish(session: pytest.Session) -> None:
    path = session.config.getoption("--figures")
    if path:
        Path(path).write_text(_page(session.config.stash[FIGURES]), encoding="utf-8")


def _page(figures: list[Figure]) -> str:
    lines = [
        "# Figures of the rig",
        "",
        "Measured by the tests named beside them; `make figures` writes this page anew.",
        "Each row repeats with `.venv/bin/python -m pytest --nightly -n 0 TEST`. Speed is in"
        " [speed.md](speed.md), since it depends on the machine.",
        "",
        "| what | measured | asked | test |",
        "|---|--:|--:|---|",
    ]
    for f in figures:
        lines.append(
            f"| {f.what} | {f.value:.3g} {f.unit} | <= {f.limit:.3g} {f.unit} | `{f.test}` |"
        )
    return "\n".join(lines) + "\n"
