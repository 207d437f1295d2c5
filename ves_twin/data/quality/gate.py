"""quality_gate: every check of a recording, before anything is concluded from it."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.core.recording.recording import Recording
from ves_twin.data.quality.check import Check, Grade
from ves_twin.data.quality.clock_checks import check_clock
from ves_twin.data.quality.value_checks import check_values
from ves_twin.data.quality.weight_checks import check_weight
from ves_twin.data.quality.wiring_checks import check_wiring


@dataclass(frozen=True)
class QualityReport:
    """Answers of all checks.

    Attributes:
        checks: in the order in which they were asked.
    """

    checks: tuple[Check, ...]

    @property
    def failures(self) -> tuple[Check, ...]:
        """Checks that found something wrong."""
        return tuple(check for check in self.checks if check.grade is Grade.FAILED)


def quality_gate(recording: Recording, weight: float | None = None) -> QualityReport:
    """Clock, values, wiring, units and frames of a recording.

    Args:
        recording: simulated or measured.
        weight: of the payload on the force sensor [N]; not checked if left out.
    """
    checks = [*check_clock(recording), *check_values(recording), *check_wiring(recording)]
    if weight is not None:
        checks += check_weight(recording, weight)
    return QualityReport(tuple(checks))
