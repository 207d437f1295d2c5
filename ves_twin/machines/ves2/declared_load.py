"""with_load: a recording that says what hung on the arm while it was made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import Role, Signal
from ves_twin.diagnosis.model.forward import Excitation

LOAD = Signal(
    "load.mass", ("",), ("kg",), Role.REFERENCE, "tool", "declared point mass at O3 of the arm"
)
"""Fed in like a set-point, since it may differ from recording to recording of one rig."""


def with_load(recording: Recording, mass: float) -> Recording:
    """The recording with a declared mass [kg] at the end of the forearm."""
    rows = np.full((len(recording), 1), mass)
    own = (*(s for s in recording.info.own_signals if s.name != LOAD.name), LOAD)
    info = replace(recording.info, own_signals=own)
    return replace(recording, signals={**recording.signals, LOAD.name: rows}, info=info)


def loads_of(recordings: tuple[Recording, ...]) -> tuple[Recording, ...]:
    """Recordings with a load of zero where none is declared."""
    return tuple(r if LOAD.name in r.signals else with_load(r, 0.0) for r in recordings)


def load_in(programme: Excitation) -> float:
    """The mass that hangs on the arm while a programme runs [kg]; 0 where none is declared.

    Raises:
        InvalidInputError: a mass that changes on the way, or is none.
    """
    if LOAD.name not in programme.drive:
        return 0.0
    masses = np.asarray(programme.drive[LOAD.name])
    first = float(masses.flat[0])
    if not first >= 0.0 or np.any(masses != first):
        came = f"{np.min(masses):g} to {np.max(masses):g} kg"
        raise InvalidInputError(f"{LOAD.name} of {programme.name}", came, "one mass, 0 kg or more")
    return first
