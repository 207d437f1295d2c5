"""RecordEpisodes: episodes on disk, as recordings and rerun files."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Any, final

import gymnasium as gym
from gymnasium.utils import RecordConstructorArgs

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.held_folder import hold_folder
from ves_twin.core.recording.files import save_recording
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.envs.rig_env import rig_env
from ves_twin.simulator.recorder import MemorySink
from ves_twin.simulator.simulate import recording_info


@final
class RecordEpisodes(
    gym.Wrapper[FloatArray, FloatArray, FloatArray, FloatArray], RecordConstructorArgs
):
    """Writes `episode-0001.parquet`, ... and, if asked, `.rrd` beside it, as `ves-twin view` reads.

    An episode is written when it ends, or as unfinished when the next one begins.

    Args:
        env: an environment of this room.
        folder: where to; made if it is missing, and no other program's until `close`.
        every: write each of so many episodes, from the first one on.
        rrd: whether to write rerun files too.
    """

    def __init__(
        self,
        env: gym.Env[FloatArray, FloatArray],
        folder: str | Path,
        every: int = 1,
        rrd: bool = False,
    ) -> None:
        RecordConstructorArgs.__init__(self, folder=str(folder), every=every, rrd=rrd)
        super().__init__(env)
        if every < 1:
            raise InvalidInputError("every", every, "1 or more")
        self._inner, self._folder, self._every, self._rrd = rig_env(env), Path(folder), every, rrd
        self._held = ExitStack()
        self._held.enter_context(hold_folder(self._folder))
        self._count, self._sink = 0, None

    _sink: MemorySink | None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Write what was left unfinished, then begin."""
        self._write()
        keeps = self._count % self._every == 0
        self._inner.sink = MemorySink() if keeps else None
        begun = self.env.reset(seed=seed, options=options)
        self._sink, self._count = self._inner.sink if keeps else None, self._count + 1
        return begun

    def step(self, action: FloatArray) -> tuple[FloatArray, Any, bool, bool, dict[str, Any]]:
        """Step, and write at the end of an episode."""
        result = self.env.step(action)
        if result[2] or result[3]:
            self._write()
        return result

    def close(self) -> None:
        """Write what was left unfinished."""
        self._write()
        self._inner.sink = None
        self._held.close()
        super().close()

    def _write(self) -> None:
        if self._sink is None:
            return
        sink, self._sink = self._sink, None
        sim = self._inner.sim
        sim.recorder.flush(unfinished=True)
        time, signals = sink.collect()
        if not len(time):
            return
        recording = Recording(time, signals, recording_info(sim))
        path = self._folder / f"episode-{self._count:04d}.parquet"
        save_recording(recording, path)
        if self._rrd:
            from ves_twin.report.rerun.write import write_rrd

            write_rrd(recording, path.with_suffix(".rrd"))
