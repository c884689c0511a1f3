"""Symmetric equations in a robot's chain joints; the reference of walkgen_adapt_solve.h."""

import numpy as np

from walkgen.runtime.solves.tree import Reals

ROUNDINGS = 64.0 * float(np.finfo(float).eps)


def cholesky(matrix: Reals, rhs: Reals) -> Reals | None:
    """The x of matrix x = rhs, both [n]; None where the matrix [n, n] is not clearly positive definite."""
    lower = np.zeros_like(matrix)
    for j in range(len(rhs)):
        column = matrix[j:, j] - lower[j:, :j] @ lower[j, :j]
        if not column[0] > ROUNDINGS * matrix[j, j]:
            return None
        lower[j:, j] = column / np.sqrt(column[0])
    y = np.empty_like(rhs)
    for j in range(len(rhs)):
        y[j] = (rhs[j] - lower[j, :j] @ y[:j]) / lower[j, j]
    for j in range(len(rhs) - 1, -1, -1):
        y[j] = (y[j] - lower[j + 1 :, j] @ y[j + 1 :]) / lower[j, j]
    return y
