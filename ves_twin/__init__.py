"""ves_twin: full-physics digital twin of the VES II micro-gravity emulator.

The public names load on first use, so that `import ves_twin` stays quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

__version__ = "0.1.0"

if TYPE_CHECKING:
    from ves_twin.core.errors import VesTwinError
    from ves_twin.core.recording.files import load_recording
    from ves_twin.core.recording.recording import Recording
    from ves_twin.machines.compare import compare
    from ves_twin.machines.design import design
    from ves_twin.machines.diagnose import verdict_on as diagnose
    from ves_twin.machines.machine import Machine
    from ves_twin.machines.plan import plan
    from ves_twin.machines.trend import trend
    from ves_twin.machines.ves2.effects_of import effects_of
    from ves_twin.plant.plant import Plant
    from ves_twin.scenario.schema import Scenario
    from ves_twin.simulator.outcome import Outcome
    from ves_twin.simulator.replay import replay
    from ves_twin.simulator.simulate import record, simulate
    from ves_twin.simulator.simulator import Simulator

_HOMES = {
    "Machine": "ves_twin.machines.machine",
    "Outcome": "ves_twin.simulator.outcome",
    "Plant": "ves_twin.plant.plant",
    "Recording": "ves_twin.core.recording.recording",
    "Scenario": "ves_twin.scenario.schema",
    "Simulator": "ves_twin.simulator.simulator",
    "VesTwinError": "ves_twin.core.errors",
    "compare": "ves_twin.machines.compare",
    "design": "ves_twin.machines.design",
    "diagnose": "ves_twin.machines.diagnose:verdict_on",
    "effects_of": "ves_twin.machines.ves2.effects_of",
    "load_recording": "ves_twin.core.recording.files",
    "plan": "ves_twin.machines.plan",
    "record": "ves_twin.simulator.simulate",
    "replay": "ves_twin.simulator.replay",
    "simulate": "ves_twin.simulator.simulate",
    "trend": "ves_twin.machines.trend",
}

__all__ = [
    "Machine",
    "Outcome",
    "Plant",
    "Recording",
    "Scenario",
    "Simulator",
    "VesTwinError",
    "compare",
    "design",
    "diagnose",
    "effects_of",
    "load_recording",
    "plan",
    "record",
    "replay",
    "simulate",
    "trend",
]


def __getattr__(name: str) -> object:
    if name == "effects":
        return importlib.import_module("ves_twin.effects")
    if name not in _HOMES:
        raise AttributeError(f"module 'ves_twin' has no attribute '{name}'")
    home, _, inner = _HOMES[name].partition(":")
    value = getattr(importlib.import_module(home), inner or name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names, also those that were not used yet, for tab completion."""
    return sorted({*__all__, "__version__", "effects"})
