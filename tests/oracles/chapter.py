"""The chapter's own algebra in its own form: A_i with the 1 first, Q_theta, Q_s, and the operators D_i, typed from its equations."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

Array = np.ndarray
Kind = Literal["revolute", "prismatic"]
Row = tuple[float, float, float, float]
"""theta, s, a, alpha"""

Q_THETA = np.array([[0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 0]], dtype=float)
Q_S = np.array([[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0]], dtype=float)
PI = np.array([[0, 0, 0, 1], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], dtype=float)
"""(x, y, z, 1) to (1, x, y, z)."""


def A(theta: float, s: float, a: float, alpha: float) -> Array:
    """Frame i+1 to frame i."""
    c, n, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return np.array([[1, 0, 0, 0], [a * c, c, -n * ca, n * sa], [a * n, n, c * ca, -c * sa], [s, 0, sa, ca]])


def one_first(T: Array) -> Array:
    """An ordinary homogeneous matrix (1 last) in the chapter's order."""
    return PI @ T @ PI.T


def chain(rows: Sequence[Row], kinds: Sequence[Kind], q: Sequence[float], mount: Array | None = None) -> list[Array]:
    """A_0, A_0 A_1, ..., A_0 ... A_n."""
    products = [np.eye(4) if mount is None else mount]
    for (theta, s, a, alpha), kind, value in zip(rows, kinds, q, strict=True):
        turned = (theta + value, s) if kind == "revolute" else (theta, s + value)
        products.append(products[-1] @ A(*turned, a, alpha))
    return products


def operators(products: Sequence[Array], kinds: Sequence[Kind]) -> list[Array]:
    """D_i = (A_0 ... A_{i-1}) Q_i (A_0 ... A_{i-1})^-1."""
    return [W @ (Q_THETA if kind == "revolute" else Q_S) @ np.linalg.inv(W) for W, kind in zip(products[:-1], kinds, strict=True)]


def jacobian(products: Sequence[Array], kinds: Sequence[Kind], foot: Sequence[float]) -> Array:
    """J_i = D_i p, [3,n]."""
    p = products[-1] @ np.array([1.0, *foot])
    return np.stack([(D @ p)[1:] for D in operators(products, kinds)], axis=1)


def hessian(products: Sequence[Array], kinds: Sequence[Kind], foot: Sequence[float]) -> Array:
    """H_ij = D_min(i,j) D_max(i,j) p, [3,n,n]."""
    p, D = products[-1] @ np.array([1.0, *foot]), operators(products, kinds)
    count = len(D)
    H = [[(D[min(i, j)] @ D[max(i, j)] @ p)[1:] for j in range(count)] for i in range(count)]
    return np.moveaxis(np.array(H), 2, 0)
