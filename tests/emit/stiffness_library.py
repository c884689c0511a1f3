"""The spreading of loads over elastic legs, compiled in double and float, called on NumPy arrays of stances; random stances."""

from dataclasses import dataclass, replace

import numpy as np
from general_library import build, call, source

from walkgen.runtime.solves.contact_stiffness import contact_stiffness

HEADERS = ("walkgen_contact_stiffness.h",)
ONE = {
    "walkgen_contact_stiffness.h": """
void spread_rows@(int rows, int k, int whole, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench, const REAL *C,
                  const REAL *e, REAL *f, int32_t *status, int32_t *state, REAL *displacement, REAL *violation);
void spread_rows@(int rows, int k, int whole, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench, const REAL *C,
                  const REAL *e, REAL *f, int32_t *status, int32_t *state, REAL *displacement, REAL *violation) {
    for (int i = 0; i < rows; ++i) {
        if (whole)
            wg_contact_stiffness@(k, points + 3 * k * i, normals + 3 * k * i, mu + k * i, wrench + 6 * i, C + 9 * k * k * i, e + 3 * k * i,
                                  f + 3 * k * i, status + i, state + k * i, displacement + 6 * i, violation + i);
        else
            wg_contact_stiffness_blocks@(k, points + 3 * k * i, normals + 3 * k * i, mu + k * i, wrench + 6 * i, C + 9 * k * i,
                                         e + 3 * k * i, f + 3 * k * i, status + i, state + k * i, displacement + 6 * i, violation + i);
    }
}
"""
}
SOURCE = source("".join(ONE.values()), *HEADERS)


@dataclass(frozen=True)
class Stance:
    """points, normals, mu, wrench, compliance [3k,3k], misfit."""

    points: np.ndarray
    normals: np.ndarray
    mu: np.ndarray
    wrench: np.ndarray
    compliance: np.ndarray
    misfit: np.ndarray

    @property
    def given(self):
        return self.points, self.normals, self.mu, self.wrench, self.compliance, self.misfit

    @property
    def blocks(self):
        return np.array([self.compliance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] for i in range(len(self.mu))])

    def permuted(self, order):
        rows = (3 * np.asarray(order)[:, None] + np.arange(3)).ravel()
        C = self.compliance[np.ix_(rows, rows)]
        return Stance(self.points[order], self.normals[order], self.mu[order], self.wrench, C, self.misfit[order])

    def moved(self, R, t):
        """In a frame turned by R and shifted by t."""
        turn = np.kron(np.eye(len(self.mu)), R)
        force = R @ self.wrench[:3]
        points = self.points @ R.T + t
        wrench = np.concatenate([force, R @ self.wrench[3:] + np.cross(t, force)])
        return Stance(points, self.normals @ R.T, self.mu, wrench, turn @ self.compliance @ turn.T, self.misfit @ R.T)

    def loaded(self, factor):
        return replace(self, wrench=factor * self.wrench, misfit=factor * self.misfit)


def random_stance(rng, k, *, coupled=False, misfit=0.0) -> Stance:
    """Feet all round on uneven ground under a slanting load that often makes them pull or slide."""
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, k))
    points = np.column_stack(
        [np.cos(angle) * rng.uniform(0.4, 0.8, k), np.sin(angle) * rng.uniform(0.4, 0.8, k), rng.uniform(-0.2, 0.2, k)]
    )
    normals = np.array([0.0, 0.0, 1.0]) + rng.choice([0.0, 0.2, 0.4]) * rng.normal(size=(k, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    slant, way = rng.uniform(0.0, 0.4), rng.uniform(0.0, 2.0 * np.pi)
    force = 600.0 * np.array([np.sin(slant) * np.cos(way), np.sin(slant) * np.sin(way), -np.cos(slant)])
    at = np.append(rng.uniform(-0.3, 0.3, 2), rng.uniform(0.0, 0.4))
    C = np.zeros((3 * k, 3 * k))
    for i in range(k):
        A = rng.normal(size=(3, 3))
        C[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = 1e-5 * (A @ A.T + 0.05 * np.eye(3))
    if coupled:
        A = rng.normal(size=(3 * k, 6))
        C += 3e-6 * A @ A.T
    e = misfit * rng.normal(size=(k, 3))
    return Stance(points, normals, rng.uniform(0.1, 1.0, k), np.concatenate([force, np.cross(at, force)]), C, e)


class Spreading:
    """Rows of stances of as many feet."""

    def __init__(self, folder, *flags) -> None:
        self._library = build(folder, SOURCE, *flags)

    def __call__(self, *stances, whole=True, dtype=np.float64):
        k, rows = len(stances[0].mu), len(stances)
        columns = [(*s.points.flat,) for s in stances], [(*s.normals.flat,) for s in stances], [s.mu for s in stances]
        C = [s.compliance if whole else s.blocks for s in stances]
        given = [np.array(item, dtype, order="C") for item in (*columns, [s.wrench for s in stances], C, [s.misfit for s in stances])]
        f, displacement, violation = (np.full((rows, *shape), 7.0, dtype) for shape in ((k, 3), (6,), ()))
        status, state = np.full(rows, -1, np.int32), np.full((rows, k), -1, np.int32)
        call(self._library, "spread_rows", dtype, rows, k, int(whole), *given, f, status, state, displacement, violation)
        return f, status, state, displacement, violation


def by_numpy(points, normals, mu, wrench, compliance, misfit):
    """The NumPy reference of stances, with the compliance as a matrix [..., 3k, 3k]."""
    points, compliance = np.asarray(points), np.asarray(compliance)
    k = points.shape[-2]
    return contact_stiffness(points, normals, mu, wrench, compliance.reshape(*compliance.shape[:-2], k, 3, k, 3), misfit)
