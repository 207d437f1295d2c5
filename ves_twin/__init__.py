"""ves_twin: full-physics digital twin of the VES II micro-gravity emulator.

The public names load on first use, so that `import ves_twin` stays quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

__version__ = "0.1.0"

if TYPE_CHECKING:
    from ves_twin.core.recording.files import load_recording
    from ves_twin.core.recording.recording import Recording
    from ves_twin.machines.ves2.diagnose_rig import effects_of
    from ves_twin.machines.ves2.diagnose_rig import verdict_on as diagnose
    from ves_twin.plant.plant import Plant
    from ves_twin.scenario.schema import Scenario
    from ves_twin.simulator.outcome import Outcome
    from ves_twin.simulator.replay import replay
    from ves_twin.simulator.simulate import record, simulate
    from ves_twin.simulator.simulator import Simulator

_HOMES = {
    "Outcome": "ves_twin.simulator.outcome",
    "Plant": "ves_twin.plant.plant",
    "Recording": "ves_twin.core.recording.recording",
    "Scenario": "ves_twin.scenario.schema",
    "Simulator": "ves_twin.simulator.simulator",
    "diagnose": "ves_twin.machines.ves2.diagnose_rig:verdict_on",
    "effects_of": "ves_twin.machines.ves2.diagnose_rig",
    "load_recording": "ves_twin.core.recording.files",
    "record": "ves_twin.simulator.simulate",
    "replay": "ves_twin.simulator.replay",
    "simulate": "ves_twin.simulator.simulate",
}

__all__ = [
    "Outcome",
    "Plant",
    "Recording",
    "Scenario",
    "Simulator",
    "diagnose",
    "effects_of",
    "load_recording",
    "record",
    "replay",
    "simulate",
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
