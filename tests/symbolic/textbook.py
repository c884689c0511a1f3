"""Kinematics as a textbook has it: sympy matrices multiplied, differentiated and evaluated to 50 digits, no line of walkgen."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy
from mpmath.ctx_mp import MPContext
from sympy.printing.pycode import MpmathPrinter

CONTEXT = MPContext()
CONTEXT.dps = 50
DIGITS_50 = {"mpmath": CONTEXT, "ImmutableDenseMatrix": CONTEXT.matrix}


@dataclass(frozen=True)
class Row:
    """A DH row of exact numbers: lengths in m, angles in degrees."""

    kind: str
    a: sympy.Rational
    alpha: sympy.Rational
    d: sympy.Rational
    theta: sympy.Rational

    @property
    def text(self) -> str:
        """As a joint of a spec."""
        numbers = f"a = {float(self.a)}, alpha_deg = {float(self.alpha)}, d = {float(self.d)}, theta_deg = {float(self.theta)}"
        return f'type = "{self.kind}", {numbers}'

    def matrix(self, convention: str, q: sympy.Symbol) -> sympy.Matrix:
        """The row's homogeneous matrix, typed from the textbooks (Denavit and Hartenberg's, and Craig's)."""
        theta = self.theta * sympy.pi / 180 + (q if self.kind == "revolute" else 0)
        d = self.d + (q if self.kind == "prismatic" else 0)
        alpha = self.alpha * sympy.pi / 180
        ct, st, ca, sa = sympy.cos(theta), sympy.sin(theta), sympy.cos(alpha), sympy.sin(alpha)
        if convention == "classic":
            return sympy.Matrix([[ct, -st * ca, st * sa, self.a * ct], [st, ct * ca, -ct * sa, self.a * st], [0, sa, ca, d], [0, 0, 0, 1]])
        return sympy.Matrix([[ct, -st, 0, self.a], [st * ca, ct * ca, -sa, -sa * d], [st * sa, ct * sa, ca, ca * d], [0, 0, 0, 1]])


@dataclass(frozen=True)
class Leg:
    """Rows in one convention; every quantity at a point q of 50-digit numbers."""

    convention: str
    rows: tuple[Row, ...]

    @cached_property
    def q(self) -> tuple[sympy.Symbol, ...]:
        return sympy.symbols(f"q1:{len(self.rows) + 1}")

    @cached_property
    def poses(self) -> list[sympy.Matrix]:
        """The first frame, then the frame after each row."""
        poses = [sympy.eye(4)]
        for row, q in zip(self.rows, self.q, strict=True):
            poses.append(poses[-1] * row.matrix(self.convention, q))
        return poses

    @cached_property
    def _evaluate(self) -> Any:
        """T, dT/dq_i and d2T/dq_i dq_j by sympy.diff, as one numeric function."""
        T = self.poses[-1]
        first = [T.diff(q) for q in self.q]
        second = [[dT.diff(q) for q in self.q] for dT in first]
        return sympy.lambdify(self.q, [self.poses, first, second], modules=[DIGITS_50], printer=MpmathPrinter)

    def at(self, q: Sequence[Any]) -> "Pose":
        poses, first, second = self._evaluate(*q)
        return Pose(poses, first, second)


@dataclass(frozen=True)
class Pose:
    """T and its derivatives at one q."""

    poses: list[Any]
    first: list[Any]
    second: list[list[Any]]

    @property
    def count(self) -> int:
        return len(self.first)

    @property
    def T(self) -> Any:
        return self.poses[-1]

    @property
    def position(self) -> list[Any]:
        return [self.T[row, 3] for row in range(3)]

    @property
    def rotation(self) -> list[Any]:
        return [self.T[row, column] for row in range(3) for column in range(3)]

    @property
    def frames(self) -> list[Any]:
        return [pose[row, column] for pose in self.poses for row in range(4) for column in range(4)]

    @property
    def jacobian(self) -> list[Any]:
        return [dT[row, 3] for row in range(3) for dT in self.first]

    @property
    def hessian(self) -> list[Any]:
        return [self.second[i][j][row, 3] for row in range(3) for i in range(self.count) for j in range(self.count)]

    def _spin(self, matrix: Any) -> list[Any]:
        """The vector of the skew matrix (dR R^T)."""
        return [matrix[2, 1], matrix[0, 2], matrix[1, 0]]

    @property
    def angular(self) -> list[Any]:
        """Angular rows of the Jacobian."""
        R = self.T[:3, :3]
        columns = [self._spin(dT[:3, :3] * R.T) for dT in self.first]
        return [column[row] for row in range(3) for column in columns]

    def bias(self, qd: Sequence[Any]) -> list[Any]:
        """Jdot qd, linear then angular: sum over i and j of dJ_i/dq_j qd_i qd_j."""
        R = self.T[:3, :3]
        total = [CONTEXT.mpf(0)] * 6
        for i in range(self.count):
            for j in range(self.count):
                turned = self.second[i][j][:3, :3] * R.T + self.first[i][:3, :3] * self.first[j][:3, :3].T
                column = [*(self.second[i][j][row, 3] for row in range(3)), *self._spin(turned)]
                total = [old + entry * qd[i] * qd[j] for old, entry in zip(total, column, strict=True)]
        return total
