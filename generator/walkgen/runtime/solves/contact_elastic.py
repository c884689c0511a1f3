"""A stand on elastic legs, checked and scaled; the reference of walkgen_contact_elastic.h."""

from dataclasses import dataclass

import numpy as np

from walkgen.runtime.solves.rows import Reals

_MOST_FEET = 16
_UNIT = 1e-9
_SIZES = 250


@dataclass(frozen=True)
class Stand:
    """Lengths are about the feet's `centre` in units of `length`, forces in units of `force`, compliances in units of `soft`.

    Normals n [k, 3], friction mu [k], misfit e [k, 3], load w [6], compliance C [3k, 3k], grasp map [6, 3k].
    """

    n: Reals
    mu: Reals
    e: Reals
    w: Reals
    C: Reals
    grasp: Reals
    centre: Reals
    length: float
    force: float
    soft: float

    def displaced(self, f: Reals, delta: Reals) -> Reals:
        """The feet's displacements [k, 3]."""
        return np.asarray((self.C @ f.ravel() + self.grasp.T @ delta).reshape(-1, 3) + self.e)

    def motion(self, delta: Reals) -> Reals:
        """The platform's motion [6] in the caller's units: of the frame's origin, rotation."""
        turn = self.soft * self.force * delta[3:] / self.length
        return np.concatenate([self.soft * self.force * delta[:3] - np.cross(turn, self.centre), turn])


def read_stand(points: Reals, normals: Reals, mu: Reals, wrench: Reals, compliance: Reals, misfit: Reals) -> Stand | None:
    """Scaled by powers of 2; None where an input is bad."""
    inputs = (points, normals, wrench, compliance, misfit)
    if not 1 <= len(points) <= _MOST_FEET or not all(np.isfinite(value).all() for value in inputs) or not (mu >= 0.0).all():
        return None
    centre = points.mean(axis=0)
    r, moment = points - centre, wrench[3:] - np.cross(centre, wrench[:3])
    length, soft = _size(r) or 1.0, _size(compliance)
    sizes = (_size(points), _size(wrench), length, soft, _size(misfit))
    if not soft or not all(size == 0.0 or 2.0**-_SIZES <= size <= 2.0**_SIZES for size in sizes):
        return None
    if (np.abs(np.sum(normals**2, axis=1) - 1.0) > 2.0 * _UNIT).any() or not _positive(compliance / soft):
        return None
    load = np.concatenate([wrench[:3], moment / length])
    force = max(_size(load), _size(misfit) / soft) or 1.0
    grasp = np.hstack([np.vstack([np.eye(3), _skew(row)]) for row in r / length])
    symmetric = 0.5 * (compliance + compliance.T) / soft
    return Stand(normals, mu, misfit / force / soft, load / force, symmetric, grasp, centre, length, force, soft)


def _size(values: Reals) -> float:
    """A power of 2 near the largest; 0 where all are 0."""
    largest = float(np.max(np.abs(values)))
    return float(np.ldexp(1.0, np.frexp(largest)[1])) if largest > 0.0 else 0.0


def _positive(C: Reals) -> bool:
    """Symmetric and positive."""
    if np.max(np.abs(C - C.T)) > _UNIT:
        return False
    try:
        np.linalg.cholesky(0.5 * (C + C.T))
    except np.linalg.LinAlgError:
        return False
    return True


def _skew(r: Reals) -> Reals:
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])
