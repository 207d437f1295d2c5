"""modal_damping: a damping matrix that gives every mode the same damping ratio."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray


def modal_damping(mass: FloatArray, stiffness: FloatArray, ratio: float) -> FloatArray:
    """B = 2 zeta M^1/2 (M^-1/2 K M^-1/2)^1/2 M^1/2: symmetric, zeta in every mode exactly.

    Args:
        mass: M (6, 6), symmetric, positive definite.
        stiffness: K (6, 6), symmetric, positive semi-definite.
        ratio: zeta.

    Source: what thesis A.2 means by B = 2 zeta sqrt(K M); errata E-11, E-18.
    """
    root = square_root(mass)
    inverse = np.linalg.inv(root)
    return np.asarray(2 * ratio * root @ square_root(inverse @ stiffness @ inverse) @ root)


def product_root(mass: FloatArray, stiffness: FloatArray) -> FloatArray:
    """The matrix square root of K M, which is not symmetric: what the thesis computed for A.5.

    With K M = M^-1/2 (M^1/2 K M^1/2) M^1/2 it is M^-1/2 (M^1/2 K M^1/2)^1/2 M^1/2.

    Source: errata E-18.
    """
    root = square_root(mass)
    return np.asarray(np.linalg.inv(root) @ square_root(root @ stiffness @ root) @ root)


def square_root(matrix: FloatArray) -> FloatArray:
    """Symmetric square root of a symmetric, positive semi-definite matrix."""
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    return np.asarray((vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T)
