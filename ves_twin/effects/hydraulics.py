"""Effects of VES II's hydraulics: servovalves, cylinders, oil supply."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from ves_twin.effects.change import Law, Table
from ves_twin.effects.effect import Effect
from ves_twin.effects.magnitude import Sign
from ves_twin.effects.row import LEGS, RIG, Part, Row
from ves_twin.effects.size import Size

LOOP = ("leg.length", "valve.command")
MANIFOLD = ("supply.pressure", "leg.length")


@final
@dataclass(frozen=True)
class ValveNull(Effect):
    """A spool is open by a share of full opening when its current is zero.

    The leg loop has no integrator, so that the leg stands off by null * full_speed / gain.
    """

    null: float = 0.0

    kind = "valve_null"
    sizes = (Size("null", "1"),)
    source = "servovalve catalogues: null shifts of some tenths of a per cent to 2 %"
    rows = (Row(LEGS, (0.0005, 0.001, 0.05), LOOP, Table("hydraulics.valve_null"), Part.VALVE),)


@final
@dataclass(frozen=True)
class ValveGain(Effect):
    """A valve lets through more flow than its rating: flow (1 + gain) times nominal."""

    gain: float = 0.0

    kind = "valve_gain"
    sizes = (Size("gain", "1"),)
    source = "rated flows are given within 10 %; a per cent after commissioning"
    rows = (
        Row(LEGS, (0.01, 0.02, 0.5), LOOP, Table("hydraulics.valve_gain", Law.SCALE), Part.VALVE),
    )


@final
@dataclass(frozen=True)
class ValveDeadband(Effect):
    """The lands overlap the ports: nothing flows within +-deadband of the null."""

    deadband: float = 0.0

    kind = "valve_deadband"
    sizes = (Size("deadband", "1", Sign.POSITIVE),)
    source = "Merritt 1967, chapter 5; an axis-cut spool has under 1 %"
    proportional = False
    rows = (Row(LEGS, (0.0, 0.0005, 0.05), LOOP, Table("hydraulics.valve_deadband"), Part.VALVE),)


@final
@dataclass(frozen=True)
class ValveLag(Effect):
    """A spool answers more slowly: its time constant is longer by `lag`."""

    lag: float = 0.0

    kind = "valve_lag"
    sizes = (Size("lag", "s", Sign.POSITIVE),)
    source = "assumed; dirt and worn pilots slow a spool by milliseconds"
    proportional = False
    rows = (Row(LEGS, (2e-4, 4e-4, 0.02), LOOP, Table("hydraulics.valve_lag"), Part.VALVE),)


@final
@dataclass(frozen=True)
class PistonLeakage(Effect):
    """Oil passes the piston seal: the leg sags under load by more."""

    leakage: float = 0.0

    kind = "piston_leakage"
    sizes = (Size("leakage", "m^3/s/Pa", Sign.POSITIVE),)
    source = "Merritt 1967, chapter 6; a worn seal"
    rows = (Row(LEGS, (1e-13, 2e-13, 5e-11), LOOP, Table("chamber.leakage"), Part.CYLINDER),)


@final
@dataclass(frozen=True)
class OilAir(Effect):
    """Air in the oil of a leg: its bulk modulus falls to (1 - loss) of nominal."""

    loss: float = 0.0

    kind = "oil_air"
    sizes = (Size("loss", "1", Sign.POSITIVE),)
    source = "Merritt 1967, section 2.2: one per cent of air halves the modulus"
    proportional = False
    rows = (
        Row(
            LEGS,
            (0.02, 0.04, 0.8),
            ("leg.length", "sensor.wrench"),
            Table("chamber.bulk_modulus", Law.LOSE),
            Part.CYLINDER,
        ),
    )


@final
@dataclass(frozen=True)
class SupplyPressure(Effect):
    """The pump is set off its nominal pressure, for all legs alike."""

    pressure: float = 0.0

    kind = "supply_pressure"
    sizes = (Size("pressure", "Pa"),)
    source = "assumed; a relief valve is set within a per cent"
    rows = (Row(RIG, (1e5, 1e5, 3e6), MANIFOLD, Table("supply.pressure"), Part.SUPPLY),)


@final
@dataclass(frozen=True)
class SupplyDroop(Effect):
    """The manifold loses pressure in proportion to what the legs draw: P0 - P = droop Q."""

    droop: float = 0.0

    kind = "supply_droop"
    sizes = (Size("droop", "Pa*s/m^3", Sign.POSITIVE),)
    source = "assumed; a tired pump or a clogged filter, 0.2 to 40 bar at 1 l/s"
    proportional = False
    rows = (Row(RIG, (0.0, 2e7, 4e9), MANIFOLD, Table("supply.droop"), Part.SUPPLY),)
