"""Links as straight beams of constant section between their joints: what makes a locked leg or chain yield under loads (theory 4.3)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import sympy

from walkgen.model.mechanism import Joint, Limb, Mechanism, Section, Transform
from walkgen.model.transform import inverse
from walkgen.symbolic.choices import chosen, less
from walkgen.symbolic.frames import Frame, Parameters, expression, frame_of, parameter_symbols
from walkgen.symbolic.path import Kinematics
from walkgen.symbolic.tape import ZERO_VECTOR, Columns, Tape, Vec, cross, dot, minus, plus, scaled, times

Rows = list[list[sympy.Expr]]
_PARALLEL = sympy.Float("1e-20", 50)


@dataclass(frozen=True)
class Beam:
    """A link in the path's base axes: `axes` x along it, y, z; its middle; what a unit force or moment about each axis gives.

    `stretch` is L/EA (m/N); `turns` are L/GJ, L/EIy, L/EIz (rad/(N m)); `bends` are L^3/12EIz along y and L^3/12EIy along z (m/N): how
    the ends part under a shear force that has no moment about the middle.
    """

    axes: Columns
    middle: Vec
    stretch: sympy.Expr
    turns: Vec
    bends: tuple[sympy.Expr, sympy.Expr]

    def lever(self, point: Vec, tape: Tape) -> Vec:
        """From the middle to a point, along the link's axes."""
        away = tape.vector("away", minus(point, self.middle))
        x, y, z = (dot(axis, away) for axis in self.axes)
        return tape.vector("lever", (x, y, z))

    def shared(self, first: Vec, second: Vec, tape: Tape) -> Rows:
        """How far the first point yields [3] for a unit force [3] in the second: the integral of sum_k m_k m_k' over the link.

        Args:
            first: point fixed beyond the link, base axes.
            second: another one, or the same.
            tape: where the intermediates go.
        """
        return self._in_base(self._local(self.lever(first, tape), self.lever(second, tape), tape), tape)

    def twisted(self, point: Vec, tape: Tape) -> Rows:
        """How far a point beyond the link yields [3] for a unit moment [3] there: the integral of sum_k m_k e_k'."""
        moments = [_unit_moments(axis, self.lever(point, tape)) for axis in range(3)]
        local = [[tape.let("twist", turn * m[row]) for turn, m in zip(self.turns, moments, strict=True)] for row in range(3)]
        return self._in_base(local, tape)

    def turned(self, tape: Tape) -> Rows:
        """How far what is beyond the link turns [3] for a unit moment [3]: the integral of sum_k e_k e_k'."""
        return self._in_base(
            [[turn if row == column else sympy.S.Zero for column in range(3)] for row, turn in enumerate(self.turns)], tape
        )

    def _in_base(self, local: Rows, tape: Tape) -> Rows:
        """A matrix along the link's axes in the base's."""
        half = [tape.vector("part", _combined(row, self.axes)) for row in local]
        return [[dot([axis[row] for axis in self.axes], [part[column] for part in half]) for column in range(3)] for row in range(3)]

    def _local(self, a: Vec, b: Vec, tape: Tape) -> Rows:
        """Along the link's axes; with m(r) affine, Simpson's rule is the product of the means and that of the half differences / 3."""
        diagonal = (self.stretch, *self.bends)
        moments = [(_unit_moments(axis, a), _unit_moments(axis, b)) for axis in range(3)]
        rows: Rows = []
        for row, column in product(range(3), repeat=2):
            terms = [turn * m[row] * n[column] for turn, (m, n) in zip(self.turns, moments, strict=True)]
            entry = sympy.Add(*terms, diagonal[row] if row == column else sympy.S.Zero)
            rows = [*rows, []] if column == 0 else rows
            rows[row].append(tape.let("soft", entry))
        return rows

    def under(self, point: Vec, force: Vec, moment: Vec, tape: Tape) -> Vec:
        """How far a point beyond the link yields under a load there.

        Args:
            point: fixed beyond the link, base axes.
            force: in base axes.
            moment: about the base's origin.
            tape: where the intermediates go.
        """
        about = tape.vector("load_about_middle", minus(moment, cross(self.middle, force)))
        lever = self.lever(point, tape)
        push = [tape.let("load_along", dot(axis, force)) for axis in self.axes]
        spin = [tape.let("load_turns", turn * dot(axis, about)) for turn, axis in zip(self.turns, self.axes, strict=True)]
        moments = [_unit_moments(axis, lever) for axis in range(3)]
        direct = [compliance * along for compliance, along in zip((self.stretch, *self.bends), push, strict=True)]
        local = [tape.let("load_yield", direct[row] + dot(spin, [m[row] for m in moments])) for row in range(3)]
        return _combined(local, self.axes)


def _combined(weights: Sequence[sympy.Expr], axes: Columns) -> Vec:
    x, y, z = (dot(weights, [axis[row] for axis in axes]) for row in range(3))
    return (x, y, z)


def _unit_moments(axis: int, lever: Vec) -> Vec:
    """m_k = e_k x lever: moments about axis k of unit forces at the lever."""
    unit = [sympy.S.Zero] * 3
    unit[axis] = sympy.S.One
    return cross((unit[0], unit[1], unit[2]), lever)


def beams_of(mechanism: Mechanism, limbs: Sequence[Limb], kinematics: Kinematics) -> tuple[tuple[Beam | None, ...], ...]:
    """For every limb of a path, a beam a joint: of the link that the joint moves; None where it has no length or is rigid.

    A link runs from where its joint stands to where the next one does, a leg's last to the foot, a chain's last to its last frame.
    """
    found, place = [], 0
    for limb in limbs:
        found.append(limb_beams(mechanism, limb, kinematics, place))
        place += len(limb.joints)
    return tuple(found)


def limb_beams(mechanism: Mechanism, limb: Limb, kinematics: Kinematics, place: int) -> tuple[Beam | None, ...]:
    """Of one limb of a path, whose first joint is the path's at `place`."""
    if not limb.joints:
        return ()
    stop = place + len(limb.joints)
    links = links_of(limb, kinematics.path.q[place:stop], parameter_symbols(mechanism))
    parts = zip(limb.joints, links, kinematics.frames[place + 1 : stop + 1], strict=True)
    return tuple(_beam(mechanism, joint, link, frame, kinematics.tape) for joint, link, frame in parts)


def all_have_sections(mechanism: Mechanism, leg: Limb) -> bool:
    """Whether every link of some length has a section; of a linkage, one of its links: the others are rigid."""
    if leg.linkage is None:
        return _covered(mechanism, leg)
    return any(leg.linkage.sections) and all(_covered(mechanism, series) for series in (leg.inner, leg.outer) if series.joints)


def _covered(mechanism: Mechanism, limb: Limb) -> bool:
    links = links_of(limb, sympy.symbols(f"q:{len(limb.joints)}"), parameter_symbols(mechanism))
    return all(joint.section or link.vector == ZERO_VECTOR for joint, link in zip(limb.joints, links, strict=True))


@dataclass(frozen=True)
class Link:
    """A link in the frame that moves with its joint: both ends, and the frame at the far one."""

    near: Vec
    far: Frame

    @property
    def vector(self) -> Vec:
        """From near to far."""
        x, y, z = (sympy.expand(component) for component in minus(self.far.origin, self.near))
        return (x, y, z)


def links_of(limb: Limb, q: Sequence[sympy.Expr], parameters: Parameters) -> tuple[Link, ...]:
    """Every joint's link at joint values q."""
    ends = [*(frame_of(_place(joint), parameters) for joint in limb.joints[1:]), _end(limb, parameters)]
    nears = [_stand(joint, value, parameters) for joint, value in zip(limb.joints, q, strict=True)]
    return tuple(Link(near, far) for near, far in zip(nears, ends, strict=True))


def _end(limb: Limb, parameters: Parameters) -> Frame:
    return frame_of(limb.tip, parameters) if limb.child is None else Frame()


def _place(joint: Joint) -> Transform:
    """Where the joint stands in the frame before; a turn that only brings z onto an axis given by name is none of the frame's."""
    turn = inverse(joint.after)
    return joint.before[: -len(turn)] if turn and joint.before[-len(turn) :] == turn else joint.before


def _stand(joint: Joint, value: sympy.Expr, parameters: Parameters) -> Vec:
    """Where the joint stands, in the frame that moves with it; a slide lengthens the link."""
    after = frame_of(joint.after, parameters)
    shift = joint.sign * value + expression(joint.zero, parameters) if joint.kind == "prismatic" else sympy.S.Zero
    away = plus(after.origin, (sympy.S.Zero, sympy.S.Zero, shift))
    x, y, z = (-dot(column, away) for column in after.rotation)
    return (x, y, z)


def _beam(mechanism: Mechanism, joint: Joint, link: Link, frame: tuple[Columns, Vec], tape: Tape) -> Beam | None:
    if not joint.section or link.vector == ZERO_VECTOR:
        return None
    section = next(section for section in mechanism.sections if section.name == joint.section)
    axes, length = _axes(link, tape)
    columns, origin = frame
    x, y, z = (tape.vector(f"{joint.name}_link_{name}", times(columns, axis)) for name, axis in zip("xyz", axes, strict=True))
    middle = times(columns, scaled(sympy.Rational(1, 2), plus(link.near, link.far.origin)))
    turns, stretch = _flexibilities(section, length, parameter_symbols(mechanism), tape)
    about_y, about_z = (tape.let(f"{joint.name}_shear", length**2 * turn / 12) for turn in turns[1:])
    return Beam((x, y, z), tape.vector(f"{joint.name}_middle", plus(origin, middle)), stretch, turns, (about_z, about_y))


def _flexibilities(section: Section, length: sympy.Expr, parameters: Parameters, tape: Tape) -> tuple[Vec, sympy.Expr]:
    E, G, A, Iy, Iz, J = (expression(value, parameters) for value in (section.E, section.G, section.A, section.Iy, section.Iz, section.J))
    x, y, z = (tape.let(f"{section.name}_turn", length / rigidity) for rigidity in (G * J, E * Iy, E * Iz))
    return (x, y, z), tape.let(f"{section.name}_stretch", length / (E * A))


def _axes(link: Link, tape: Tape) -> tuple[Columns, sympy.Expr]:
    """x along the link, z of the far end's frame across it (its x where z runs along the link), y = z x x; and the length."""
    along = tape.vector("along_link", link.vector)
    square = tape.let("length2", dot(along, along))
    length = tape.let("length", sympy.sqrt(square))
    there = length if length.is_number else tape.let("length_or_1", chosen(less(sympy.S.Zero, square), length, sympy.S.One))
    x = tape.vector("link_x", scaled(1 / there, along))
    up = link.far.rotation[0] if _runs_along(link.vector, link.far.rotation[2]) else link.far.rotation[2]
    across = tape.vector("across_link", minus(up, scaled(tape.let("up_along", dot(up, x)), x)))
    size = tape.let("across_size", sympy.sqrt(dot(across, across)))
    z = tape.vector("link_z", scaled(1 / size, across))
    return (x, tape.vector("link_y", cross(z, x)), z), length


def _runs_along(vector: Vec, axis: Vec) -> bool:
    """Whether they are parallel for all joint values and parameters, judged at some."""
    symbols = sorted({symbol for entry in (*vector, *axis) for symbol in entry.free_symbols}, key=str)
    return all(_parallel_at(vector, axis, values) for values in _samples(symbols))


def _samples(symbols: Sequence[sympy.Symbol]) -> Iterator[dict[sympy.Symbol, sympy.Expr]]:
    for turn in (sympy.Rational(3, 7), sympy.Rational(5, 11)):
        yield {symbol: turn + sympy.Rational(index, 13) for index, symbol in enumerate(symbols)}


def _parallel_at(vector: Vec, axis: Vec, values: dict[sympy.Symbol, sympy.Expr]) -> bool:
    a, b = ([sympy.sympify(entry).subs(values).evalf(50) for entry in vec] for vec in (vector, axis))
    normal = cross((a[0], a[1], a[2]), (b[0], b[1], b[2]))
    return bool(dot(normal, normal) <= _PARALLEL**2 * dot(a, a))
