"""Clock: the periods of all loops, whole numbers of the transducer's tick."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.emulated import Coupling, EmulatedSystem
from ves_twin.plant.parameters import ParameterTable
from ves_twin.scenario.schema import Scenario

LONGEST_CYCLE = 4096
"""Ticks of the longest admittance cycle: one block of noise."""

_CYCLE_TIME = {Coupling.DECOUPLED: 0, Coupling.BEAM: 1, Coupling.COUPLED: 2}


@dataclass(frozen=True)
class Clock:
    """Periods in ticks.

    Attributes:
        tick: transducer period [s].
        substeps: physics steps in a tick.
        leg: leg loop.
        amplifier: servo amplifiers.
        admittance: admittance cycle, also the arm's command cycle.
        log: rows of the recording.
    """

    tick: float
    substeps: int
    leg: int
    amplifier: int
    admittance: int
    log: int

    @staticmethod
    def of(scenario: Scenario, parameters: ParameterTable) -> Clock:
        """Clocks of a scenario; the admittance rate becomes the nearest whole period."""
        tick = parameters.number("clock.tick")
        leg = round(parameters.number("clock.leg_ticks"))
        admittance = max(1, round(1.0 / (scenario.platform.rate * tick)))
        if admittance > LONGEST_CYCLE:
            slowest = 1.0 / (LONGEST_CYCLE * tick)
            raise InvalidInputError(
                "platform.rate", scenario.platform.rate, f"at least {slowest:.3g} Hz at this tick"
            )
        return Clock(
            tick=tick,
            substeps=scenario.run.substeps,
            leg=leg,
            amplifier=round(parameters.number("clock.amplifier_ticks")),
            admittance=admittance,
            log={"admittance": admittance, "leg": leg, "tick": 1}[scenario.run.log],
        )

    @property
    def rate(self) -> float:
        """Real admittance rate [Hz]."""
        return 1.0 / (self.admittance * self.tick)

    def ticks(self, seconds: float) -> int:
        """Whole ticks nearest to a time [s]."""
        return round(seconds / self.tick)


def overrun(
    scenario: Scenario,
    emulated: EmulatedSystem | None,
    clock: Clock,
    parameters: ParameterTable,
    begun: float | None = None,
) -> str | None:
    """Why the interrupt comes before a cycle has ended, or None if it does not.

    Computing time delays nothing here: set-points count as sent at the interrupt, and a cycle that
    takes longer than its period halts the run at the next one.

    Args:
        scenario: whose computer may be busy.
        emulated: the system whose coupling sets the computing time; none takes no time.
        clock: periods.
        parameters: computing times of the plant.
        begun: when the cycle began [s]; None for the usual one.

    Source: thesis 2.4.2 (an overrun halts the experiment); computing times assumed.
    """
    what, needed = "cycle", 0.0
    if emulated is not None:
        what = f"{emulated.coupling} cycle"
        needed = float(parameters.array("clock.cycle_time")[_CYCLE_TIME[emulated.coupling]])
    if begun is not None:
        what += f" begun at {begun:.3f} s"
        needed += sum(
            busy.extra
            for busy in scenario.platform.busy
            if busy.start <= begun < busy.start + busy.duration
        )
    period = clock.admittance * clock.tick
    if needed <= period:
        return None
    return f"a {what} takes {needed * 1e3:.1f} ms, the interrupt comes every {period * 1e3:.1f} ms"
