"""EffortFit: a recorded effort on what the model needs, beside friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray

TELLS = 0.03
"""Share of an effort's power that the model must explain for the sign of its slope to count."""

STRONG = 0.3
"""The same for the size of that slope to count."""

LOADED = 0.2
"""Share of an effort's rms that a steady load is, in the log and in the model, for its sign to
count; and weight against a change by which it would pull the other way, above GAINED: a current
that is turned where a position counts backwards would let a weight push up."""

WORKS = 0.1
"""Share of the most work from which on its sign counts: what springs and masses give back is less
over some periods of a motion."""

MOST = 0.5
"""Share of an effort that the model must explain once its columns are meant otherwise."""

DRIVES = 0.6
"""Share of the most work from which on it decides alone: an effort that is mostly friction pushes
its joint, whatever a model says that lacks it. A pendulum that is swung up has 0.75."""

SPEED = 0.999
"""Share that friction alone explains of a column which is a speed, and no effort."""

TURNS = 0.1
"""Share of the rows in which a joint must move each way for a constant load to be told: assumed."""

FAR = 3.0
"""Factor between an effort and the model's from which on it is told."""


@dataclass(frozen=True)
class EffortFit:
    """Of one effort on what the model needs.

    Attributes:
        slope: s.
        share: of its power that the fit explains.
        gain: what of that the model's effort adds to friction alone.
        work: of the effort along the motion, as a share of the most that it could do.
        free: whether any constant may stand between effort and column.
        against: whether a steady load, as a weight, pulls the other way than the slope says.
        size: rms of the effort over that of what the model needs.
        alone: share of its power that the model explains by itself, the effort turned if need be.
        pushes: whether friction, of the model and beside it, would drive the joint.
    """

    slope: float
    share: float
    gain: float
    work: float
    free: bool
    against: bool
    size: float
    alone: float
    pushes: bool = False

    @property
    def right(self) -> bool:
        """Whether the model, as it is, is right about most of the effort; any constant if free."""
        return self.usable and (self.free or self.alone > MOST)

    @property
    def rubs(self) -> bool:
        """Whether friction explains most of the effort, and the model little of it."""
        return self.gain < STRONG and MOST < self.share - self.gain < SPEED

    @property
    def strange(self) -> bool:
        """Whether the model explains much, by no likely factor, beside friction that brakes."""
        return self.gain > STRONG and not self.usable and not self.pushes

    @property
    def usable(self) -> bool:
        """Whether the slope says something: the model explains a part, and by a likely factor.

        Or most of it by itself, whatever the slope: an arm's wrist may carry three times its own
        mass.
        """
        likely = 1.0 / FAR < abs(self.slope) < FAR or self.alone > MOST
        return self.gain > TELLS and (self.free or likely)

    @property
    def by_slope(self) -> bool:
        """Whether the slope tells the sign, and not the work.

        One joint of several may brake for all of a motion: where the model is right about most of
        the effort, its slope counts.
        """
        return self.usable and (abs(self.work) < DRIVES or self.right)

    @property
    def sign(self) -> int:
        """Of the slope, else of the work: a machine that only takes energy never gives any."""
        if self.by_slope:
            return int(np.sign(self.slope)) or 1
        return -1 if self.work < -WORKS else 1

    @staticmethod
    def of(
        y: FloatArray,
        need: FloatArray,
        speed: FloatArray,
        free: bool,
        brakes: FloatArray | float = 0.0,
    ) -> EffortFit:
        """Fit.

        Args:
            y: recorded (m,).
            need: of the model (m,).
            speed: of the joint (m,).
            free: whether any constant may stand between effort and column.
            brakes: of the need what friction of the model takes (m,).
        """
        friction = friction_columns(speed)
        whole = np.column_stack([need, friction])
        power = float(np.sum((y - y.mean()) ** 2)) or 1.0
        slopes = np.linalg.lstsq(whole, y, rcond=None)[0]
        shares = []
        for basis in (whole, friction):
            rest = y - basis @ np.linalg.lstsq(basis, y, rcond=None)[0]
            shares.append(max(1.0 - float(rest @ rest) / power, 0.0))
        moving = y - carried(y, speed)
        most = float(np.linalg.norm(speed) * np.linalg.norm(moving)) or 1.0
        gain, work = shares[0] - shares[1], float(speed @ moving) / most
        loads = float(slopes[0] * need.mean()), float(y.mean())
        heavy = min(map(abs, loads)) > LOADED * float(np.sqrt(np.mean(y**2)))
        against = gain > TELLS and heavy and loads[0] * loads[1] < 0.0
        size = float(np.sqrt(np.mean(y**2) / max(float(np.mean(need**2)), 1e-300)))
        rubs = friction[:, :2] @ slopes[1:3] + slopes[0] * brakes
        rubbed = float(speed @ rubs) * np.sign(slopes[0])
        alone = 1.0 - min(float(np.var(y - need)), float(np.var(y + need))) * len(y) / power
        pushes = bool(rubbed < -WORKS * most)
        told = float(slopes[0]), shares[0], gain, work, free, against, size, alone, pushes
        return EffortFit(*told)


def carried(effort: FloatArray, speed: FloatArray) -> float:
    """A constant load in an effort (m,), of a joint that turns round: else friction is one, too.

    It does work where a log ends elsewhere than it began, and tells no sign (air on a piston: 245 N
    beside 6 N of friction).
    """
    if min(np.mean(speed > 0.0), np.mean(speed < 0.0)) < TURNS:
        return 0.0
    return float(np.linalg.lstsq(friction_columns(speed), effort, rcond=None)[0][2])


def friction_columns(speed: FloatArray) -> FloatArray:
    """What friction of any size makes of a speed (m,): viscous, dry, and a constant (m, 3)."""
    slow = 0.05 * float(np.std(speed)) or 1.0
    return np.stack([speed, np.tanh(speed / slow), np.ones_like(speed)], axis=1)
