"""Showcase: something is hidden in a rig, recorded, and diagnosed from the recordings alone."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, JsonValue, field_validator, model_validator

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.core.cache_folder import cache_folder
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.machines.diagnose import Diagnosis
from ves_twin.machines.load import machine_of
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.report.diagnosis.answer import headline
from ves_twin.report.diagnosis.page import diagnosis_page
from ves_twin.report.page import write_page
from ves_twin.scenario.fields import Part
from ves_twin.simulator.outcome import Outcome
from ves_twin.suites.answers import Answer
from ves_twin.suites.diagnosed import diagnosed
from ves_twin.suites.judgement import judge
from ves_twin.suites.machine import BlindMachine, BlindRig
from ves_twin.suites.make import hide, record_pair
from ves_twin.suites.material import Material
from ves_twin.suites.mjcf import BlindMjcf
from ves_twin.suites.old_names import current_label, current_size
from ves_twin.suites.save_bare import save_bare
from ves_twin.suites.suite import HELD_OUT, RECORDING, STANDSTILL, check_machine
from ves_twin.suites.truth import Hidden, HiddenCause, Truth
from ves_twin.suites.ves2 import BlindVes2

VES2 = "ves2"

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
        return current_label(f"{self.effect}@{self.target}")


class OutsidePart(Part):
    """One kind that the library lacks, of those that the bench's generator has."""

    kind: str
    size: float


class Showcase(Procedure):
    """A rig with a hidden effect, recorded, and diagnosed from the files alone.

    The rig is drawn within its tolerances and recorded as in blind suites: half the step, another
    integrator, other noise, counts, a disturbance that no model has.

    `machine`: "ves2" (the rig of `plant`), or an MJCF machine by name or file, as the small
    "pendulum". `deployed_filter` is where the leg program has its filter, whatever the scenario
    says.
    """

    plant: str = "ves2_pressure_fast"
    machine: str = VES2
    hidden: tuple[HiddenPart, ...] = ()
    outside: OutsidePart | None = None
    deployed_filter: FilterPlace | None = None
    spread: Annotated[float, Field(ge=0, le=5)] = 1.0
    nulls: Annotated[int, Field(ge=12, le=10000)] = 60
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0

    @model_validator(mode="before")
    @classmethod
    def _machine_by_either_name(cls, content: Any) -> Any:
        """`bench`, as showcases had it, is `machine`."""
        if isinstance(content, dict) and "bench" in content:
            content = {**content, "machine": content["bench"]}
            del content["bench"]
        return content

    @field_validator("machine")
    @classmethod
    def _machine_is_known(cls, name: str) -> str:
        try:
            check_machine(name)
        except UnknownNameError as error:
            raise ValueError(str(error)) from None
        return name

    def carry_out(self, conduct: RunContext) -> Result:
        """Record, diagnose, write `verdict.json` and `report.html`, hold against the truth.

        Raises:
            UnknownNameError: a cause or kind that the bench does not have.
            InvalidInputError: a filter to deploy on a rig without one, or another plant.
        """
        if conduct.plant is not None:
            raise InvalidInputError("--plant", conduct.plant.name, "none: --set plant=NAME")
        nominal = Plant.load(self.plant) if self.machine == VES2 else Rig.load(self.machine)
        machine = BlindVes2(self.plant) if isinstance(nominal, Plant) else BlindMjcf(nominal)
        seed = self.seed if conduct.seed is None else conduct.seed
        rig = self._rig(machine, np.random.default_rng([seed, RIGS_OWN]))
        noise = np.random.default_rng([seed, NOISE])
        conduct.progress(0.0, "recording")
        record_pair(machine, (rig, rig), conduct.folder, noise)
        if isinstance(nominal, Rig):  # legs hunt over a count while they stand, and not in motion
            in_order = BlindRig(machine.commissioned(noise, self.spread))
            still = machine.record(in_order, "standstill", noise)
            save_bare(still, conduct.folder / STANDSTILL)
        found = self._diagnosed(nominal, conduct)
        verdict, plant = found.verdict, _written(found, conduct.folder)
        title = f"{self.name}: {self.question}"
        verdict.save(conduct.folder / "verdict.json")
        write_page(conduct.folder / "report.html", diagnosis_page(verdict, title, plant))
        return self._account(verdict, conduct.folder)

    def _rig(self, machine: BlindMachine, rng: np.random.Generator) -> BlindRig:
        if self.deployed_filter is not None and not isinstance(machine, BlindVes2):
            raise InvalidInputError("deployed_filter", self.machine, f'machine = "{VES2}"')
        library = {h.label: h for h in machine.forward.hypotheses}
        causes = tuple(_hidden(part, library) for part in self.hidden)
        kind, size = (self.outside.kind, self.outside.size) if self.outside else ("", 0.0)
        if kind and kind not in machine.outside:
            raise UnknownNameError("kind outside the library", kind, machine.outside)
        place = self.deployed_filter
        truth = Truth(self.name, Hidden.SINGLE, causes, kind, size, self.spread)
        deployed = {} if place is None else {"legs.filter": place.value}
        return hide(machine, machine.commissioned(rng, self.spread), truth, deployed)

    def _diagnosed(self, nominal: Rig | Plant, conduct: RunContext) -> Diagnosis:
        """What the files say."""
        cache = cache_folder("diagnosis")
        settings = Settings(workers=os.cpu_count() or 1, cache=cache, nulls=self.nulls)
        material = Material.in_folder(conduct.folder, standstill=isinstance(nominal, Rig))
        return diagnosed(machine_of(nominal), material, settings, progress=conduct.progress)

    def _account(self, verdict: Verdict, folder: Path) -> Result:
        labels = [part.label for part in self.hidden]
        if self.deployed_filter is not None:
            labels.append(f"filter_place@{self.deployed_filter.value}")
        judged = judge(Answer.of(verdict, 0.0), frozenset(labels), self.outside is not None)
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
        plant = self.plant if self.machine == VES2 else self.machine
        files = f"{folder / RECORDING} --held-out {folder / HELD_OUT} --plant {plant}"
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


def _hidden(part: HiddenPart, library: Mapping[str, Hypothesis]) -> HiddenCause:
    """A cause at the sizes that the part says, by a parameter's name or its last word."""
    if part.label not in library:
        raise UnknownNameError("cause", part.label, library)
    given = dict(current_size(name, value) for name, value in part.size.items())
    departures = {}
    for parameter in library[part.label].parameters:
        name = next((n for n in (parameter, parameter.rpartition(":")[2]) if n in given), None)
        if name is None:
            raise UnknownNameError(f"size of {part.label}", parameter, part.size)
        departures[parameter] = given[name]
    effect, _, target = part.label.partition("@")
    return HiddenCause(effect, target, departures, float("nan"))


def _written(found: Diagnosis, folder: Path) -> str:
    """Write the extended machine, if there is one; what became of it."""
    for name in ("plant.toml", "plant.candidate.toml"):  # of an earlier run
        (folder / name).unlink(missing_ok=True)
    if found.extended is None:
        return f"No extended plant was written: {found.refused}."
    path = folder / ("plant.candidate.toml" if found.refused else "plant.toml")
    found.extended.save(path, found.verdict.words)
    if found.refused:
        return f"The extended plant is a candidate: {found.refused}."
    return "The extended plant is plant.toml; it passed on held-out recordings."


def _words(sizes: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {size:+g}" for name, size in sizes.items())
