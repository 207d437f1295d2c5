"""FirstMoments: the fewest mass parameters P that give an arm's first moment, for any chain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.dh_chain import DhChain

INDEPENDENT = 1e-7
"""A column is kept if this share of it is not in the span of the kept ones: round-off is 1e-15,
while a link of 1 mm in an arm of 1 m leaves 1e-3."""

_SAMPLES = 64


@dataclass(frozen=True)
class FirstMoments(ReadOnly):
    """S(q) = sum m_i r_i = H(q) P, with the dependent columns of H removed.

    Columns come in the order link 0 x, y, z, link 1 x, y, z, ..., then the masses; each that the
    ones before it span is dropped and its parameter goes into theirs. For the PUMA 9 of 16 stay,
    in the order of the thesis.

    Attributes:
        chain: the arm.
        kept: numbers of the columns that stay (p,).
        combine: P = combine @ (m_0 r_0, m_1 r_1, ..., m_0, ..., m_k) (p, 4 (k + 1)).

    Source: thesis eqs 3.7 to 3.9, C.2, errata E-9, E-31.
    """

    chain: DhChain
    kept: tuple[int, ...]
    combine: FloatArray

    @staticmethod
    def of(chain: DhChain) -> FirstMoments:
        """The reduction of a chain, found by rank over random joint coordinates."""
        rng = np.random.default_rng(31)
        q = rng.uniform(-np.pi, np.pi, (_SAMPLES, len(chain.joints)))
        columns = _all_columns(chain, q).reshape(3 * _SAMPLES, -1)
        kept: list[int] = []
        basis = np.zeros((len(columns), 0))
        for i, column in enumerate(columns.T):
            length = float(np.linalg.norm(column))
            rest = column - basis @ (basis.T @ column)
            rest -= basis @ (basis.T @ rest)  # once more against round-off
            if np.linalg.norm(rest) > INDEPENDENT * max(length, 1e-12):
                kept.append(i)
                basis = np.column_stack([basis, rest / np.linalg.norm(rest)])
        combine = np.linalg.lstsq(columns[:, kept], columns, rcond=None)[0]
        combine[np.abs(combine) < 1e-12] = 0.0
        return FirstMoments(chain, tuple(kept), np.asarray(combine, dtype=float))

    @property
    def names(self) -> tuple[str, ...]:
        """What each parameter of P is led by: "link 2 x", or "mass 3"."""
        links = len(self.chain.joints) + 1
        return tuple(
            f"link {i // 3} {'xyz'[i % 3]}" if i < 3 * links else f"mass {i - 3 * links}"
            for i in self.kept
        )

    def parameters(self, mass: FloatArray, com: FloatArray) -> FloatArray:
        """P [kg m] (p,) of link masses [kg] (k + 1,) and centres in link frames [m] (k + 1, 3)."""
        full = np.concatenate([(mass[:, None] * com).ravel(), mass])
        return np.asarray(self.combine @ full)

    def regressor(self, q: FloatArray) -> FloatArray:
        """H (n, 3, p) with S = H P in t, at joint coordinates (n, k)."""
        return _all_columns(self.chain, q)[:, :, list(self.kept)]

    def moment_regressor(self, q: FloatArray, gravity_in_top: FloatArray) -> FloatArray:
        """G (n, 3, p) with M_g = G P: each column of H crossed with g.

        Args:
            q: joint coordinates (n, k).
            gravity_in_top: acceleration of gravity in t [m/s^2] (n, 3).
        """
        h = self.regressor(q)
        return np.cross(h, gravity_in_top[:, :, None], axis=1)


def _all_columns(chain: DhChain, q: FloatArray) -> FloatArray:
    """Columns (n, 3, 4 (k + 1)): axes of every link frame, then their origins."""
    frames = chain.frames(q)
    axes = np.concatenate([frames[:, i, :3, :3] for i in range(frames.shape[1])], axis=2)
    origins = frames[:, :, :3, 3].transpose(0, 2, 1)
    return np.concatenate([axes, origins], axis=2)
