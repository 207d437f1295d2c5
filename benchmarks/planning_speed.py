"""Seconds for a coupling map of 100 x 100 configurations, a planned path and a gain search."""

import time

import numpy as np

from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.coupling_map import coupling_map
from ves_twin.plant.plant import Plant
from ves_twin.plant.puma_chain import puma_chain
from ves_twin.procedures.registry import load_procedure

plant = Plant.load("ves2")
chain = puma_chain(plant)
paths, release = load_procedure("coupling_map_paths"), load_procedure("pped_release")
base = EmulatedSystem.load(paths.emulated)
angles, held = np.linspace(0.0, np.pi / 2, 100), np.zeros(3)
for what, work in (
    (
        "coupling map, 100 x 100",
        lambda: coupling_map(chain, base, (0, 1), angles, angles, np.zeros(3)),
    ),
    ("planned path, 40 x 40 cells", lambda: paths.paths(chain, base)),
    ("gain search by energy, 2 starts", lambda: release.least_energy(plant)),
    ("gain search by estimator, 2 starts", lambda: release.best_estimator(plant)),
):
    start = time.perf_counter()
    work()
    print(f"{what:<36} {time.perf_counter() - start:6.2f} s")
