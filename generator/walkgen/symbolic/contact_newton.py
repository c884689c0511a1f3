"""The least contact forces without a support routine: damped Newton steps on the six multipliers of balance, for CasADi.

The last steps are Newton's own, so that the derivative of the forces is that of the implicit function, whatever the steps before were.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.signature import STATUSES, Port, Signature
from walkgen.symbolic.choices import at_most, both, chosen, less
from walkgen.symbolic.function import Finite, Function
from walkgen.symbolic.linear import solve_symmetric
from walkgen.symbolic.tape import Tape, Vec, cross, dot, minus, plus, scaled, symbols_of

MULTIPLIERS = Port("multipliers", (7,))
"""Of forces and moments about the feet's centre, in the stance's own units; then the damping."""

_ZERO, _ONE = sympy.S.Zero, sympy.S.One
_TINY = sympy.Float("1e-200", 50)
_LEAST_DAMPING = sympy.Rational(1, 10**13)
_BALANCED2 = sympy.Rational(1, 10**20)
_FREE = sympy.Integer(2)
_OK, _BAD_INPUT, _NO_CONVERGENCE, _INFEASIBLE = (
    sympy.Integer(STATUSES.index(name)) for name in ("OK", "BAD_INPUT", "NO_CONVERGENCE", "INFEASIBLE")
)


@dataclass(frozen=True)
class _Foot:
    """Where it stands about the feet's centre, in the stance's length; its cone; 1 / weight over the mean."""

    r: Vec
    normal: Vec
    mu: sympy.Expr
    ease: sympy.Expr
    most: sympy.Expr


@dataclass(frozen=True)
class _Image:
    """The nearest force in the cone; its derivative is along u u' + across (1 - n n' - bent t t')."""

    force: Vec
    u: Vec
    t: Vec
    along: sympy.Expr
    across: sympy.Expr
    bent: sympy.Expr
    inside: sympy.Basic


class Multipliers:
    """The dual of a stance of `feet` feet, on one tape: units, forces at the multipliers, and the next multipliers."""

    def __init__(self, inputs: Sequence[Port]) -> None:
        """The inputs are those of `contact_forces`: points, normals, mu, wrench, weight, n_max, facets."""
        self._tape = Tape()
        points, normals, mu, wrench, weight, most = (symbols_of(port) for port in inputs[:6])
        self._facets = symbols_of(inputs[6])[0]
        parts = [port[i : i + 6] for port in (points, normals, mu, wrench, weight) for i in range(0, len(port), 6)]
        self._finite = self._tape.let("total", sympy.Add(*(self._tape.let("sum", sympy.Add(*part)) for part in parts)))
        count = len(mu)
        spots = [_vector(points[3 * i : 3 * i + 3]) for i in range(count)]
        total = [sympy.Add(*(spot[axis] for spot in spots)) / count for axis in range(3)]
        self._centre = self._tape.vector("centre", total)
        self._length, self._unit, self._load = self._units(spots, wrench)
        mean = self._tape.let("mean_weight", sympy.Add(*weight) / count)
        self._feet = [
            _Foot(
                self._tape.vector("r", scaled(1 / self._length, minus(spot, self._centre))),
                _vector(normals[3 * i : 3 * i + 3]),
                mu[i],
                self._tape.let("ease", mean / weight[i]),
                self._tape.let("most", most[i] / self._unit),
            )
            for i, spot in enumerate(spots)
        ]

    def _units(self, spots: Sequence[Vec], wrench: Sequence[sympy.Symbol]) -> tuple[sympy.Expr, sympy.Expr, list[sympy.Expr]]:
        """The stance's length, the load's size, and minus the load about the centre in these."""
        tape = self._tape
        arms = [tape.vector("arm", minus(spot, self._centre)) for spot in spots]
        size = tape.let("spread2", sympy.Add(*(tape.let("arm2", dot(arm, arm)) for arm in arms)) / len(spots))
        length = tape.let("length", sympy.sqrt(chosen(less(_TINY, size), size, _ONE)))
        force = _vector(wrench[:3])
        moment = tape.vector("moment", scaled(1 / length, minus(_vector(wrench[3:]), cross(self._centre, force))))
        square = tape.let("load2", dot(force, force) + dot(moment, moment))
        unit = tape.let("load", sympy.sqrt(chosen(less(_TINY, square), square, _ONE)))
        return length, unit, [tape.let("balance", -part / unit) for part in (*force, *moment)]

    def _pulled(self, y: Sequence[sympy.Expr], foot: _Foot) -> Vec:
        """What the multipliers make of a force of the foot."""
        return plus(_vector(y[:3]), cross(_vector(y[3:6]), foot.r))

    def _image(self, y: Sequence[sympy.Expr], foot: _Foot) -> _Image:
        tape, n = self._tape, foot.normal
        z = tape.vector("z", scaled(foot.ease, self._pulled(y, foot)))
        push = tape.let("push", dot(n, z))
        tangent = tape.vector("tangent", minus(z, scaled(push, n)))
        square = tape.let("tangent2", dot(tangent, tangent))
        size = tape.let("tangent_size", sympy.sqrt(chosen(less(_TINY, square), square, _TINY)))
        low = tape.let("low", chosen(less(push, foot.most), push, foot.most))
        reach = tape.let("reach", push + foot.mu * size)
        loaded = less(_ZERO, reach)
        inside = both(loaded, at_most(size, foot.mu * low))
        steep = tape.let("steep", 1 / (1 + foot.mu**2))
        reached = tape.let("reached", chosen(inside, push, chosen(loaded, reach * steep, _ZERO)))
        a = tape.let("normal_force", chosen(less(reached, foot.most), reached, foot.most))
        free = chosen(both(loaded, at_most(reached, foot.most)), _ONE, _ZERO)
        across = tape.let("across", chosen(inside, _ONE, foot.mu * a / size))
        t = tape.vector("t", scaled(1 / size, tangent))
        slope = chosen(inside, _ZERO, foot.mu)
        return _Image(
            force=tape.vector("force", plus(scaled(a, n), scaled(across, tangent))),
            u=tape.vector("u", plus(n, scaled(slope, t))),
            t=t,
            along=tape.let("along", free * chosen(inside, _ONE, steep)),
            across=across,
            bent=chosen(inside, _ZERO, _ONE),
            inside=inside,
        )

    def _value(self, y: Sequence[sympy.Expr]) -> tuple[list[_Image], list[sympy.Expr], sympy.Expr]:
        """All images, the slope b - A f, and the dual's value."""
        images = [self._image(y, foot) for foot in self._feet]
        moments = [self._tape.vector("turn", cross(foot.r, image.force)) for foot, image in zip(self._feet, images, strict=True)]
        parts = [(*image.force, *moment) for image, moment in zip(images, moments, strict=True)]
        slope = [self._tape.let("slope", self._load[j] - sympy.Add(*(part[j] for part in parts))) for j in range(6)]
        spent = [self._spent(y, foot, image) for foot, image in zip(self._feet, images, strict=True)]
        return images, slope, self._tape.let("dual", dot(self._load, y[:6]) - sympy.Add(*spent))

    def _spent(self, y: Sequence[sympy.Expr], foot: _Foot, image: _Image) -> sympy.Expr:
        """The foot's part of the dual."""
        pull = self._tape.vector("pull", self._pulled(y, foot))
        half = self._tape.let("half", dot(image.force, image.force) / (2 * foot.ease))
        return self._tape.let("spent", dot(pull, image.force) - half)

    def _curvature(self, images: Sequence[_Image], damping: sympy.Expr) -> list[list[sympy.Expr]]:
        """The sum of ease A P' A', lower triangle, its diagonal raised."""
        blocks = [self._block(foot, image) for foot, image in zip(self._feet, images, strict=True)]
        return [
            [self._tape.let("H", sympy.Add(*(block[i][j] for block in blocks)) + (damping if i == j else 0)) for j in range(i + 1)]
            for i in range(6)
        ]

    def _block(self, foot: _Foot, image: _Image) -> list[list[sympy.Expr]]:
        """One foot's [P', ., ; r x P', r x P' x r'], lower triangle."""
        tape, n, u, t = self._tape, foot.normal, image.u, image.t
        along, across = tape.let("share", foot.ease * image.along), tape.let("share", foot.ease * image.across)
        bent = tape.let("share", across * image.bent)
        derivative = [
            tape.vector(
                "P", [along * u[i] * u[j] - across * n[i] * n[j] - bent * t[i] * t[j] + (across if i == j else 0) for j in range(3)]
            )
            for i in range(3)
        ]
        columns = [tape.vector("B", cross(foot.r, _vector([row[m] for row in derivative]))) for m in range(3)]
        rows = [_vector([column[i] for column in columns]) for i in range(3)]
        corner = [tape.vector("C", cross(foot.r, row)) for row in rows]
        return [*([*row] for row in derivative), *([*row, *end] for row, end in zip(rows, corner, strict=True))]

    def first(self, words: Signature) -> Function:
        """The multipliers of forces without cones."""
        rest = [_Image(foot.r, foot.normal, foot.normal, _ONE, _ONE, _ZERO, sympy.true) for foot in self._feet]
        y = solve_symmetric(self._curvature(rest, _LEAST_DAMPING), self._load, self._tape)
        return self._tape.function(words, [*y, _ONE])

    def step(self, words: Signature, *, last: bool = False) -> Function:
        """The multipliers a damped step on, where that is better; the `last` steps are Newton's, as they are."""
        tape, old = self._tape, symbols_of(MULTIPLIERS)
        images, slope, dual = self._value(old)
        square = tape.let("slope2", dot(slope, slope))
        size = sympy.sqrt(chosen(less(_TINY, square), square, _TINY))
        damping = _LEAST_DAMPING if last else tape.let("damping", old[6] * chosen(less(size, _ONE), size, _ONE) + _LEAST_DAMPING)
        move = solve_symmetric(self._curvature(images, damping), slope, tape)
        new = [tape.let("y", y + part) for y, part in zip(old[:6], move, strict=True)]
        if last:
            return tape.function(words, [*new, old[6]])
        _, slope_there, dual_there = self._value(new)
        square_there = tape.let("slope2", dot(slope_there, slope_there))
        better = less(dual, dual_there)
        nearer = less(square_there, square)
        kept = [chosen(better, there, chosen(nearer, there, here)) for here, there in zip(old[:6], new, strict=True)]
        gain = chosen(better, sympy.Rational(1, 10), chosen(nearer, sympy.Rational(1, 10), sympy.Integer(10)))
        return tape.function(words, [*kept, old[6] * gain])

    def verdict(self, words: Signature) -> Function:
        """f, status, state, certificate, violation."""
        tape, y = self._tape, symbols_of(MULTIPLIERS)[:6]
        images, slope, _ = self._value(y)
        square = tape.let("slope2", dot(slope, slope))
        sizes = [tape.let("force2", dot(image.force, image.force)) for image in images]
        gain = tape.let("gain", dot(self._load, y))
        idle = both(less(_ZERO, gain), at_most(sympy.Add(*sizes), _ZERO))
        status = chosen(at_most(square, _BALANCED2), _OK, chosen(idle, _INFEASIBLE, _NO_CONVERGENCE))
        bounds = [tape.let("bound", chosen(at_most(0, foot.most), 1, 0)) for foot in self._feet]  # infinite ones are fine
        bounded = tape.let("bounded", sympy.Add(*bounds))
        sane = both(Finite(self._finite), at_most(len(self._feet), bounded))
        status = chosen(both(sane, both(at_most(self._facets, _ZERO), at_most(_ZERO, self._facets))), status, _BAD_INPUT)
        states = [chosen(at_most(size, _ZERO), _FREE, chosen(image.inside, _ZERO, _ONE)) for image, size in zip(images, sizes, strict=True)]
        forces = [self._unit * part for image in images for part in image.force]
        return tape.function(words, [*forces, status, *states, *self._certificate(y, gain, idle), self._unit * sympy.sqrt(square)])

    def _certificate(self, y: Sequence[sympy.Expr], gain: sympy.Expr, proven: sympy.Basic) -> list[sympy.Expr]:
        """The multipliers in the inputs' frame and units, certificate . wrench = 1; 0 where nothing is proven."""
        scale = self._tape.let("scale", chosen(proven, -1 / (gain * self._unit), _ZERO))
        force, moment = _vector(y[:3]), scaled(1 / self._length, _vector(y[3:]))
        return [scale * part for part in (*minus(force, cross(moment, self._centre)), *moment)]


def _vector(values: Sequence[sympy.Expr]) -> Vec:
    return (values[0], values[1], values[2])
