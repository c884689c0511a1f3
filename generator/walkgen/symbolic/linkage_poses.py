"""How far every group of a linkage is from where it cannot close, and where its bodies are, for the generator's own use."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import defaults
from walkgen.symbolic.arrays import compiled
from walkgen.symbolic.closure import Closing, closing_at, point_parameters, point_port, unknowns_port
from walkgen.symbolic.starts import FoundStart
from walkgen.symbolic.tape import Tape, symbols_of

Reals = NDArray[np.float64]
CloseTriads = Callable[[int, Any, Any, Any], tuple[Any, Any]]
"""`walkgen.runtime.solves.triads.close_triads`, which generator stages do not import."""


class LinkagePoses:
    """A leg's linkage at many values of its drives, parameters at their defaults.

    Args:
        mechanism: the robot.
        leg: one of its legs.
        start: what triads are continued from; None without any.
        close_triads: their solve.
    """

    def __init__(self, mechanism: Mechanism, leg: Limb, start: FoundStart | None, close_triads: CloseTriads) -> None:
        self._leg, self._start, self._close_triads = leg, start, close_triads
        values, count, symbols = defaults(mechanism), unknowns_port(leg).size, symbols_of(point_port(mechanism, leg))
        self._parameters = [float(values[name]) for name in point_parameters(mechanism, leg)]
        given = len(symbols) - count
        found = closing_at(mechanism, leg, symbols[:given], symbols[given:], Tape())
        margins, poses = _told(found, leg)
        self._closure = compiled(found.tape, symbols, [*found.residuals, *(entry for row in found.slopes for entry in row)])
        self._margins, self._poses = (compiled(found.tape, symbols, entries) for entries in (margins, poses))

    def at(self, drives: Reals) -> tuple[Reals, Reals]:
        """Of drives [n, drives] the groups' margins [n, groups], of which the first below 0 or NaN cannot close, and x, y, cosine, sine of
        the bodies [n, bodies, 4].
        """
        z = np.concatenate([drives, np.broadcast_to(self._parameters, (len(drives), len(self._parameters)))], -1)
        with np.errstate(all="ignore"):
            points = self._closed(z) if self._start else z
            return _rows(self._margins, points), _rows(self._poses, points).reshape(len(drives), -1, 4)

    def _closed(self, z: Reals) -> Reals:
        """With what closes the triads: NaN where a dead point lies between."""
        assert self._start is not None
        point = [float(number) for number in (*self._start.drives, *self._start.parameters, *self._start.unknowns)]
        way = self._nearest(z)
        u, _ = self._close_triads(unknowns_port(self._leg).size, way, point, (lambda points: _rows(self._closure, points),))
        return np.concatenate([way, u], -1)

    def _nearest(self, z: Reals) -> Reals:
        """Turning drives within half a turn of the start, as generated code has them."""
        assert self._start is not None
        near = z.copy()
        for place, (joint, at) in enumerate(zip(self._leg.drives, self._start.drives, strict=True)):
            if joint.kind == "revolute":
                near[:, place] -= 2 * np.pi * np.rint((z[:, place] - float(at)) / (2 * np.pi))
        return near


def _told(found: Closing, leg: Limb) -> tuple[Sequence[sympy.Expr], Sequence[sympy.Expr]]:
    """Margins, and poses of all bodies."""
    assert leg.linkage is not None
    poses = [found.placing.pose(body) for body in range(len(leg.linkage.structure.names))]
    return [margin.value for margin in found.placing.margins], [entry for pose in poses for entry in (*pose.origin, *pose.rotor)]


def _rows(function: Callable[..., list[Any]], points: Reals) -> Reals:
    """Values [n, outputs] at points [n, inputs]."""
    return np.stack([np.broadcast_to(np.asarray(value, float), len(points)) for value in function(*points.T)], -1)
