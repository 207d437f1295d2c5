"""Rig: a compiled plant with its loop: hardware, leg loops, joint servo, force sensor, noise."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from ves_twin.control.belief import Belief
from ves_twin.core.compiled import say_that_it_compiles
from ves_twin.core.engine_log import log_engine
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import Block, FloatArray
from ves_twin.plant.assembly import assemble, compile_model
from ves_twin.plant.layout import Layout
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Legs
from ves_twin.simulator.blocks import STATE, parameter_block
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.cycles import run_cycles, take_sample
from ves_twin.simulator.engine import NO_CALL, address_of, handles
from ves_twin.simulator.law_step import rig_laws
from ves_twin.simulator.loop import run_ticks
from ves_twin.simulator.noise import NoiseStreams
from ves_twin.simulator.recorder import Notes
from ves_twin.simulator.signal_bus import SignalBus
from ves_twin.simulator.truth_port import GravityTruth


@dataclass(frozen=True)
class RigSnapshot(ReadOnly):
    """Mechanics, compiled state, signals and memory of laws at a tick; noise needs no more."""

    tick: int
    data: mujoco.MjData
    state: Block
    board: Block
    laws: tuple[FloatArray, FloatArray]


class Rig:
    """Everything below the admittance cycle.

    Attributes:
        plant: the world.
        clock: periods of the loops.
        model: the compiled MuJoCo model.
        data: its live state.
        layout: where the rig's quantities lie in it.
        parameters: PARAMETERS (1,) of the compiled loop.
        state: STATE (1,) of the compiled loop.
        board: every signal at this instant.
        laws: of the plant, as the compiled loop has them.
        noise: numbers of the noise by tick.
        tick: tick that comes next, negative while settling.

    Args:
        plant: the world.
        clock: periods of the loops.
        legs: gains and filter place of the leg loops.
        belief: what the leg loops take the rig to be.
        noise: numbers of the noise by tick.
    """

    def __init__(
        self, plant: Plant, clock: Clock, legs: Legs, belief: Belief, noise: NoiseStreams
    ) -> None:
        log_engine()
        say_that_it_compiles(run_ticks)
        self.plant = plant
        self.clock = clock
        self.model = compile_model(assemble(plant, clock.tick / clock.substeps))
        self.data = mujoco.MjData(self.model)
        self.layout = Layout.of(self.model)
        self.parameters = parameter_block(plant, self.layout, clock, legs, belief)
        self.state: Block = np.zeros(1, STATE)
        self.board = SignalBus()
        self.noise = noise
        self.tick = 0
        self._engine = (*_step_of(self.layout), *handles(self.model, self.data))
        self.laws = rig_laws(plant.laws, self.data)
        self._arrays: tuple[Any, ...] = (
            self.data.qpos,
            self.data.qvel,
            *self.layout.slide_arrays(self.data),
            self.data.ctrl,
            self.data.sensordata,
            self.laws,
        )
        self._truth = GravityTruth(self.model, self.data, self.layout).arrays

    @property
    def time(self) -> float:
        """Time of the tick that comes next [s]."""
        return self.tick * self.clock.tick

    def run(self, count: int, log: FloatArray, logged: int) -> tuple[int, int]:
        """Run the compiled loop for some ticks, not beyond the next interrupt.

        Args:
            count: how many ticks.
            log: buffer that takes the rows of the log clock from t = 0 on.
            logged: rows in the buffer already.

        Returns:
            Code of `ves_twin.simulator.codes`, and rows in the buffer.
        """
        given = (*self._given(count), log, logged)
        code, done, logged = run_ticks(self.tick, count, *given)
        self.tick += done
        return code, logged

    def run_cycles(
        self, count: int, notes: Notes, samples: Block, computers: tuple[Any, ...]
    ) -> tuple[int, int, int, int]:
        """Run ticks from an interrupt on, with the computers' cycles compiled; see `run_cycles`.

        Args:
            count: how many ticks.
            notes: buffers of the recorder, rows and cycles in them.
            samples: SAMPLE of the end of each cycle, where there is room.
            computers: of `Computers.compiled`, for as many cycles.

        Returns:
            Code of `ves_twin.simulator.codes`; ticks done, fewer where a cycle is for the
            interpreter; rows and cycles in the buffers.
        """
        given = (*self._given(count), *self._truth, *notes, samples, *computers)
        found = run_cycles(self.tick, count, *given)
        self.tick += found[1]
        return found

    def _given(self, count: int) -> tuple[Any, ...]:
        """What both loops take of the rig, with the noise of the next ticks."""
        return (
            *self._engine,
            *self._arrays,
            self.parameters,
            self.state,
            self.board.block,
            self.board.row,
            *self.noise.window(self.tick, count),
        )

    def sample(self, samples: Block) -> None:
        """Write how the rig stands now into the first SAMPLE of an array, if it has one."""
        if len(samples):
            take_sample(samples, self.time, self.data.qpos, self.parameters, self.board.block)

    def snapshot(self) -> RigSnapshot:
        """A copy of everything that the next tick depends on."""
        return RigSnapshot(
            self.tick,
            copy.copy(self.data),
            self.state.copy(),
            self.board.block.copy(),
            (self.laws.efforts.memory.copy(), self.laws.readings.memory.copy()),
        )

    def restore(self, snapshot: RigSnapshot) -> None:
        """Go back to a snapshot of this rig."""
        mujoco.mj_copyData(self.data, self.model, snapshot.data)
        self.state[:] = snapshot.state
        self.board.block[:] = snapshot.board
        self.laws.efforts.memory[:], self.laws.readings.memory[:] = snapshot.laws
        self.tick = snapshot.tick


def _step_of(layout: Layout) -> tuple[int, int]:
    """Addresses of the two functions that advance the physics by a step.

    Tendon lengths belong to the last computed position, so `fast` ends a step with the position
    stage of the next one: mj_step2, mj_step1 in place of mj_step, which is their sum.
    """
    if layout.tendons:
        return address_of("mj_step2"), address_of("mj_step1")
    return address_of("mj_step"), NO_CALL
