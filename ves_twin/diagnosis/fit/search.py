"""Search: down to the most probable point, by a Jacobian that learns from its own runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray, IntArray, SingleArray
from ves_twin.diagnosis.bank.inner import inner
from ves_twin.diagnosis.bank.linearise import GUESS, Linearisation
from ves_twin.diagnosis.record.evidence import Evidence

ITERATIONS = 40
"""Steps at most from one linearisation."""

NEAR_END = 1e-3
"""Share of what a number may move by within which of an end it is held there: as a clipped step
leaves it, or one that crept up to it."""

FARTHEST = 30.0
"""Nuisances are held within this many commissioning sd: a search that leaves them is lost."""

CONVERGED = 0.02
"""Fall of chi^2 that is not worth another run; names turn on differences of 9 and more."""

RELATIVE_CONVERGENCE = 1e-4
"""The same as a share of chi^2: what is lost and won by chance where parts stick and slip."""

NONLINEAR_CHI2 = 2.0
"""Squared residual per sample from which a search that stalls is gone on with at the priors' own
weight."""

BETTER_FITS = "better fits"
"""What a search leaves out that ends early."""

PRIOR_WEIGHT_RATIO = 10.0
"""Times that weight, which is tried beside it: a long step may end where the legs hunt, and no
column points back from there."""

SECANT = 0.25
"""Step of a cause's own column, of its size, to either side. A rig that sticks and slips answers 1
to 5 sigma off by chance: over 4 % of a cause of 20 sigma its column would be that alone."""

UPDATE_TOLERANCE = 0.01
"""Squared error [sigma^2] of a predicted change above which the Jacobian is turned: single
precision makes 1e-6 of it, and a smaller error moves no estimate."""

CHANCE = 25.0
"""Squared change of a prediction [sigma^2] from which the columns learn half as much: a rig that
sticks and slips answers some 5 sigma off by chance, whatever the move."""

STILL = 10.0
"""Times its last fall that a search may still fall, where each is nine tenths of the one before."""

DAMPING = 10.0
"""First weight, and growth of the weight, that a step which did not help adds to the priors: a
strong commissioning error that is a little off its column leaks into weak ones, many sd of them."""

GAIN_RATIO = 0.25
"""Found over foretold fall of chi^2 from which a step counts as foretold (Marquardt's ratio)."""

ATTEMPTS = 4
"""Dampings that are tried before a search ends."""


@dataclass(frozen=True)
class CauseColumns:
    """Columns of the causes as a search left them, its runs having turned them.

    Attributes:
        columns: change of the channels for one `unit` of each free parameter (k, rows, c).
        unit: of each: half the span over which the column was computed (k,).
        about: departures in its middle (k,).
    """

    columns: SingleArray
    unit: FloatArray
    about: FloatArray

    def hold(self, sizes: FloatArray) -> bool:
        """Whether all sizes are within the spans."""
        return bool(np.all(np.abs(sizes - self.about) <= self.unit))


@dataclass(frozen=True)
class Point:
    """Where a search is.

    Attributes:
        shift: departures (coordinates,).
        delta: share of the discretisation column.
        prediction: channels there (rows, c), without that share.
        residual: whitened (samples,).
        chi2: with the priors' part.
    """

    shift: FloatArray
    delta: float
    prediction: SingleArray
    residual: FloatArray
    chi2: float


@dataclass(frozen=True)
class _Step:
    """Where to, and chi^2 there by the linear model."""

    shift: FloatArray
    delta: float
    foretold: float


class Search:
    """Gauss-Newton in whitened space; the Jacobian follows the runs it makes anyway (Broyden).

    J has a column for each free parameter, for one sd of each nuisance, and for delta. After a
    move m that changed the prediction by c instead of J m it becomes J + (c - J m) (B m)' / m'B m,
    with B the squares of what the columns may be off by: the difference between a run and its
    linear prediction updates the nonlinear columns, the others stay. They are updated before
    whitening too, for whoever goes on from the fit, with another noise or another cause.

    Source: Broyden 1965, the good update, with weights: the most probable J if its columns' errors
    are independent and normal with the covariance B.
    """

    def __init__(
        self,
        evidence: Evidence,
        free: IntArray,
        local: Linearisation,
        farthest: float = FARTHEST,
        enough: float = RELATIVE_CONVERGENCE,
        steps: int = ITERATIONS,
        target: float = np.inf,
    ) -> None:
        runs = evidence.runs
        self.enough, self.steps, self.target = enough, steps, target
        self.evidence, self.runs, self.free, self.local = evidence, runs, free, local
        self.kept = np.flatnonzero(~np.isin(runs.nuisances, free))
        self.nuisances = runs.nuisances[self.kept]
        self.axes = np.concatenate([free, self.nuisances])
        self.turned = local.columns.copy()
        picked = local.columns[[*self.kept, len(runs.nuisances)]]
        self.columns = evidence.whitening.apply(picked).T
        adds = [runs.coordinates[i].parameter.additive for i in self.nuisances]
        self.known = np.append(np.flatnonzero(adds), len(adds))
        basis = self.columns[:, self.known]
        self.solved = np.linalg.inv(inner(basis, basis) + np.eye(len(self.known)))
        self.low = runs.low.copy()
        self.high = runs.high.copy()
        reach = farthest * runs.sd[self.nuisances]
        self.low[self.nuisances] = np.maximum(self.low[self.nuisances], -reach)
        self.high[self.nuisances] = np.minimum(self.high[self.nuisances], reach)
        self.damping = 0.0
        self.unit = np.ones(len(free) + len(self.nuisances) + 1)
        self.unit[len(free) : -1] = runs.sd[self.nuisances]
        self.bends = np.append(np.zeros(len(free)), local.bends[[*self.kept, len(runs.nuisances)]])
        self.bends[len(free) + self.known] = 0.0  # those columns are right
        self.own = [np.append(np.isin(self.axes, own), True) for own in runs.own]

    def at(self, shift: FloatArray, delta: float) -> Point:
        """The best point that differs from a given one by what only adds to the channels.

        Of that the answer is known without a run, and what zeroing leaves, for one, is another
        wherever friction happens to hold differently.
        """
        prediction = self.runs.one(shift)
        if not np.all(np.isfinite(prediction)):
            return Point(shift, delta, prediction, np.zeros(0), np.inf)
        columns = self.local.columns
        difference = self.evidence.measured - prediction - np.float32(delta) * columns[-1]
        residual = self.evidence.whitening.apply(difference)
        sds, axes = self.runs.sd[self.nuisances], self.known[:-1]
        here = np.append(shift[self.nuisances] / sds, delta)
        basis = self.columns[:, self.known]
        there = here.copy()
        there[self.known] += self.solved @ (basis.T @ residual - here[self.known])
        moved = shift.copy()
        moved[self.nuisances] = there[:-1] * sds
        moved = np.clip(moved, self.low, self.high)
        there[:-1] = moved[self.nuisances] / sds
        change = (there - here)[self.known]
        added = np.tensordot(change[:-1].astype(np.float32), columns[self.kept[axes]], axes=1)
        residual = residual - basis @ change
        chi2 = float(residual @ residual + there @ there)
        return Point(moved, float(there[-1]), prediction + added, residual, chi2)

    def jacobian(self, point: Point) -> FloatArray:
        """Columns at a point: free parameters over a quarter of their size, nuisances as given."""
        raw, every = [], [self._ends(point.shift, int(i)) for i in self.free]
        rows = self.runs.many([end for ends in every for end in ends])
        for n, (i, ends) in enumerate(zip(self.free, every, strict=True)):
            stacks = list(rows[2 * n : 2 * n + 2])
            for side, stack in enumerate(stacks):
                if not np.all(np.isfinite(stack)):  # the plant fails there: from the other side
                    ends[side], stacks[side] = point.shift, point.prediction
            self.unit[n] = 0.5 * (ends[1][i] - ends[0][i]) or 1.0
            raw.append(np.float32(0.5) * (stacks[1] - stacks[0]))
        self.raw = np.array(raw, np.float32).reshape(-1, *point.prediction.shape)
        self.about = point.shift[self.free]
        return self._with_causes()

    def held(self, shift: FloatArray) -> IntArray:
        """Nuisances that moved to an end of what is allowed, which holds them: coordinates."""
        near = NEAR_END * (self.high - self.low)
        at_end = (shift <= self.low + near) | (shift >= self.high - near)
        moved = np.abs(shift) > near
        return np.asarray(self.nuisances[(at_end & moved)[self.nuisances]])

    @property
    def of_causes(self) -> CauseColumns:
        """Columns of the causes as they are now."""
        return CauseColumns(self.raw, self.unit[: len(self.free)], self.about)

    def _with_causes(self) -> FloatArray:
        """Columns of the causes and of the nuisances, whitened."""
        if not len(self.free):
            return self.columns.copy()
        free = self.evidence.whitening.apply(self.raw).T
        self.bends[: len(self.free)] = GUESS * np.linalg.norm(free, axis=0)
        return np.concatenate([free, self.columns], axis=1)

    def _ends(self, shift: FloatArray, axis: int) -> list[FloatArray]:
        """To either side, as far as bounds let: a short step would see chance, not slope."""
        reach = max(SECANT * abs(shift[axis]), 0.3 * self.runs.sd[axis])
        reach = max(reach, 1e-5 * (self.high[axis] - self.low[axis]))
        below, above = shift.copy(), shift.copy()
        below[axis] = max(shift[axis] - reach, self.low[axis])
        above[axis] = min(shift[axis] + reach, self.high[axis])
        return [below, above]

    def hessian(self, jacobian: FloatArray, weight: float = 1.0) -> FloatArray:
        """J'J and the priors, which causes have none of."""
        prior = np.full(len(self.unit), weight)
        prior[: len(self.free)] = 0.0
        return np.asarray(inner(jacobian, jacobian) + np.diag(prior))

    def run(self, point: Point, before: CauseColumns | None = None) -> tuple[Point, FloatArray]:
        """The best point, and the Jacobian there.

        Args:
            point: to begin at.
            before: columns of the causes, which serve where they hold.
        """
        if not np.isfinite(point.chi2):
            return point, np.zeros((0, len(self.unit)))
        self.tempered = True
        return self.descend(point, self.begun(point, before))

    def begun(self, point: Point, before: CauseColumns | None) -> FloatArray:
        """The Jacobian at a point, by earlier columns of the causes if they hold there."""
        if before is None or not before.hold(point.shift[self.free]):
            return self.jacobian(point)
        self.unit[: len(self.free)], self.about = before.unit, before.about
        self.raw = before.columns.copy()
        return self._with_causes()

    def descend(self, point: Point, jacobian: FloatArray) -> tuple[Point, FloatArray]:
        """From a point with its Jacobian down to the best one.

        One step is taken where no time is left, too: the Jacobian was dear, and where causes are
        linear that step is all.
        """
        self.damping = 0.0  # what another Jacobian's steps were worth says nothing of these
        for step in range(self.steps):
            if step and self.runs.budget.skips(BETTER_FITS):
                break
            found = self._step(point, jacobian)
            fall = point.chi2 - found.chi2
            point = found
            ended = fall < CONVERGED + self.enough * point.chi2
            if ended or STILL * fall < point.chi2 - self.target:
                if not self.tempered or self._prior_weight(point) < NONLINEAR_CHI2:
                    break
                self.tempered = False
        return point, jacobian

    def _prior_weight(self, point: Point) -> float:
        """Squared residual per sample: while it is far above one the model is not yet linear."""
        if not self.tempered:
            return 1.0
        return max(1.0, float(point.residual @ point.residual) / len(point.residual))

    def _step(self, point: Point, jacobian: FloatArray) -> Point:
        """The next point, or the same one if none is better; updates the Jacobian in place.

        While the residual is n times noise, the priors weigh n^2: what strong commissioning errors
        bend would else drive weak ones tens of sd away, from where few searches come back.

        Source: Marquardt 1963, with the priors' own unit as the scale of the damping; Bakushinskii
        1992, the iteratively regularised Gauss-Newton method, for the weight of the priors.
        """
        prior = self._prior_weight(point)
        for attempt in range(ATTEMPTS):
            far = attempt == 0 and prior > NONLINEAR_CHI2
            weights = (prior, PRIOR_WEIGHT_RATIO * prior) if far else (prior,)
            steps = [self._proposed(point, jacobian, weight) for weight in weights]
            trials = [self.at(step.shift, step.delta) for step in steps]
            for trial in trials:
                self._learn(point, trial, jacobian)
            best = int(np.argmin([trial.chi2 for trial in trials]))
            if trials[best].chi2 < point.chi2:
                self._trust(point.chi2 - trials[best].chi2, point.chi2 - steps[best].foretold)
                return trials[best]
            self.damping = DAMPING * max(self.damping, 1.0)
        return point

    def _proposed(self, point: Point, jacobian: FloatArray, weight: float) -> _Step:
        """Where the linear model has its best, the priors weighing so much."""
        axes = self.axes
        here = np.append(point.shift[axes], point.delta) / self.unit
        prior = np.where(np.arange(len(here)) < len(self.free), 0.0, here)
        hessian = self.hessian(jacobian, weight + self.damping)
        scale = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-30))
        scaled = hessian * np.outer(scale, scale) + 1e-10 * np.eye(len(scale))
        gradient = jacobian.T @ point.residual - weight * prior
        there = here + scale * np.linalg.solve(scaled, scale * gradient)
        left, nu = point.residual - jacobian @ (there - here), there[len(self.free) :]
        shift = point.shift.copy()
        shift[axes] = (there * self.unit)[:-1]
        foretold = float(left @ left + nu @ nu)
        return _Step(np.clip(shift, self.low, self.high), float(there[-1]), foretold)

    def _trust(self, fall: float, hoped: float) -> None:
        """Less damping where the linear model foretold the fall; the same where it did not."""
        if fall > GAIN_RATIO * hoped:
            self.damping = self.damping / DAMPING if self.damping > DAMPING else 0.0

    def _learn(self, point: Point, trial: Point, jacobian: FloatArray) -> None:
        if not np.isfinite(trial.chi2):
            return
        there = np.append(trial.shift[self.axes], trial.delta)
        move = (there - np.append(point.shift[self.axes], point.delta)) / self.unit
        surprise = point.residual - trial.residual - jacobian @ move
        change = trial.prediction - point.prediction
        samples, rows = self.evidence.whitening.samples, self.runs.slices
        for own, here, raw in zip(self.own, samples, rows, strict=True):
            part = surprise[here]
            if part @ part <= UPDATE_TOLERANCE:
                continue
            turning = self.bends**2 * move * own
            share = turning / (turning @ move + CHANCE)
            moved = np.flatnonzero(share)
            jacobian[here, moved] += np.outer(part, share[moved])
            self._turn(raw, change[raw], np.where(own, move, 0.0), share)

    def _turn(self, rows: slice, change: SingleArray, move: FloatArray, share: FloatArray) -> None:
        """The same before whitening; only what belongs to the nuisances is kept."""
        here, share = move.astype(np.float32), share.astype(np.float32)
        count = len(self.free)
        moved = np.flatnonzero(here[count:-1])
        kept = self.kept[moved]
        change = change - np.tensordot(here[:count], self.raw[:, rows], axes=1)
        change -= np.tensordot(here[count:-1][moved], self.turned[kept, rows], axes=1)
        self.raw[:, rows] += share[:count, None, None] * change
        self.turned[kept, rows] += share[count:-1][moved, None, None] * change
