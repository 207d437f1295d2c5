"""Simulator: a rig under a scenario, advanced as far as asked, with snapshots."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.control.controller import PlatformController
from ves_twin.control.played import Script
from ves_twin.core.recording.recording import Event
from ves_twin.core.types import Block
from ves_twin.effects.registry import parse_effects
from ves_twin.mechanics.joint_motion import JointMotion
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.build import (
    agenda_of,
    belief_of,
    build_computers,
    build_operator,
    build_references,
    emulated_of,
)
from ves_twin.simulator.clock import Clock, overrun
from ves_twin.simulator.codes import RUNNING
from ves_twin.simulator.computers import LONGEST_STRETCH, ComputersSnapshot
from ves_twin.simulator.cycles import SAMPLE
from ves_twin.simulator.law_step import forget_range, held_laws
from ves_twin.simulator.log_faults import LogFaults
from ves_twin.simulator.noise import BLOCK, NoiseStreams
from ves_twin.simulator.operator import Operator, OperatorSnapshot
from ves_twin.simulator.outcome import OUTCOME_OF_CODE, Outcome
from ves_twin.simulator.recorder import MemorySink, Recorder, RecorderSnapshot, Sink
from ves_twin.simulator.rig import Rig, RigSnapshot
from ves_twin.simulator.settle import settle, settling_events

_NO_SAMPLES: Block = np.zeros(0, SAMPLE)


@dataclass(frozen=True)
class Snapshot:
    """Everything that a run depends on, at one instant."""

    rig: RigSnapshot
    computers: ComputersSnapshot
    operator: OperatorSnapshot | None
    recorder: RecorderSnapshot
    outcome: Outcome | None
    events: tuple[Event, ...]
    agenda: tuple[Event, ...]


class Simulator:
    """The rig of a plant under a scenario, settled and ready at t = 0.

    Attributes:
        plant: the world.
        scenario: what is done with it.
        seed: seed of the noise.
        rig: hardware and fast loops, with the live MuJoCo state.
        computers: the admittance cycle.
        operator: who operates the laboratory; None where the scenario has no operation.
        recorder: completes and passes on the rows.
        outcome: None while running.
        events: what happened so far.

    Args:
        plant: the world, with the scenario's parameters; the scenario's own if left out.
        scenario: what is done with it.
        seed: seed of the noise; the scenario's own if left out.
        sink: where rows go; kept in memory if left out.
        script: set-points that are played back; the scenario's controllers decide if left out.
        controller: decides the platform's pose in place of the one that the mode names.
        arm: joint commands in place of the scenario's.

    Raises:
        VesTwinError: the scenario cannot be built: unknown name, pose out of reach.
    """

    def __init__(
        self,
        plant: Plant | None,
        scenario: Scenario,
        seed: int | None = None,
        sink: Sink | None = None,
        script: Script | None = None,
        controller: type[PlatformController] | None = None,
        arm: JointMotion | None = None,
    ) -> None:
        self.scenario = scenario
        world = (plant or Plant.load(scenario.plant)).with_values(scenario.parameters)
        self.plant = world.extended(*parse_effects(scenario.effects))
        self.seed = scenario.run.seed if seed is None else seed
        self.outcome: Outcome | None = None
        self.events: list[Event] = []
        self._agenda = agenda_of(scenario)
        self._emulated = emulated_of(scenario)
        clock = Clock.of(scenario, self.plant.parameters)
        self._end = clock.ticks(scenario.run.duration)
        belief = belief_of(scenario)
        noise = NoiseStreams(self.seed, scenario.run.noise)
        self.rig = Rig(self.plant, clock, scenario.legs, belief, noise)
        self.computers = build_computers(scenario, belief, self.rig, script, controller, arm)
        played = script is not None
        self.operator = build_operator(scenario, belief, self.rig, self.computers, played)
        self._longest = 0  # ticks without the interpreter
        if self.operator is None and not scenario.platform.busy:
            cycles = min(LONGEST_STRETCH, BLOCK // clock.admittance)
            self._longest = cycles * clock.admittance
        self._standing = _at_rest(scenario, self.operator)
        self.recorder = Recorder(
            clock,
            belief.geometry,
            np.array(self._standing.platform.start),
            build_references(scenario, self.plant, self.rig.parameters["servo"]),
            MemorySink() if sink is None else sink,
            self.plant.fidelity.absent_signals,
            LogFaults(self.plant.effects),
        )
        self._settle()
        if controller is not None:
            mode = f"in place of mode '{scenario.platform.mode}'"
            self.events.append(Event(0.0, "controller", f"{controller.__qualname__} {mode}"))

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled MuJoCo model."""
        return self.rig.model

    @property
    def data(self) -> mujoco.MjData:
        """Its live state."""
        return self.rig.data

    @property
    def time(self) -> float:
        """Time since the start of the run [s]."""
        return self.rig.time

    @property
    def done(self) -> bool:
        """Whether the run has ended, by reaching its duration or otherwise."""
        return self.outcome is not None

    def advance(self, seconds: float) -> None:
        """Run on for a time [s], to the nearest tick, or until the run ends."""
        self.run_to(min(self.rig.tick + self.rig.clock.ticks(seconds), self._end))
        self._note_agenda()
        if self.rig.tick >= self._end and self.outcome is None:
            self.end(Outcome.COMPLETED, f"reached {self.time:.3f} s")

    def run_to(self, target: int, samples: Block = _NO_SAMPLES) -> int:
        """Run up to a tick, with a cycle of the computers at each admittance interrupt.

        Args:
            target: the tick.
            samples: SAMPLE of `cycles`, takes one of the end of each cycle while there is room.

        Returns:
            How many cycles have ended, or were ended by the end of the run.
        """
        rig, period = self.rig, self.rig.clock.admittance
        ended = 0
        while rig.tick < target and self.outcome is None:
            phase = rig.tick % period
            if phase == 0:
                cycles = self._compiled_cycles(target - rig.tick, samples[ended:])
                ended += cycles
                if cycles:
                    continue
            if phase != 0 or self._interrupt():
                count = min(period - phase, target - rig.tick)
                code, self.recorder.rows = rig.run(count, self.recorder.log, self.recorder.rows)
                if code != RUNNING:
                    self._left_limits(code)
            rig.sample(samples[ended:])
            ended += 1
        return ended

    def end(self, outcome: Outcome, why: str) -> None:
        """End the run with a named outcome; what was recorded is kept."""
        self.outcome = outcome
        self._note_agenda()
        end = max(self.time, 0.0)
        held = held_laws(self.plant.laws, self.rig.laws)
        self.events += [Event(end, "law_held", words) for words in held]
        self.events.append(Event(end, outcome.value, why))
        self.recorder.flush(unfinished=True)

    def snapshot(self) -> Snapshot:
        """A copy of everything that the rest of the run depends on."""
        return Snapshot(
            rig=self.rig.snapshot(),
            computers=self.computers.snapshot(),
            operator=None if self.operator is None else self.operator.snapshot(),
            recorder=self.recorder.snapshot(),
            outcome=self.outcome,
            events=tuple(self.events),
            agenda=tuple(self._agenda),
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this simulator; the run then repeats to the last bit."""
        self.rig.restore(snapshot.rig)
        self.computers.restore(snapshot.computers)
        if self.operator is not None and snapshot.operator is not None:
            self.operator.restore(snapshot.operator)
        self.recorder.restore(snapshot.recorder)
        self.outcome = snapshot.outcome
        self.events, self._agenda = list(snapshot.events), list(snapshot.agenda)

    def _settle(self) -> None:
        code = settle(self.rig, self.computers, self._standing, self.recorder.log)
        forget_range(self.rig.laws)
        if code != RUNNING:
            self._left_limits(code)
            return
        self.events += settling_events(self.rig, self.scenario)
        if self.operator is not None:
            self.events += self.operator.begin()
        late = self._overrun(None)
        if late:
            self.end(Outcome.OVERRUN, late)

    def _overrun(self, begun: float | None) -> str | None:
        parameters = self.plant.parameters
        return overrun(self.scenario, self._emulated, self.rig.clock, parameters, begun)

    def _left_limits(self, code: int) -> None:
        when = f"at {self.time:.3f} s" if self.rig.tick > 0 else "while settling"
        self.end(OUTCOME_OF_CODE[code], f"the rig left its limits {when}")

    def _note_agenda(self) -> None:
        """What was planned for the time since the last look becomes an event."""
        while self._agenda and self._agenda[0].time <= self.time:
            self.events.append(self._agenda.pop(0))

    def _compiled_cycles(self, count: int, samples: Block) -> int:
        """Run cycles of so many ticks without the interpreter, or the first of them; how many."""
        rig, recorder = self.rig, self.recorder
        count = min(count, self._longest)
        if count == 0:
            return 0
        computers = self.computers.compiled(rig.tick, count, rig.clock)
        if computers is None:
            return 0
        notes = recorder.notes()
        code, _, rows, cycles = rig.run_cycles(count, notes, samples, computers)
        recorder.noted(rows, cycles)
        if code != RUNNING:
            self._left_limits(code)
        return cycles - notes[-1]

    def _interrupt(self) -> bool:
        """The clock interrupt of the computers; False if it ends the run."""
        rig, period = self.rig, self.rig.clock.admittance
        late = None
        if self.scenario.platform.busy and rig.tick > 0:
            late = self._overrun((rig.tick - period) * rig.clock.tick)
        operator = self.operator
        why = self._cycle(late) if operator is None else self._operated(operator, late)
        if why:
            self.end(*why)
            return False
        self.recorder.begin_cycle(rig.tick, self.computers.points)
        return True

    def _cycle(self, late: str | None) -> tuple[Outcome, str] | None:
        """The computers' cycle, and what ends the run there."""
        if late:
            return Outcome.OVERRUN, late
        outside = self.computers.cycle(self.rig.tick, self.rig.time)
        if not outside:
            return None
        message = f"the command of leg {outside} left the safety margin; not sent"
        return Outcome.LEG_LIMIT, message

    def _operated(self, operator: Operator, late: str | None) -> tuple[Outcome, str] | None:
        """The same where operators look after it: the platform freezes, the run goes on."""
        events, hit = operator.cycle(self.rig.tick, self.rig.time, late or "")
        self._note_agenda()
        self.events += events
        return (Outcome.CEILING, hit) if hit else None


def _at_rest(scenario: Scenario, operator: Operator | None) -> Scenario:
    """The scenario with the platform where operators leave it before t = 0."""
    if operator is None:
        return scenario
    start = tuple(map(float, operator.standing))
    platform = scenario.platform.model_copy(update={"start": start})
    return scenario.model_copy(update={"platform": platform})
