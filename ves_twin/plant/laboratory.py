"""Laboratory: numbers of pump, ceiling, brakes and ramps, from models/operation/."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.core.resources import find_resource
from ves_twin.core.types import FloatArray
from ves_twin.plant.parameters import parse_parameters, read_plant_file


@dataclass(frozen=True)
class Laboratory:
    """What operating needs beside the plant.

    Attributes:
        run_up: time constant of the manifold after the pump is started [s].
        run_down: the same after it is stopped [s].
        low_pressure: reading below which the computers freeze the platform [Pa].
        watch: how long a start is watched [s].
        ramp_speed: mean speed of the leg that moves farthest in a ramp [m/s].
        sleep_travel: how far every leg is retracted in sleep [m].
        ceiling: height of the ceiling above the top plate at home [m].
        brake: holding torque of the joint brakes [N m] (3,).
        near: how far the arm may be off its command when it is taken over [rad].
    """

    run_up: float
    run_down: float
    low_pressure: float
    watch: float
    ramp_speed: float
    sleep_travel: float
    ceiling: float
    brake: FloatArray
    near: float

    @staticmethod
    def load() -> Laboratory:
        """The laboratory of the thesis, as far as it can be guessed."""
        path = find_resource("laboratory", "models/operation", "laboratory")
        table = parse_parameters(read_plant_file(path), path)
        return Laboratory(
            run_up=table.number("pump.run_up"),
            run_down=table.number("pump.run_down"),
            low_pressure=table.number("manifold.low"),
            watch=table.number("start.watch"),
            ramp_speed=table.number("ramp.speed"),
            sleep_travel=table.number("sleep.travel"),
            ceiling=table.number("ceiling.height"),
            brake=table.array("arm.brake"),
            near=table.number("arm.near"),
        )
