"""A foot that rolls over its toe under a hip that moves evenly, as functions of time and of the parameters that may vary, with slopes.

The contact parameter is found by Newton's method at every instant; slopes follow it by the theorem of implicit functions.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import sympy

from walkgen.design.freed import freed, variables_of, varied
from walkgen.design.problem import Reals, Values, Variable
from walkgen.model.assemble import assemble
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.values import Values as Numbers
from walkgen.model.walk import defaults
from walkgen.runtime.solves.first_root import first_root
from walkgen.spec.scalar import Scalar
from walkgen.spec.schema import RobotSpec
from walkgen.symbolic.arrays import compiled
from walkgen.symbolic.flat_stance import FlatStance
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.rolling_stance import RollingStance
from walkgen.symbolic.sole_ports import SoleLeg
from walkgen.symbolic.stance_forces import StanceForces
from walkgen.symbolic.tangents import partial_tangents
from walkgen.symbolic.tape import Tape

_MODE = "stance_forces_load"
_BEYOND = 3.0
"""How far beyond its end, in lengths of its range, the curve is followed while a search is on its way."""
_SHARES = np.linspace(0.0, 1.0, 65)
"""Of the curve's range, where it must bulge."""
_DIGITS = 50
Exprs = Sequence[sympy.Expr]
QUANTITIES = (
    *("foot_angle", "foot_rate", "foot_acceleration", "hip_moment", "knee_moment", "ankle_moment"),
    *("contact", "contact_rate", "curvature", "extension", "knee", "room"),
)
"""Of every instant: rad and s, N m, the curve's parameter, 1/m, lengths of the straight leg, rad by which the knee is bent, and how much
of the curve is left, in its range.
"""


@dataclass(frozen=True)
class Course:
    """Quantities at instants: values [quantities, instants] and slopes by the variables [quantities, instants, variables]."""

    times: Reals
    values: Reals
    slopes: Reals

    def of(self, quantity: str) -> Values:
        """One of `QUANTITIES`."""
        place = QUANTITIES.index(quantity)
        return Values(self.values[place], self.slopes[place])

    def peak(self, quantity: str) -> float:
        """Its largest size; NaN where it is nowhere defined at one instant."""
        return float(np.abs(self.values[QUANTITIES.index(quantity)]).max())


class SoleRoll:
    """One [sole_design.NAME] of a spec."""

    def __init__(self, spec: RobotSpec, name: str, folder: Path) -> None:
        self.table, self.name, self.spec = spec.sole_design[name], name, spec
        self.names = varied(spec, self.table.vary)
        moving = freed(spec, self.names)
        self._numbers, self.mechanism = Numbers.of(moving.parameters), assemble(moving, folder)
        self.leg: Limb = next(leg for leg in self.mechanism.legs if leg.name == self.table.leg)
        self._symbols, values = parameter_symbols(self.mechanism), defaults(self.mechanism)
        self._defaults = {key: float(values[key]) for key in self._symbols}
        self.duration = self._number(self.table.duration)
        self._functions = _Functions(self.mechanism, self.leg, self._given(), self.names)
        self._last: tuple[bytes, Course] | None = None

    @property
    def variables(self) -> tuple[Variable, ...]:
        """What may move, with the spec's values."""
        return variables_of(self.spec, self.names)

    def at(self, x: Reals, instants: int | None = None) -> Course:
        """The roll for the variables' values, at the table's instants or at another number of them."""
        count = instants or self.table.instants
        key = np.append(x, count).tobytes()
        if self._last is None or self._last[0] != key:
            self._last = key, self._functions.course(np.linspace(0.0, self.duration, count), self._parameters(x))
        return self._last[1]

    def flat_length(self, x: Reals) -> Values:
        """Of the flat part (m)."""
        length, *slopes = self._functions.flat(*self._parameters(x))
        return Values(np.array([float(length)]), np.array([[float(slope) for slope in slopes]]))

    def bounds(self, x: Reals) -> tuple[float, float]:
        """Where the curve's parameter begins and ends."""
        return self._functions.bounds(self._parameters(x))

    def bulge(self, x: Reals) -> Values:
        """By how much the foot would turn over the range as fast as at places along the curve (rad); more than 0 where convex."""
        found = np.stack([np.broadcast_to(entry, _SHARES.shape) for entry in self._functions.bulge(_SHARES, *self._parameters(x))])
        return Values(found[0], found[1:].T)

    def outline(self, x: Reals) -> Reals:
        """Points of the sole from the rear edge to the curve's end, in the foot's axes [n, 2]: forward and up (m)."""
        return self._functions.outline(self._parameters(x))

    def pair(self, key: str) -> tuple[float, float] | None:
        """Limits of the table."""
        given = getattr(self.table, key)
        return None if given is None else (self._number(given[0]), self._number(given[1]))

    def number(self, key: str) -> float | None:
        """A limit of the table (SI)."""
        given = self.table.si(key)
        return None if given is None else self._number(given)

    def weight(self, key: str, usual: float) -> float:
        """Of an objective."""
        given = getattr(self.table.weights, key)
        return usual if given is None else self._number(given)

    def _number(self, scalar: Scalar) -> float:
        return self._numbers.number(scalar)

    def _parameters(self, x: Reals) -> list[float]:
        return list((self._defaults | dict(zip(self.names, map(float, x), strict=True))).values())

    def _given(self) -> "_Given":
        end = [self.number(key) or 0.0 for key in ("thigh", "thigh_rate", "thigh_acceleration")]
        hip, velocity, load = (self.pair(key) or (0.0, 0.0) for key in ("hip", "velocity", "load"))
        return _Given(hip, velocity, self.duration, (end[0], end[1], end[2]), load)


@dataclass(frozen=True)
class _Given:
    """The numbers of a roll that no variable moves."""

    hip: tuple[float, float]
    velocity: tuple[float, float]
    duration: float
    thigh: tuple[float, float, float]
    load: tuple[float, float]


class _Functions:
    """Of one leg and roll, by NumPy."""

    def __init__(self, mechanism: Mechanism, leg: Limb, given: _Given, names: Sequence[str]) -> None:
        own = SoleLeg.of(mechanism, leg)
        tape, self._time, self._contact = Tape(), sympy.Symbol("t"), sympy.Symbol("contact")
        symbols = parameter_symbols(mechanism)
        parameters = tuple(symbols.values())
        variables = [(name, symbols[name]) for name in names]
        hip, thigh, edge = self._driven(tape, own, given)
        rolling = RollingStance(own)
        knee, _ = own.knee(tape, (hip[0], hip[1]), thigh[0])
        value, slope, size = rolling.far("toe").residual(tape, self._contact, (*knee, edge))
        self._residual = compiled(tape, (self._contact, self._time, *parameters), [value, slope, size])
        outputs = self._quantities(tape, own, given, (hip, thigh, edge))
        moved = [*variables, ("contact", self._contact)]
        rows = partial_tangents(tape, [*outputs, value], moved)
        self._outputs = compiled(tape, (self._contact, self._time, *parameters), [*outputs, *(entry for row in rows for entry in row)])
        curve = rolling.curve("toe", self._contact, tape)
        self._bounds = compiled(tape, parameters, curve.bounds)
        length = own.edge("toe") - own.edge("heel")
        self.flat = compiled(tape, parameters, [length, *(entry for row in partial_tangents(tape, [length], variables) for entry in row)])
        self.bulge = _bulge(rolling, variables, parameters)
        self._points = compiled(tape, (self._contact, *parameters), [*curve.point])
        self._edges = compiled(tape, parameters, [own.height, own.edge("heel")])
        self._count = len(names)

    def course(self, times: Reals, parameters: Sequence[float]) -> Course:
        """At instants."""
        rows = np.column_stack([times, np.tile(parameters, (len(times), 1))])
        low, high = self.bounds(parameters)
        ends = np.array([low, low + _BEYOND * (high - low)])
        with np.errstate(all="ignore"):
            contact, _ = first_root(rows, ends, (self._at,))
            found = np.stack([np.broadcast_to(entry, times.shape) for entry in self._outputs(contact, *rows.T)])
        kinds, count = len(QUANTITIES), self._count + 1
        slopes = found[kinds:].reshape(kinds + 1, count, len(times))
        by_contact, residual = slopes[:kinds, -1], slopes[kinds]
        with np.errstate(all="ignore"):
            moving = -residual[:-1] / residual[-1]
        total = slopes[:kinds, :-1] + by_contact[:, None] * moving[None]
        return Course(times, found[:kinds], total.transpose(0, 2, 1))

    def bounds(self, parameters: Sequence[float]) -> tuple[float, float]:
        """Of the curve's parameter."""
        low, high = (float(entry) for entry in self._bounds(*parameters))
        return low, high

    def _at(self, points: Reals) -> Reals:
        found = self._residual(*points.T)
        return np.stack([np.broadcast_to(entry, points.shape[:1]) for entry in found], -1)

    def outline(self, parameters: Sequence[float]) -> Reals:
        """Forward and up, from the ankle."""
        low, high = self.bounds(parameters)
        at = np.linspace(low, high, 121)
        x, y = (np.broadcast_to(entry, at.shape) for entry in self._points(at, *parameters))
        depth, rear = (float(entry) for entry in self._edges(*parameters))
        return np.concatenate([[[rear, -depth]], np.stack([y, -x], -1)])

    def _driven(self, tape: Tape, own: SoleLeg, given: _Given) -> tuple[Exprs, Exprs, sympy.Expr]:
        """Motions of hip and thigh: the thigh begins as over the flat foot, which makes the take-off smooth (theory 8.3)."""
        t, nil = self._time, sympy.S.Zero
        start, velocity = ([sympy.Float(repr(entry), _DIGITS) for entry in pair] for pair in (given.hip, given.velocity))
        flat, _ = FlatStance(own).moving(tape, (*start, *velocity, nil, nil), nil, sympy.S.One)
        end = [sympy.Float(repr(entry), _DIGITS) for entry in given.thigh]
        thigh = _quintic(tape, t, given.duration, (flat[0], flat[3], flat[6]), end)
        hip = [start[0] + velocity[0] * t, start[1] + velocity[1] * t, *velocity, nil, nil]
        return hip, thigh, own.edge("toe")

    def _quantities(self, tape: Tape, own: SoleLeg, given: _Given, driven: tuple[Exprs, Exprs, sympy.Expr]) -> list[sympy.Expr]:
        """`QUANTITIES` on the tape."""
        hip, thigh, edge = driven
        moving = RollingStance(own).moving(tape, "toe", self._contact, hip, thigh, edge)
        load = [sympy.Float(repr(entry), _DIGITS) for entry in given.load]
        inputs = {"hip": hip, "angles": moving.angles, "load": load, "centre": (moving.point[0] - moving.ankle[0],), "mu": (sympy.S.Zero,)}
        (first, second, third, *_), _ = StanceForces(own).values(tape, _MODE, inputs)
        away = [tape.let("extent", moving.ankle[axis] - hip[axis]) for axis in (0, 1)]
        extension = sympy.sqrt(away[0] ** 2 + away[1] ** 2) / (own.leg.thigh + own.leg.shank)
        curve, (start, stop) = moving.curve, moving.curve.bounds
        bend = -curve.ahead * curve.turning / curve.speed
        return [
            *(moving.angles[2], moving.angles[5], moving.angles[8], first, second, third),
            *(moving.contact[0], moving.contact[1], bend, extension, moving.angles[0] - moving.angles[1]),
            (stop - moving.contact[0]) / (stop - start),
        ]


def _bulge(rolling: RollingStance, variables: Sequence[tuple[str, sympy.Symbol]], parameters: Exprs) -> Callable[..., Sequence[Reals]]:
    """How fast the foot turns over its toe, with slopes by the variables, by the share of the curve's range and all parameters."""
    tape, share = Tape(), sympy.Symbol("share")
    start, end = rolling.curve("toe", sympy.S.Zero, tape).bounds
    curve = rolling.curve("toe", tape.let("place", start + share * (end - start)), tape)
    turning = tape.let("bulge", -curve.ahead * curve.turning * (end - start))
    return compiled(
        tape, (share, *parameters), [turning, *(entry for row in partial_tangents(tape, [turning], variables) for entry in row)]
    )


def _quintic(tape: Tape, t: sympy.Expr, span: float, start: Exprs, end: Exprs) -> Exprs:
    """Value, rate and acceleration of the quintic with these at both ends."""
    T = sympy.Float(repr(span), _DIGITS)
    p, v, a = start
    gap = tape.let("gap", end[0] - p - v * T - a * T**2 / 2)
    rise, bend = tape.let("rise", (end[1] - v - a * T) * T), tape.let("bend", (end[2] - a) * T**2)
    c3, c4, c5 = (
        tape.let("c3", (10 * gap - 4 * rise + bend / 2) / T**3),
        tape.let("c4", (-15 * gap + 7 * rise - bend) / T**4),
        tape.let("c5", (6 * gap - 3 * rise + bend / 2) / T**5),
    )
    return (
        tape.let("swung", p + t * (v + t * (a / 2 + t * (c3 + t * (c4 + t * c5))))),
        tape.let("swing_rate", v + t * (a + t * (3 * c3 + t * (4 * c4 + t * 5 * c5)))),
        tape.let("swing_acceleration", a + t * (6 * c3 + t * (12 * c4 + t * 20 * c5))),
    )
