"""Cause: what a verdict names, with its sizes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ves_twin.core.units import unit_tail

MANY = 6
"""Parameters of a cause that are told one by one."""


@dataclass(frozen=True)
class Estimate:
    """A parameter's value and interval; the interval is of the fault's share of the departure.

    `nominal` is where the departure counts from: the model's value, so that value - nominal holds
    the commissioning error too; with a baseline, what this rig had then. `at_limit`: an end of its
    range, or of 5 sd of its tolerance, holds it there; it stands for something else, and the
    interval counts noise alone. `pull` is the departure in declared sd, of what has a tolerance.
    """

    value: float
    low: float
    high: float
    unit: str
    nominal: float
    at_limit: bool = False
    pull: float | None = None

    @property
    def words(self) -> str:
        """The value with its unit, nominal and interval."""
        return self.told("nominal")

    def told(self, origin: str) -> str:
        """The same; `origin` says what the departure counts from, told where it is not zero."""
        span = f"{self.low:.4g} to {self.high:.4g}"
        base = f"{origin} {self.nominal:.4g}"
        if self.nominal != 0.0:
            base += f", a change of {self.value - self.nominal:.4g}"
        return f"{self.value:.4g}{unit_tail(self.unit)} ({base}; {span})"


@dataclass(frozen=True)
class Cause:
    """One named cause.

    Attributes:
        effect, target: what and where.
        parameters: name -> estimate.
        probability: given the library and that one of its causes, or pairs, is at work.
        firm: False where a commissioning error of `sigmas` declared sd is not excluded, or its size
            may be none, an end of its range holds it, or the clock of a log explains it as well.
        sigmas: largest departure in declared sd, with a baseline in sd of what a rig in order may
            change by since then; None if it is no commissioning parameter.
        below_row: whether it is a delay of less than a row of a log.
        acts_like: causes that a joint which turned round would tell from it.
        ended: whether an end of its range holds a size: it may stand for something else.
    """

    effect: str
    target: str
    parameters: Mapping[str, Estimate]
    probability: float
    firm: bool
    sigmas: float | None
    below_row: bool = False
    acts_like: tuple[str, ...] = ()
    ended: bool = False

    @property
    def shortened(self) -> Cause:
        """With sizes as an effect calls them: "null" for "valve_null@leg.3:null"."""
        short = {name.rpartition(":")[2]: value for name, value in self.parameters.items()}
        return replace(self, parameters=short)

    @property
    def largest(self) -> dict[str, Estimate]:
        """Its parameters, or, of more than MANY, those that depart most."""
        if len(self.parameters) <= MANY:
            return dict(self.parameters)
        ranked = sorted(self.parameters.items(), key=lambda p: -abs(p[1].value - p[1].nominal))
        return dict(ranked[:MANY])
