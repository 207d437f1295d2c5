"""ZeroGravityReference: the same arm on the emulated base, without gravity and without the rig.

With Y the base coordinates (X, Y, Z and fixed-axis angles) and q the joints, the base obeys
M Y'' + B Y' + K Y = W, where W is the wrench of the arm about the base origin in inertial axes.
MuJoCo gives the arm's mass matrix H and bias c in the coordinates (Y, q); a generalized force on
the angles is E(phi)' times a moment, so with T = blkdiag(I, E')

    (H_YY + T M) Y'' + H_Yq q'' = -c_Y - T (B Y' + K Y)
    H_qY Y'' + H_qq q''         =  tau - c_q

for any M, B, K, also a non-symmetric B, which no MuJoCo element can hold.
"""

from __future__ import annotations

import mujoco
import numpy as np
from scipy.linalg import block_diag

from ves_twin.control.arm_servo import servo_torque, spline
from ves_twin.core.compiled import compiled
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import Block, ComplexArray, FloatArray, Record
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.kinematics.rotations import rate_matrix
from ves_twin.plant.assembly import assemble_free_arm, compile_model
from ves_twin.plant.plant import Plant
from ves_twin.simulator.engine import address_of, call_engine, handles

SIZE = 33
"""State: base Y (6), Y' (6); platform P (6), P' (6); joints q (3), q' (3), integrator (3)."""

LONGEST_STEP = 3.2e-3
"""Longest RK4 step [s]; halving it changes the beam's motion by micrometres (tested)."""

STABLE_STEP = 2.0
"""Longest RK4 step times the fastest pole; 2.78 is the limit of stability for real poles."""

FASTEST_POLE = 1e5
"""Fastest pole [1/s] that is integrated; a beam of the thesis is near 600."""

PLATFORM_IS_BASE, PLATFORM_LAGS = 0, 1


LAG = np.dtype([("kind", np.int64), ("gain", np.float64), ("lag", np.float64)])
"""kind: whether the platform is the base or follows it through legs of gain [1/s] and lag [s]."""


class ZeroGravityReference:
    """Integrates the reference cycle by cycle with RK4, in lock-step with a run.

    Args:
        plant: whose arm it is.
        emulated: the base.
        servo: parameters of the arm's joint servo, arm_servo.PARAMETERS (1,).
        start: pose of the base at the start, at rest (6,), less home.
        home: platform pose at which the base is at zero (6,).
        legs: None for the ideal emulation. Otherwise (gain, valve lag): the platform follows the
            base as six legs of that bandwidth would, P'' lag + P' = gain (Y - P), and the arm
            feels the platform; everything else stays ideal. The difference to the ideal one is
            what the leg bandwidth alone does to the emulation.
    """

    def __init__(
        self,
        plant: Plant,
        emulated: EmulatedSystem,
        servo: Block,
        start: FloatArray,
        home: FloatArray,
        arm_start: FloatArray,
        legs: tuple[float, float] | None = None,
    ) -> None:
        self._model = compile_model(assemble_free_arm(plant))
        self._data = mujoco.MjData(self._model)
        self._engine = (address_of("mj_fwdPosition"), address_of("mj_fwdVelocity"))
        self._system = (emulated.mass, emulated.damping, emulated.stiffness)
        self._servo = servo
        self._lag = np.zeros(1, LAG)
        if legs is not None:
            self._lag[0] = (PLATFORM_LAGS, *legs)
        self._home = home
        self._state = np.zeros(SIZE)
        self._state[:6] = self._state[12:18] = start - home
        self._state[24:27] = arm_start
        fastest = self._fastest_pole()
        if not fastest < FASTEST_POLE:
            raise InvalidInputError(
                f"emulated system {emulated.name}",
                f"a pole at {fastest:.3g} /s",
                f"poles below {FASTEST_POLE:g} /s, which the zero-g reference can follow",
            )
        self._longest_step = min(LONGEST_STEP, STABLE_STEP / fastest)

    @property
    def pose(self) -> FloatArray:
        """Pose of the platform now, from home [m, rad] (6,)."""
        return self._home + self._state[12:18]

    def advance(
        self, points: FloatArray, cycle: float
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Advance n command cycles.

        Args:
            points: the arm's commands k-1 to k+2 of each cycle [rad] (n, 4, 3).
            cycle: length of a cycle [s].

        Returns:
            At the begin of each cycle and at the end: pose of the platform [m, rad] (n + 1, 6),
            its rate [m/s, rad/s] (n + 1, 6), joint angles [rad] (n + 1, 3).
        """
        steps = int(np.ceil(cycle / self._longest_step))
        states = np.empty((len(points) + 1, SIZE))
        states[0] = self._state
        _advance(
            states,
            points,
            cycle,
            steps,
            self._lag,
            *self._system,
            self._home,
            self._servo,
            *self._engine,
            *handles(self._model, self._data),
            self._data.qpos,
            self._data.qvel,
            self._data.qfrc_bias,
            self._data.qfrc_passive,
            self._data.M,
            self._model.M_rowadr,
            self._model.M_rownnz,
            self._model.M_colind,
        )
        self._state = states[-1].copy()
        return self._home + states[:, 12:18], states[:, 18:24], states[:, 24:27]

    def _fastest_pole(self) -> float:
        """Largest |s| [1/s] of base, arm and servo together, of the bare base, and of the legs."""
        mass, damping, stiffness = self._system
        data = self._data
        data.qpos[6:] = self._state[24:27]
        mujoco.mj_forward(self._model, data)
        full = np.zeros((9, 9))
        mujoco.mj_fullM(self._model, data, full)
        full = full[np.ix_(_ORDER, _ORDER)]
        full[:6, :6] += mass
        servo = self._servo[0]
        springs = block_diag(stiffness, np.diag(servo["stiffness"]))
        dampers = block_diag(damping, np.diag(servo["damping"]))
        poles = [_poles(full, dampers, springs), _poles(mass, damping, stiffness)]
        lag = self._lag[0]
        legs = [1.0 / lag["lag"]] if lag["kind"] == PLATFORM_LAGS else [0.0]
        return float(np.max(np.abs(np.concatenate([*poles, legs]))))

    def snapshot(self) -> FloatArray:
        """The whole state."""
        return self._state.copy()

    def restore(self, snapshot: FloatArray) -> None:
        """Go back to a snapshot."""
        self._state[:] = snapshot


_ORDER = np.array([0, 1, 2, 5, 4, 3, 6, 7, 8])
"""MuJoCo's base joints are x y z rz ry rx; a pose has its angles as rx ry rz."""


def _poles(mass: FloatArray, damping: FloatArray, stiffness: FloatArray) -> ComplexArray:
    """Poles of M x'' + B x' + K x = 0, complex (2 n,)."""
    n = len(mass)
    a = np.zeros((2 * n, 2 * n))
    a[:n, n:] = np.eye(n)
    a[n:, :n] = -np.linalg.solve(mass, stiffness)
    a[n:, n:] = -np.linalg.solve(mass, damping)
    return np.asarray(np.linalg.eigvals(a), dtype=complex)


@compiled
def _mass_matrix(
    sparse: FloatArray, row_start: FloatArray, row_length: FloatArray, column: FloatArray
) -> FloatArray:
    full = np.zeros((9, 9))
    for i in range(9):
        for k in range(row_start[i], row_start[i] + row_length[i]):
            full[i, column[k]] = sparse[k]
            full[column[k], i] = sparse[k]
    return full


@compiled
def _rates(
    x: FloatArray, torque: FloatArray, lag: Record, mass: FloatArray, damping: FloatArray,
    stiffness: FloatArray, home: FloatArray, position: int, velocity: int, model: int, data: int,
    qpos: FloatArray, qvel: FloatArray, bias: FloatArray, passive: FloatArray,
    sparse: FloatArray, row_start: FloatArray, row_length: FloatArray, column: FloatArray,
) -> FloatArray:  # fmt: skip
    order = np.array([0, 1, 2, 5, 4, 3, 6, 7, 8])
    for i in range(6):
        qpos[order[i]] = home[i] + x[12 + i]
        qvel[order[i]] = x[18 + i]
    for j in range(3):
        qpos[6 + j] = x[24 + j]
        qvel[6 + j] = x[27 + j]
    call_engine(position, model, data)
    call_engine(velocity, model, data)
    full = _mass_matrix(sparse, row_start, row_length, column)
    h = np.empty((9, 9))
    c = np.empty(9)
    for i in range(9):
        c[i] = bias[order[i]] - passive[order[i]]
        for j in range(9):
            h[i, j] = full[order[i], order[j]]
    t = np.eye(6)
    angles = np.array([qpos[5], qpos[4], qpos[3]])
    t[3:, 3:] = rate_matrix(angles).T
    spring = damping @ x[6:12] + stiffness @ x[:6]
    derivative = np.zeros(SIZE)
    derivative[:6] = x[6:12]
    derivative[12:18] = x[18:24]
    derivative[24:27] = x[27:30]
    if lag.kind == PLATFORM_IS_BASE:
        h[:6, :6] += t @ mass
        load = np.concatenate((-c[:6] - t @ spring, torque - c[6:]))
        acceleration = np.linalg.solve(h, load)
        derivative[6:12] = acceleration[:6]
        derivative[18:24] = acceleration[:6]
        derivative[27:30] = acceleration[6:]
    else:
        above = (lag.gain * (x[:6] - x[12:18]) - x[18:24]) / lag.lag
        h_base = np.ascontiguousarray(h[:6, :6])
        h_both = np.ascontiguousarray(h[:6, 6:])
        h_arm = np.ascontiguousarray(h[6:, 6:])
        joints = np.linalg.solve(h_arm, torque - c[6:] - h_both.T @ above)
        reaction = -(h_base @ above + h_both @ joints + c[:6])
        wrench = np.linalg.solve(t, reaction)
        derivative[6:12] = np.linalg.solve(mass, wrench - spring)
        derivative[18:24] = above
        derivative[27:30] = joints
    return derivative


@compiled
def _advance(
    states: FloatArray, commands: FloatArray, cycle: float, steps: int, lag_block: Block,
    mass: FloatArray, damping: FloatArray, stiffness: FloatArray, home: FloatArray,
    servo_block: Block, position: int, velocity: int, model: int, data: int,
    qpos: FloatArray, qvel: FloatArray, bias: FloatArray, passive: FloatArray,
    sparse: FloatArray, row_start: FloatArray, row_length: FloatArray, column: FloatArray,
) -> None:  # fmt: skip
    lag, servo = lag_block[0], servo_block[0]
    step = cycle / steps
    q_set, rate_set, torque = np.empty(3), np.empty(3), np.empty(3)
    weights = np.array([1.0, 2.0, 2.0, 1.0]) / 6.0
    ahead = np.array([0.0, 0.5, 0.5, 1.0])
    for k in range(len(commands)):
        points, x = commands[k], states[k + 1]
        x[:] = states[k]
        for n in range(steps):
            total = np.zeros(SIZE)
            slope = np.zeros(SIZE)
            for stage in range(4):
                y = x + ahead[stage] * step * slope
                if not np.all(np.isfinite(y)):  # the caller sees it; a solver would raise
                    states[k + 1 :] = np.nan
                    return
                spline(points, (n + ahead[stage]) / steps, cycle, q_set, rate_set)
                servo_torque(servo, y[30:33], q_set, rate_set, y[24:27], y[27:30], torque)
                slope = _rates(
                    y, torque, lag, mass, damping, stiffness, home, position, velocity, model,
                    data, qpos, qvel, bias, passive, sparse, row_start, row_length, column,
                )  # fmt: skip
                for j in range(3):
                    slope[30 + j] = servo.integral[j] * (q_set[j] - y[24 + j])
                total += weights[stage] * slope
            x += step * total
