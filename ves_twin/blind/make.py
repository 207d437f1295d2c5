"""make_suite: recordings with hidden effects in a folder, the truth of each sealed beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from ves_twin.blind.bench import BlindBench, BlindRig
from ves_twin.blind.draw import Loudness, draw_truths
from ves_twin.blind.seal import new_key, seal
from ves_twin.blind.suite import FILE, HELD_OUT, RECORDING, STANDSTILL, Suite, check_bench
from ves_twin.blind.truth import Hidden, Truth
from ves_twin.diagnosis.linearise import linearise
from ves_twin.diagnosis.observe import observe
from ves_twin.diagnosis.whitening import whitening_declared
from ves_twin.errors import FileAccessError, InvalidInputError
from ves_twin.recording.files import save_recording
from ves_twin.recording.recording import Recording, RecordingInfo
from ves_twin.workers import Workers

Progress = Callable[[float, str], None]


def make_suite(
    bench_name: str,
    counts: Mapping[Hidden, int],
    folder: Path,
    key_file: Path,
    seed: int,
    progress: Progress,
    spread: float = 1.0,
    workers: int = 1,
) -> Suite:
    """Write a suite; one that was interrupted goes on where it was.

    Args:
        bench_name: a name of BENCHES.
        counts: cases of each sort.
        folder: for the recordings.
        key_file: takes the key; it is what a diagnosis must not see.
        seed: of everything drawn, and as secret as the key.
        progress: told how far it is.
        spread: commissioning errors, in declared sd.
        workers: processes.

    Raises:
        UnknownNameError: no such plant.
        InvalidInputError: a folder that holds something else.
        FileAccessError: not writable.
    """
    check_bench(bench_name)
    bench = bench_of(bench_name)
    key = _key(folder, key_file)
    root = np.random.default_rng([seed, 1])
    standstill = bench.record(BlindRig(bench.commissioned(root, spread)), "standstill", root)
    save_bare(standstill, folder / STANDSTILL)
    truths = _truths(bench, counts, seed, spread, progress, workers)
    for n, truth in enumerate(truths):
        progress(n / len(truths), "recordings")
        sealed = folder / truth.case / "truth.sealed"
        if not sealed.is_file():
            _record(bench, truth, folder, np.random.default_rng([seed, 2, n]))
            sealed.write_bytes(seal(truth.to_json(), key))
    excluded = {
        t.case: tuple(c.label for c in t.causes)
        for t in truths
        if t.hidden is Hidden.OUTSIDE and t.causes
    }
    suite = Suite(bench_name, tuple(t.case for t in truths), excluded)
    suite.save(folder)
    return suite


def bench_of(name: str) -> BlindBench:
    """The generator of a plant."""
    from ves_twin.blind.pendulum import BlindPendulum
    from ves_twin.blind.rig import BlindVes2

    if name == "pendulum":
        return BlindPendulum()
    return BlindVes2("ves2_pressure_fast" if name == "ves2_fast" else "ves2_pressure")


def _key(folder: Path, key_file: Path) -> str:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if key_file.is_file():
            return key_file.read_text().strip()
        if (folder / FILE).exists() or any(folder.glob("case-*")):
            raise InvalidInputError(str(folder), "cases whose key is missing", "an empty folder")
        key = new_key()
        key_file.write_text(key + "\n")
    except OSError as error:
        raise FileAccessError(f"cannot write {error.filename}: {error.strerror}") from None
    return key


def _truths(
    bench: BlindBench,
    counts: Mapping[Hidden, int],
    seed: int,
    spread: float,
    progress: Progress,
    workers: int,
) -> list[Truth]:
    rng = np.random.default_rng([seed, 0])
    nominal = bench.record(BlindRig(), "train", rng)
    with Workers(workers) as shared:
        runs = observe(bench.forward, [nominal], shared).runs
        base = linearise(runs, runs.origin, progress)
        loudness = Loudness(base, whitening_declared(runs))
        return draw_truths(bench, counts, loudness, rng, spread)


def _record(bench: BlindBench, truth: Truth, folder: Path, rng: np.random.Generator) -> None:
    values = bench.commissioned(rng, truth.spread)
    nominal = {p.name: p.nominal for p in bench.forward.parameters}
    for cause in truth.causes:
        for name, departure in cause.departures.items():
            values[name] = values.get(name, nominal[name]) + departure
    rig = BlindRig(values, truth.outside, truth.outside_size)
    save_bare(bench.record(rig, "train", rng), folder / truth.case / RECORDING)
    save_bare(bench.record(rig, "held_out", rng), folder / truth.case / HELD_OUT)


def save_bare(recording: Recording, path: Path) -> None:
    """Write a recording that tells nothing but what a laboratory would know of it.

    Raises:
        FileAccessError: not writable.
    """
    info = RecordingInfo(
        "measured",
        scenario=recording.info.scenario,
        settings=recording.info.settings,
        log=recording.info.log,
        period=recording.info.period,
        own_signals=recording.info.own_signals,
    )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileAccessError(f"cannot write {path.parent}: {error.strerror}") from None
    save_recording(replace(recording, info=info), path)
