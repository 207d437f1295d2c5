"""costs: a pytest plugin that keeps what each test costs, and ends a nightly run with one table.

`--costs FILE` writes a row a test: processor seconds of preparing, running and clearing up (this
process and the children it waited for), seconds of the clock, outcome. Processor seconds do not
depend on what else the machine does, so that two such files can be compared.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

BEGUN = pytest.StashKey[float]()
CASES, RESULT = "cases", "result"
"""User properties of a test: how many cases it tried, what was measured beside what was asked."""

PHASES = ("setup", "call", "teardown")
COLUMNS = ("test", "outcome", *PHASES, "clock")


def processor_seconds() -> float:
    """Of this process and of its children that have ended."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


@dataclass
class Cost:
    """What one test took and said."""

    nightly: bool
    outcome: str = "passed"
    clock: float = 0.0
    processor: dict[str, float] = field(default_factory=dict)
    said: list[tuple[str, Any]] = field(default_factory=list)

    def add(self, report: pytest.TestReport) -> None:
        self.processor[report.when or "call"] = getattr(report, "processor", 0.0)
        self.clock += report.duration
        self.said = list(report.user_properties)
        if report.outcome != "passed":
            self.outcome = report.outcome

    @property
    def seconds(self) -> float:
        return sum(self.processor.values())


class Costs:
    """Collects the reports of all workers."""

    def __init__(self, config: pytest.Config) -> None:
        self.path = config.getoption("--costs")
        self.nightly = config.getoption("--nightly")
        self.tests: dict[str, Cost] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        cost = self.tests.setdefault(report.nodeid, Cost("nightly" in report.keywords))
        cost.add(report)

    def pytest_sessionfinish(self) -> None:
        if self.path:
            Path(self.path).parent.mkdir(parents=True, exist_ok=True)
            with Path(self.path).open("w", encoding="utf-8", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(COLUMNS)
                for test, c in sorted(self.tests.items(), key=lambda kept: -kept[1].seconds):
                    phases = [f"{c.processor.get(phase, 0.0):.2f}" for phase in PHASES]
                    writer.writerow([test, c.outcome, *phases, f"{c.clock:.2f}"])

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        total = sum(cost.seconds for cost in self.tests.values())
        terminalreporter.write_line(f"{total:.0f} s of processor time in {len(self.tests)} tests")
        if self.nightly:
            terminalreporter.section("nightly suites")
            for row in table(self.tests):
                terminalreporter.write_line(row)


def table(tests: Mapping[str, Cost]) -> list[str]:
    """Suite, cases, result, limit, processor seconds: a row a measured figure or a suite."""
    suites: dict[str, list[Cost]] = {}
    for test, cost in tests.items():
        if cost.nightly or any(name == CASES for name, _ in cost.said):
            suites.setdefault(test.split("[")[0], []).append(cost)
    rows = ["| suite | cases | result | limit | seconds |", "|---|--:|--:|--:|--:|"]
    for suite, costs in sorted(suites.items()):
        said = [pair for cost in costs for pair in cost.said]
        cases = sum(int(n) for name, n in said if name == CASES) or len(costs)
        passed = sum(cost.outcome == "passed" for cost in costs)
        seconds = f"{sum(cost.seconds for cost in costs):.0f}"
        rows.append(f"| {suite} | {cases} | {passed} of {len(costs)} passed | all | {seconds} |")
        for what, value, limit, unit in (figure for name, figure in said if name == RESULT):
            rows.append(f"| {what} | | {value:.3g} {unit} | <= {limit:.3g} {unit} | |")
    return rows


@pytest.fixture
def cases(request: pytest.FixtureRequest) -> Callable[[int], int]:
    """`cases(full)`: how many cases a statistical test tries; a tenth of them but nightly."""

    def count(full: int) -> int:
        tried = full if request.config.getoption("--nightly") else -(-full // 10)
        request.node.user_properties.append((CASES, tried))
        return tried

    return count


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--costs", metavar="FILE", help="write what each test took, the dearest first")
    parser.addoption(
        "--nightly", action="store_true", help="statistical suites at full size, marked tests too"
    )


def pytest_configure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Costs(config))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    # what takes minutes goes first, so that no worker waits for it at the end
    items.sort(key=lambda item: item.get_closest_marker("timeout") is None)
    if config.getoption("--nightly"):
        return
    left_out = [item for item in items if item.get_closest_marker("nightly")]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if not item.get_closest_marker("nightly")]


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    item.stash[BEGUN] = processor_seconds()
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    now = processor_seconds()
    report.processor = now - item.stash[BEGUN]  # type: ignore[attr-defined]
    item.stash[BEGUN] = now
    return report
