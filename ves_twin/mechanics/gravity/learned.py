"""LearnedGravity: the gravity wrench of one planned experiment, cycle by cycle, as a file."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from ves_twin.core.arrow_file import arrow_file
from ves_twin.core.errors import FileAccessError, InvalidInputError, VersionError, one_line
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import whole_file

SCHEMA = 1

KEY = b"ves_twin_learned_gravity"
"""Key of the file's metadata."""

SAME_COMMAND = 1e-6
"""Largest difference of two joint commands that count as the same [rad]: a hundredth of a count."""

WRENCH = ("fx", "fy", "fz", "mx", "my", "mz")
JOINTS = ("q1", "q2", "q3")


@dataclass(frozen=True)
class PlannedExperiment(ReadOnly):
    """What W_g belongs to: it holds for these commands on this emulated system and no other.

    Attributes:
        sensor: identity of the force sensor.
        system: name and identity of the emulated system.
        start: platform pose at the start [m, rad].
        period: of the admittance cycle [s].
        commands: joint angles asked for at each cycle [rad] (n, 3).
    """

    sensor: str
    system: str
    start: tuple[float, ...]
    period: float
    commands: FloatArray


@dataclass(frozen=True)
class LearnedGravity(ReadOnly):
    """W_g(s) of the Learning Method in sensor axes, in the time of the full-speed motion.

    Attributes:
        wrenches: one a cycle [N, N m] (n, 6).
        experiment: what it belongs to.
        source: where it comes from, for people.

    Source: thesis 3.3.1, phase A.
    """

    wrenches: FloatArray
    experiment: PlannedExperiment
    source: str

    @staticmethod
    def load(path: str) -> LearnedGravity:
        """Read a file.

        Raises:
            FileAccessError: missing or unreadable.
            InvalidInputError: not such a file, or numbers that are not finite.
            VersionError: another version of the format.
        """
        try:
            with arrow_file(path) as file:
                table = pq.read_table(file)
        except OSError as error:
            raise FileAccessError(f"gravity.file {path}: {one_line(error)}") from None
        except pa.ArrowException as error:
            raise InvalidInputError("gravity.file", one_line(error), _A_FILE) from None
        try:
            head = json.loads((table.schema.metadata or {})[KEY])
            if head["schema"] != SCHEMA:
                raise VersionError(path, head["schema"], SCHEMA)
            wrenches, commands = (
                np.column_stack([table.column(name).to_numpy() for name in names]).astype(float)
                for names in (WRENCH, JOINTS)
            )
            experiment = PlannedExperiment(
                sensor=str(head["sensor"]),
                system=str(head["system"]),
                start=tuple(map(float, head["start"])),
                period=float(head["period"]),
                commands=commands,
            )
        except (KeyError, TypeError, ValueError) as error:
            raise InvalidInputError(f"gravity.file {path}", one_line(error), _A_FILE) from None
        if len(wrenches) == 0 or not np.all(np.isfinite(wrenches)):
            raise InvalidInputError(f"gravity.file {path}", "wrenches", "finite ones")
        return LearnedGravity(wrenches, experiment, str(head.get("source", "")))

    def save(self, path: Path) -> None:
        """Write the file; what was there is replaced only when the new one is whole."""
        head = {"schema": SCHEMA, "source": self.source, **asdict(self.experiment)}
        del head["commands"]
        columns = {"t": np.arange(len(self.wrenches)) * self.experiment.period}
        columns |= dict(zip(WRENCH, self.wrenches.T, strict=True))
        columns |= dict(zip(JOINTS, self.experiment.commands.T, strict=True))
        table = pa.table({name: pa.array(values) for name, values in columns.items()})
        with whole_file(path) as partial, partial.open("wb") as file:
            pq.write_table(table.replace_schema_metadata({KEY: json.dumps(head)}), file)

    def check(self, planned: PlannedExperiment) -> None:
        """Raise InvalidInputError unless it was learned for this experiment."""
        learned = self.experiment
        for what, came, expected in (
            ("sensor", learned.sensor, planned.sensor),
            ("emulated system", learned.system, planned.system),
        ):
            if came != expected:
                raise InvalidInputError("gravity.file", f"W_g of {what} {came}", f"of {expected}")
        if abs(learned.period - planned.period) > 1e-9:  # round-off of a product of ticks
            rates = [f"{1.0 / period:.3f} Hz" for period in (learned.period, planned.period)]
            raise InvalidInputError("gravity.file", f"W_g at {rates[0]}", f"at {rates[1]}")
        if not np.allclose(learned.start, planned.start, rtol=0.0, atol=SAME_COMMAND):
            came = f"W_g from the start pose {list(learned.start)}"
            raise InvalidInputError("gravity.file", came, f"from {list(planned.start)}")
        count = len(planned.commands)
        if len(learned.commands) < count:
            lengths = [f"{n * planned.period:.3f} s" for n in (len(learned.commands), count)]
            raise InvalidInputError("gravity.file", f"W_g of {lengths[0]}", f"of {lengths[1]}")
        off = np.abs(learned.commands[:count] - planned.commands)
        if np.max(off) > SAME_COMMAND:
            row, joint = np.unravel_index(int(np.argmax(off)), off.shape)
            when = f"{row * planned.period:.3f} s"
            came = f"W_g of another motion: joint {joint + 1} differs by {off[row, joint]:.3g} rad"
            raise InvalidInputError("gravity.file", f"{came} at {when}", "that of this motion")


_A_FILE = "a file written by the Learning Method (ves-twin run beam_learning_method)"
