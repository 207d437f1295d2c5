"""Showcase: something is hidden in a rig, recorded, and diagnosed from the recordings alone."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.core.cache_folder import cache_folder
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.files import load_recording
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict import Verdict
from ves_twin.machines.diagnose import diagnose as diagnose_machine
from ves_twin.machines.pendulum.forward import Pendulum
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.report.diagnosis.page import diagnosis_page
from ves_twin.report.diagnosis.words import headline
from ves_twin.report.page import write_page
from ves_twin.scenario.fields import Part, named
from ves_twin.simulator.outcome import Outcome
from ves_twin.suites.bench import BlindBench, BlindRig
from ves_twin.suites.judge import judge
from ves_twin.suites.pendulum import BlindPendulum
from ves_twin.suites.rig import BlindVes2
from ves_twin.suites.save_bare import save_bare
from ves_twin.suites.suite import HELD_OUT, RECORDING, STANDSTILL

BENCHES = ("pendulum", "ves2")

RIGS_OWN, NOISE = 1, 2
"""Streams of the seed: the rig that is drawn, and what its recordings draw."""


class HiddenPart(Part):
    """One effect of the library; `size` has its departure from nominal by the parameter's name."""

    effect: str
    target: str
    size: dict[str, float]

    @property
    def label(self) -> str:
        """effect@target."""
        return f"{self.effect}@{self.target}"


class OutsidePart(Part):
    """One kind that the library lacks, of those that the bench's generator has."""

    kind: str
    size: float


class Showcase(Procedure):
    """A rig with a hidden effect, recorded, and diagnosed from the files alone.

    The rig is drawn within its tolerances and recorded as in blind suites: half the step, another
    integrator, other noise, counts, a disturbance that no model has.

    `bench`: "ves2" (the rig of `plant`), or the small "pendulum". `deployed_filter` is where the
    leg program has its filter, whatever the scenario says.
    """

    plant: str = "ves2_pressure_fast"
    bench: Annotated[str, named("bench", BENCHES)] = "ves2"
    hidden: tuple[HiddenPart, ...] = ()
    outside: OutsidePart | None = None
    deployed_filter: FilterPlace | None = None
    spread: Annotated[float, Field(ge=0, le=5)] = 1.0
    nulls: Annotated[int, Field(ge=12, le=10000)] = 60
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0

    def carry_out(self, conduct: RunContext) -> Result:
        """Record, diagnose, write `verdict.json` and `report.html`, hold against the truth.

        Raises:
            UnknownNameError: a cause or kind that the bench does not have.
            InvalidInputError: a filter to deploy on a rig without one, or another plant.
        """
        if conduct.plant is not None:
            raise InvalidInputError("--plant", conduct.plant.name, "none: --set plant=NAME")
        bench = self._bench()
        seed = self.seed if conduct.seed is None else conduct.seed
        rig = self._rig(bench, np.random.default_rng([seed, RIGS_OWN]))
        noise = np.random.default_rng([seed, NOISE])
        conduct.progress(0.0, "recording")
        for programme, name in (("train", RECORDING), ("held_out", HELD_OUT)):
            save_bare(bench.record(rig, programme, noise), conduct.folder / name)
        if self.bench == "pendulum":  # legs hunt over a count while they stand, and not in motion
            in_order = BlindRig(bench.commissioned(noise, self.spread))
            still = bench.record(in_order, "standstill", noise)
            save_bare(still, conduct.folder / STANDSTILL)
        verdict, plant = self._diagnosed(conduct)
        title = f"{self.name}: {self.question}"
        verdict.save(conduct.folder / "verdict.json")
        write_page(conduct.folder / "report.html", diagnosis_page(verdict, title, plant))
        return self._account(verdict, conduct.folder)

    def _bench(self) -> BlindBench:
        if self.bench == "pendulum":
            if self.deployed_filter is not None:
                raise InvalidInputError("deployed_filter", "a pendulum", 'bench = "ves2"')
            return BlindPendulum()
        return BlindVes2(self.plant)

    def _rig(self, bench: BlindBench, rng: np.random.Generator) -> BlindRig:
        values = bench.commissioned(rng, self.spread)
        nominal = {p.name: p.nominal for p in bench.forward.parameters}
        library = {h.label: h for h in bench.forward.hypotheses}
        for part in self.hidden:
            if part.label not in library:
                raise UnknownNameError("cause", part.label, library)
            for name in library[part.label].parameters:
                size = _size(part, name)
                values[name] = values.get(name, nominal[name]) + size
        if self.outside is not None and self.outside.kind not in bench.outside:
            raise UnknownNameError("kind outside the library", self.outside.kind, bench.outside)
        kind, size = (self.outside.kind, self.outside.size) if self.outside else ("", 0.0)
        place = self.deployed_filter
        deployed = {} if place is None else {"legs.filter": place.value}
        return BlindRig(values, kind, size, deployed)

    def _diagnosed(self, conduct: RunContext) -> tuple[Verdict, str]:
        """The verdict on the files, and what became of the extended plant."""
        folder = conduct.folder
        settings = Settings(
            workers=os.cpu_count() or 1, cache=cache_folder("diagnosis"), nulls=self.nulls
        )
        record, held_out = load_recording(folder / RECORDING), load_recording(folder / HELD_OUT)
        material: dict[str, Any] = {"held_out": [held_out], "settings": settings}
        material["progress"] = conduct.progress
        if self.bench == "pendulum":
            material["standstill"] = load_recording(folder / STANDSTILL)
            return diagnose(Pendulum.with_command_delay(), [record], **material), ""
        found = diagnose_machine([record], Plant.load(self.plant), **material)
        for name in ("plant.toml", "plant.candidate.toml"):  # of an earlier run
            (folder / name).unlink(missing_ok=True)
        if found.extended is None:
            return found.verdict, f"No extended plant was written: {found.refused}."
        path = folder / ("plant.candidate.toml" if found.refused else "plant.toml")
        found.extended.save(path, found.verdict.words)
        if found.refused:
            return found.verdict, f"The extended plant is a candidate: {found.refused}."
        return found.verdict, "The extended plant is plant.toml; it passed on held-out recordings."

    def _account(self, verdict: Verdict, folder: Path) -> Result:
        labels = [part.label for part in self.hidden]
        if self.deployed_filter is not None:
            labels.append(f"filter_place@{self.deployed_filter.value}")
        judged = judge(verdict, frozenset(labels), self.outside is not None)
        told = [f"{part.label} {_words(part.size)}" for part in self.hidden]
        told += [label for label in labels if label.startswith("filter_place@")]
        if self.outside is not None:
            told.append(f"{self.outside.kind} {self.outside.size:g}, which the library lacks")
        gain = verdict.gain.share if verdict.gain else None
        lines = [
            f"  hidden    {' and '.join(told) or 'nothing'}",
            f"  said      {headline(verdict)}",
            f"            {verdict.words}",
            f"  that is   {judged.value}",
        ]
        if gain is not None:
            lines.append(f"  gain      {gain:.0%} of the excess on held-out recordings")
        if self.bench == "ves2":
            files = f"{folder / RECORDING} --held-out {folder / HELD_OUT} --plant {self.plant}"
            lines += ["", f"  again     ves-twin diagnose {files}"]
        values: dict[str, JsonValue] = {
            "hidden": list(labels),
            "outside": self.outside.kind if self.outside else "",
            "verdict": verdict.verdict.value,
            "causes": [f"{cause.effect}@{cause.target}" for cause in verdict.causes],
            "judged": judged.value,
            "held_out_gain": gain,
        }
        return Result(Outcome.COMPLETED, values, tuple(lines))


def _size(part: HiddenPart, parameter: str) -> float:
    """Departure of a parameter, by its name or by its last word."""
    for name in (parameter, parameter.rpartition(":")[2]):
        if name in part.size:
            return part.size[name]
    raise UnknownNameError(f"size of {part.label}", parameter, part.size)


def _words(sizes: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {size:+g}" for name, size in sizes.items())
