"""Simulator: a rig under a scenario, advanced as far as asked, with snapshots."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import mujoco
import numpy as np

from ves_twin.plant.assembly import assemble, compile_model
from ves_twin.plant.layout import Layout
from ves_twin.plant.plant import Plant
from ves_twin.recording.recording import Event
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.blocks import STATE, parameter_block
from ves_twin.simulator.board import Board
from ves_twin.simulator.build import (
    agenda_of,
    belief_of,
    build_computers,
    build_references,
)
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.codes import RUNNING
from ves_twin.simulator.computers import ComputersSnapshot
from ves_twin.simulator.engine import address_of, handles
from ves_twin.simulator.loop import run_ticks
from ves_twin.simulator.noise import NoiseStreams
from ves_twin.simulator.outcome import OUTCOME_OF_CODE, Outcome
from ves_twin.simulator.recorder import MemorySink, Recorder, RecorderSnapshot, Sink
from ves_twin.simulator.settle import settle
from ves_twin.types import Block


@dataclass(frozen=True)
class Snapshot:
    """Everything that a run depends on, at one instant."""

    tick: int
    outcome: Outcome | None
    events: tuple[Event, ...]
    agenda: tuple[Event, ...]
    data: mujoco.MjData
    state: Block
    board: Block
    computers: ComputersSnapshot
    recorder: RecorderSnapshot


class Simulator:
    """The rig of a plant under a scenario, settled and ready at t = 0.

    Attributes:
        plant: the world.
        scenario: what is done with it.
        seed: seed of the noise.
        clock: periods of the loops.
        model: the compiled MuJoCo model.
        data: its live state.
        layout: where the rig's quantities lie in it.
        board: every signal at this instant.
        outcome: None while running.
        events: what happened so far.

    Args:
        plant: the world; the scenario's own plant and parameters if left out.
        scenario: what is done with it.
        seed: seed of the noise; the scenario's own if left out.
        sink: where rows go; kept in memory if left out.

    Raises:
        VesTwinError: the scenario cannot be built: unknown name, pose out of reach.
    """

    def __init__(
        self,
        plant: Plant | None,
        scenario: Scenario,
        seed: int | None = None,
        sink: Sink | None = None,
    ) -> None:
        self.scenario = scenario
        self.plant = plant or plant_of(scenario)
        self.seed = scenario.run.seed if seed is None else seed
        self.clock = Clock.of(scenario, self.plant.parameters)
        self.model = compile_model(assemble(self.plant, self.clock.tick / self.clock.substeps))
        self.data = mujoco.MjData(self.model)
        self.layout = Layout.of(self.model)
        self.board = Board()
        self.outcome: Outcome | None = None
        self.events: list[Event] = []
        belief = belief_of(scenario)
        self.parameters = parameter_block(
            self.plant, self.layout, self.clock, scenario.legs, belief
        )
        self.state: Block = np.zeros(1, STATE)
        self.noise = NoiseStreams(self.seed, scenario.run.noise)
        self.computers = build_computers(self, belief)
        self.recorder = Recorder(
            self.clock,
            belief.geometry,
            np.array(scenario.platform.start),
            build_references(self),
            MemorySink() if sink is None else sink,
        )
        self._step = address_of("mj_step")
        self._handles = handles(self.model, self.data)
        self._arrays = (self.data.qpos, self.data.qvel, self.data.ctrl, self.data.sensordata)
        self._end = self.clock.ticks(scenario.run.duration)
        self._agenda = agenda_of(scenario)
        self.tick = 0
        settle(self)

    @property
    def time(self) -> float:
        """Time since the start of the run [s]."""
        return self.tick * self.clock.tick

    @property
    def done(self) -> bool:
        """Whether the run has ended, by reaching its duration or otherwise."""
        return self.outcome is not None

    def advance(self, seconds: float) -> None:
        """Run on for a time [s], to the nearest tick, or until the run ends."""
        self.run_to(min(self.tick + self.clock.ticks(seconds), self._end))
        self._note_agenda()
        if self.tick >= self._end and self.outcome is None:
            self.end(Outcome.COMPLETED, f"reached {self.time:.3f} s")

    def run_to(self, target: int) -> None:
        """Run up to a tick, with a cycle of the computers at each admittance interrupt."""
        period = self.clock.admittance
        while self.tick < target and self.outcome is None:
            phase = self.tick % period
            if phase == 0 and not self._interrupt():
                return
            self.run_loop(min(period - phase, target - self.tick))

    def run_loop(self, count: int) -> None:
        """Run the compiled loop for some ticks without an interrupt."""
        code, done, self.recorder.rows = run_ticks(
            self.tick,
            count,
            self._step,
            *self._handles,
            *self._arrays,
            self.parameters,
            self.state,
            self.board.block,
            self.board.row,
            *self.noise.window(self.tick, count),
            self.recorder.log,
            self.recorder.rows,
        )
        self.tick += done
        if code != RUNNING:
            self.end(OUTCOME_OF_CODE[code], f"the rig left its limits at {self.time:.3f} s")

    def note(self, kind: str, message: str) -> None:
        """Add an event at the present time."""
        self.events.append(Event(self.time, kind, message))

    def end(self, outcome: Outcome, why: str) -> None:
        """End the run with a named outcome; what was recorded is kept."""
        self.outcome = outcome
        self._note_agenda()
        self.note(outcome.value, why)
        self.recorder.flush()

    def snapshot(self) -> Snapshot:
        """A copy of everything that the rest of the run depends on."""
        return Snapshot(
            tick=self.tick,
            outcome=self.outcome,
            events=tuple(self.events),
            agenda=tuple(self._agenda),
            data=copy.copy(self.data),
            state=self.state.copy(),
            board=self.board.block.copy(),
            computers=self.computers.snapshot(),
            recorder=self.recorder.snapshot(),
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this simulator; the run then repeats to the last bit."""
        mujoco.mj_copyData(self.data, self.model, snapshot.data)
        self.state[:] = snapshot.state
        self.board.block[:] = snapshot.board
        self.computers.restore(snapshot.computers)
        self.recorder.restore(snapshot.recorder)
        self.tick, self.outcome = snapshot.tick, snapshot.outcome
        self.events = list(snapshot.events)
        self._agenda = list(snapshot.agenda)

    def _note_agenda(self) -> None:
        """What was planned for the time since the last look becomes an event."""
        while self._agenda and self._agenda[0].time < self.time:
            self.events.append(self._agenda.pop(0))

    def _interrupt(self) -> bool:
        """The clock interrupt of the computers; False if it ends the run."""
        outside = self.computers.cycle(self.tick, self.time)
        if outside:
            self.end(
                Outcome.LEG_LIMIT, f"the command of leg {outside} left the safety margin; not sent"
            )
            return False
        self.recorder.begin_cycle(self.time, self.state["servo"]["points"][0])
        return True


def plant_of(scenario: Scenario) -> Plant:
    """The scenario's own world: its plant with its parameters."""
    return Plant.load(scenario.plant).with_values(scenario.parameters)
