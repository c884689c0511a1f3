"""Inertia of a rigid body as ten numbers that add up: mass, first moment and tensor about the origin of a frame."""

from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Body
from walkgen.symbolic.frames import Frame, Parameters, expression
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Columns, Tape, Vec, dot, minus, plus, scaled, times

Tensor = tuple[sympy.Expr, sympy.Expr, sympy.Expr, sympy.Expr, sympy.Expr, sympy.Expr]
"""xx, yy, zz, xy, xz, yz."""

_ENTRIES = ("xx", "yy", "zz", "xy", "xz", "yz")
_ZERO = sympy.S.Zero
NO_TENSOR: Tensor = (_ZERO,) * 6


@dataclass(frozen=True)
class Inertia:
    """Mass (kg), mass times centre of mass (kg m) and inertia tensor (kg m^2), both from the frame's origin, in its axes."""

    mass: sympy.Expr = _ZERO
    moment: Vec = ZERO_VECTOR
    tensor: Tensor = NO_TENSOR

    def __add__(self, other: "Inertia") -> "Inertia":
        return Inertia(self.mass + other.mass, plus(self.moment, other.moment), _summed(self.tensor, other.tensor))

    def __sub__(self, other: "Inertia") -> "Inertia":
        return self + Inertia(-other.mass, scaled(sympy.S.NegativeOne, other.moment), _tensor([-entry for entry in other.tensor]))

    @property
    def wheel(self) -> sympy.Expr:
        """What zz is more than that of a flat body's xx and yy; turning about z leaves it."""
        xx, yy, zz, _, _, _ = self.tensor
        return zz - xx - yy

    @property
    def columns(self) -> Columns:
        """The tensor as a matrix."""
        xx, yy, zz, xy, xz, yz = self.tensor
        return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))

    def seen_from(self, lever: Vec) -> "Inertia":
        """About another point, from which this origin lies at `lever`: parallel axes, whatever the centre of mass."""
        x, y, z = lever
        along = [2 * component * first for component, first in zip(lever, self.moment, strict=True)]
        squares = [self.mass * component**2 for component in lever]
        added = [along[k] + along[m] + squares[k] + squares[m] for k, m in ((1, 2), (0, 2), (0, 1))]
        for a, b, first, second in ((0, 1, x, y), (0, 2, x, z), (1, 2, y, z)):
            added.append(-first * self.moment[b] - second * self.moment[a] - self.mass * first * second)
        return Inertia(self.mass, plus(self.moment, scaled(self.mass, lever)), _summed(self.tensor, _tensor(added)))

    def turned(self, columns: Columns, tape: Tape, name: str) -> "Inertia":
        """In the axes in which this frame's axes are `columns`."""
        if columns == IDENTITY:
            return self
        half = [tape.vector(f"{name}_turned_{axis}", times(columns, column)) for axis, column in zip("xyz", self.columns, strict=True)]
        rows = [[columns[axis][row] for axis in range(3)] for row in range(3)]
        full = {(a, b): dot([column[a] for column in half], rows[b]) for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))}
        return Inertia(self.mass, times(columns, self.moment), _tensor(list(full.values())))

    def spun(self, cosine: sympy.Expr, sine: sympy.Expr, tape: Tape, name: str, *, first: str = "x") -> "Inertia":
        """Turned about z; of xx and yy the `first` is computed and the other left by the trace."""
        xx, yy, zz, xy, xz, yz = self.tensor
        p, q = (cosine, -sine) if first == "x" else (sine, cosine)
        half_x, half_y = tape.let(f"{name}_spun_x", p * xx + q * xy), tape.let(f"{name}_spun_y", p * xy + q * yy)
        direct = tape.let(f"{name}_{first}{first}", p * half_x + q * half_y)
        mixed = (sine * half_x + cosine * half_y) if first == "x" else (cosine * half_x - sine * half_y)
        rest = tape.let(f"{name}_rest", tape.let(f"{name}_trace", xx + yy) - direct)
        new_xx, new_yy = (direct, rest) if first == "x" else (rest, direct)
        x, y, z = self.moment
        moment = tape.vector(f"{name}_moment", (cosine * x - sine * y, sine * x + cosine * y, z))
        new_xz, new_yz = tape.let(f"{name}_xz", cosine * xz - sine * yz), tape.let(f"{name}_yz", sine * xz + cosine * yz)
        return Inertia(self.mass, moment, (new_xx, new_yy, zz, tape.let(f"{name}_xy", mixed), new_xz, new_yz))

    def named(self, tape: Tape, name: str) -> "Inertia":
        """Every entry under a name; numbers folded."""
        tensor = _tensor([tape.let(f"{name}_{entry}", value) for entry, value in zip(_ENTRIES, self.tensor, strict=True)])
        return Inertia(tape.let(f"{name}_mass", self.mass), tape.vector(f"{name}_moment", self.moment), tensor)

    def angular(self, spin: Vec) -> Vec:
        """Tensor times angular velocity."""
        return times(self.columns, spin)


WEIGHTLESS = Inertia()


def inertia_of(body: Body, parameters: Parameters, tape: Tape, name: str) -> Inertia:
    """A body of the model about its own frame's origin."""
    x, y, z = (expression(component, parameters) for component in body.com)
    about_com = Inertia(expression(body.mass, parameters), ZERO_VECTOR, _tensor([expression(entry, parameters) for entry in body.inertia]))
    centre = tape.vector(f"{name}_com", (x, y, z))
    return about_com.named(tape, f"{name}_own").seen_from(centre).named(tape, name)


def placed(inertia: Inertia, frame: Frame, tape: Tape, name: str) -> Inertia:
    """The inertia about the origin, and in the axes, of the frame in which its own is `frame`."""
    turned = inertia.turned(frame.rotation, tape, name).named(tape, name)
    return turned.seen_from(frame.origin).named(tape, name)


def axial(inertia: Inertia) -> Inertia:
    """The part that a body could as well carry on a neighbour that shares its z axis: any masses on that axis.

    It takes the tensor's xx, so that what remains has none (minimal inertial parameters: Gautier and Khalil 1990).
    """
    extent = inertia.tensor[0]
    return Inertia(inertia.mass, (_ZERO, _ZERO, inertia.moment[2]), (extent, extent, _ZERO, _ZERO, _ZERO, _ZERO))


def difference(inertia: Inertia, lever: Vec, mass: sympy.Expr) -> Inertia:
    """Without a point mass at `lever`."""
    return inertia - Inertia(mass).seen_from(lever)


def _summed(one: Tensor, other: Tensor) -> Tensor:
    return _tensor([a + b for a, b in zip(one, other, strict=True)])


def _tensor(entries: list[sympy.Expr]) -> Tensor:
    xx, yy, zz, xy, xz, yz = entries
    return (xx, yy, zz, xy, xz, yz)


def relative(inertia: Inertia, centre: Vec) -> Inertia:
    """About the point `centre` of its own frame."""
    return inertia.seen_from(minus(ZERO_VECTOR, centre))
