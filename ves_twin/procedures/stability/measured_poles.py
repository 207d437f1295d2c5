"""measure_poles: poles of the emulation in heave, from how the whole rig moves when released."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from ves_twin.core.types import ComplexArray, FloatArray
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Legs, Scenario
from ves_twin.simulator.linear.admittance_loop import AxisModel
from ves_twin.simulator.simulate import simulate

HEAVE = 2
HEAVY = 4000.0
"""Model mass [kg] and inertia [kg m^2] of the five axes that are not looked at: they stay put."""
LARGEST = 0.08
"""Heave at which a growing motion is cut off [m]: the legs have 0.24 m."""
WEAKEST = 1e-4
"""Share of the strongest part below which a fitted exponential is left out."""
RATE = 150.0
"""Samples that are fitted [Hz]: above twice the highest pole looked for."""

RELEASE = 0.005
"""Heave from which the rig is released [m]."""
DURATION = 2.5
"""Of the run, which a growing motion ends before [s]."""
ORDER = 14
"""Number of exponentials that are fitted."""


def measure_poles(
    plant: Plant,
    legs: Legs,
    model: AxisModel,
    rate: float,
) -> ComplexArray:
    """Release the rig in heave under admittance control, gravity known exactly, without noise.

    Args:
        plant: the world.
        legs: gains and filter place.
        model: emulated base in heave.
        rate: admittance cycles [Hz].

    Returns:
        Poles [1/s] that carry at least WEAKEST of the motion, the strongest first.
    """
    with TemporaryDirectory() as folder:
        file = Path(folder) / "heave_trial.toml"
        file.write_text(_model_file(model), encoding="utf-8")
        changes: dict[str, object] = {
            "legs": legs.model_dump(mode="json"),
            "run.duration": DURATION,
            "run.noise": False,
            "run.log": "tick",
            "platform.emulated": str(file),
            "platform.rate": rate,
            "platform.start": [0.0, 0.0, RELEASE, 0.0, 0.0, 0.0],
        }
        run = simulate(Scenario.load("release_table_5_2", changes), plant)
    heave = run["truth.pose"][:, HEAVE]
    beyond = np.flatnonzero(np.abs(heave) > LARGEST)
    heave = heave[: beyond[0]] if len(beyond) else heave
    every = max(1, round(1.0 / (RATE * run.info.period)))
    return matrix_pencil(heave[::every], every * run.info.period, ORDER)


def matrix_pencil(values: FloatArray, step: float, order: int) -> ComplexArray:
    """Poles s of y(k) = sum R exp(s k h), by the matrix pencil of Hankel matrices.

    Args:
        values: equally spaced samples (n,).
        step: h [s].
        order: number of exponentials.

    Returns:
        Poles [1/s] whose part, where it is largest, is at least WEAKEST of the strongest.

    Source: Hua and Sarkar, IEEE Trans. ASSP 38 (1990) 814.
    """
    n = len(values)
    pencil = n // 3
    hankel = np.lib.stride_tricks.sliding_window_view(values, pencil + 1)
    right = np.linalg.svd(hankel, full_matrices=False)[2][:order].T
    z = np.linalg.eigvals(np.linalg.pinv(right[:-1]) @ right[1:])
    z = z[np.abs(z) > 1e-6]
    powers = z[None] ** np.arange(n)[:, None]
    residues = np.linalg.lstsq(powers, values.astype(complex))[0]
    strength = np.max(np.abs(powers * residues), axis=0)
    order_by = np.argsort(-strength)
    kept = order_by[strength[order_by] > WEAKEST * np.max(strength)]
    return np.asarray(np.log(z[kept]) / step)


def _model_file(model: AxisModel) -> str:
    rows = {}
    for key, own, other in (
        ("mass", model.mass, HEAVY),
        ("damping", model.damping, HEAVY),
        ("stiffness", model.stiffness, HEAVY),
    ):
        values = [other] * 6
        values[HEAVE] = own
        rows[key] = values
    head = (
        'schema = 1\nname = "heave_trial"\ncoupling = "decoupled"\nsource = "trial of one axis"\n'
    )
    return head + "".join(f"{key} = {values}\n" for key, values in rows.items())
