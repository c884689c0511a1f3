"""The leg of specs/mero_leg.toml, its five functions, the inputs of every contestant and the answers they must give."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chains import Array, read_chain

S1, A2, A3 = 0.12, 0.35, 0.40
"""Height of the pitch axes above the platform, thigh, shank (m); every other length of the leg is zero."""

_CHAIN = read_chain(Path(__file__).parents[1] / "specs" / "mero_leg.toml", "leg")

SEED = 20240229
TOLERANCE = 1e-9


@dataclass(frozen=True)
class LegFunction:
    """One measured function: its name, the sizes of its output ports in order, whether they are joint angles."""

    name: str
    title: str
    ports: tuple[int, ...]
    angles: bool = False

    @property
    def size(self) -> int:
        return sum(self.ports)


FUNCTIONS = (
    LegFunction("foot_position", "Foot position", (3,)),
    LegFunction("foot_position_jacobian", "Foot position and Jacobian", (3, 9)),
    LegFunction("foot_hessian", "Hessian", (27,)),
    LegFunction("inverse_branch", "Inverse, one branch", (3,), angles=True),
    LegFunction("inverse", "Inverse, all four branches", (12,), angles=True),
)


@dataclass(frozen=True)
class Inputs:
    """Rows of joint angles [rows,3], the feet they reach [rows,3] and a branch for each [rows].

    No pose is dropped: a foot counts as reachable because forward kinematics made it.
    """

    q: Array
    branch: NDArray[np.int32]

    @cached_property
    def p(self) -> Array:
        return frames(self.q)[:, 3, :3, 3].copy()

    def rows(self, function: LegFunction) -> Array:
        """What `function` is called with."""
        return self.p if function.angles else self.q


RANGES = {"limits": np.radians([[-60, -90, -150], [60, 90, 0]]), "turn": np.array([[-np.pi] * 3, [np.pi] * 3])}
"""Lowest and highest joint angles: the limits of the spec, or the full turn, where the C library's sin and cos take longer."""


def draw(rows: int, span: str) -> Inputs:
    """Joint angles spread evenly over a range, the same for every run of the same size."""
    random = np.random.default_rng(SEED)
    return Inputs(random.uniform(*RANGES[span], (rows, 3)), random.integers(0, 4, rows, dtype=np.int32))


def frames(q: Array) -> Array:
    """Platform and moved frames [rows,4,4,4] as products of classic DH matrices, straight from the spec's rows."""
    return _CHAIN.frames(q)


def _axes_and_jacobian(q: Array) -> tuple[Array, Array]:
    """Joint axes [rows,joint,3] and Jacobian columns [rows,joint,3]: z x (foot - origin)."""
    chain = frames(q)
    axes, origins = chain[:, :3, :3, 2], chain[:, :3, :3, 3]
    return axes, np.cross(axes, chain[:, 3:, :3, 3] - origins)


def _position_jacobian(q: Array) -> Array:
    _, columns = _axes_and_jacobian(q)
    return np.concatenate([frames(q)[:, 3, :3, 3], np.swapaxes(columns, 1, 2).reshape(-1, 9)], axis=1)


def _hessian(q: Array) -> Array:
    """H[row, k, i, j] = (z_min x J_max)_k."""
    axes, columns = _axes_and_jacobian(q)
    low, high = np.minimum.outer(range(3), range(3)), np.maximum.outer(range(3), range(3))
    return np.moveaxis(np.cross(axes[:, low], columns[:, high]), -1, 1).reshape(-1, 27)


def _inverse(p: Array) -> Array:
    """All four branches [rows,12] by the law of cosines, signs (rho, knee) = (+,+), (+,-), (-,+), (-,-)."""
    x, y, z = p[:, 0], p[:, 1], p[:, 2] - S1
    cosine = np.clip((x**2 + y**2 + z**2 - A2**2 - A3**2) / (2 * A2 * A3), -1, 1)
    slots = []
    for rho_sign in (1, -1):
        for knee_sign in (1, -1):
            knee = knee_sign * np.arccos(cosine)
            hip = np.arctan2(z, rho_sign * np.hypot(x, y)) - np.arctan2(A3 * np.sin(knee), A2 + A3 * cosine)
            slots += [np.arctan2(rho_sign * y, rho_sign * x), hip, knee]
    return np.stack(slots, axis=1)


def _inverse_branch(inputs: Inputs) -> Array:
    return _inverse(inputs.p).reshape(-1, 4, 3)[np.arange(len(inputs.p)), inputs.branch]


_ANSWERS: dict[str, Callable[[Inputs], Array]] = {
    "foot_position": lambda inputs: inputs.p,
    "foot_position_jacobian": lambda inputs: _position_jacobian(inputs.q),
    "foot_hessian": lambda inputs: _hessian(inputs.q),
    "inverse_branch": _inverse_branch,
    "inverse": lambda inputs: _inverse(inputs.p),
}


def expected(function: LegFunction, inputs: Inputs) -> Array:
    """What `function` must return [rows, size]."""
    return _ANSWERS[function.name](inputs)


def error(function: LegFunction, answer: Array, right: Array) -> float:
    """The largest difference; angles are compared as turns, since not every peer wraps them."""
    difference = answer - right
    if function.angles:
        difference = np.mod(difference + np.pi, 2 * np.pi) - np.pi
    return float(np.max(np.abs(difference))) if np.all(np.isfinite(answer)) else float("nan")
