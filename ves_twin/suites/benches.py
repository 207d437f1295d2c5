"""bench_of: the generator of a plant."""

from __future__ import annotations

from ves_twin.suites.bench import BlindBench
from ves_twin.suites.suite import check_bench


def bench_of(name: str) -> BlindBench:
    """The generator of a plant.

    Raises:
        UnknownNameError: no such plant.
    """
    from ves_twin.suites.pendulum import BlindPendulum
    from ves_twin.suites.rig import BlindVes2

    check_bench(name)
    if name == "pendulum":
        return BlindPendulum()
    return BlindVes2("ves2_pressure_fast" if name == "ves2_fast" else "ves2_pressure")
