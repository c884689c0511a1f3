"""All drives that put a linkage's foot on a target: the plane turned to hold it, then dyad after dyad back to the drives."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import sympy

from walkgen.model.classify import InverseClass, inverse_class
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism, Transform
from walkgen.signature import Port
from walkgen.spec.assur import SIDES, Group
from walkgen.spec.scalar import ZERO
from walkgen.symbolic.branches import BAD_INPUT, DUPLICATE, INFEASIBLE, NO_CONVERGENCE, OK, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import both, chosen, less
from walkgen.symbolic.driven_search import DrivenSearch, admissible_words
from walkgen.symbolic.forward import Route
from walkgen.symbolic.frames import Frame, Parameters, expression, frame_of, parameter_symbols
from walkgen.symbolic.function import Angle, Both, Finite, Function, Less, LessEqual, Residue, Same, Select, Solve, Step
from walkgen.symbolic.limits import row_distances
from walkgen.symbolic.placing import Placing
from walkgen.symbolic.planar import Planar, difference, outer, square
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.rows import TARGET, parameters_of, row_ports
from walkgen.symbolic.selection import NEAREST_BRANCH, ONE_BRANCH, nearest
from walkgen.symbolic.tape import Tape, Vec, dot, minus, plus, symbols_of, times

_TOLERANCE = sympy.Rational(1, 10**11)
"""Of a group's margin: what rounding leaves of a target at the edge, 1e-12 of the reach outside it."""
DISTANCE_DOC = (
    "Distance from p of the foot that the drives of every branch of inverse assemble: 0 but for rounding where it is OK, NaN where they "
    "assemble nothing and for a bad input."
)
_SOURCE = "theory 2.3: dyads in closed form, run backwards"
_STATUS = Port("status", kind="integer")

_ZERO, _ONE = sympy.S.Zero, sympy.S.One

Exprs = Sequence[sympy.Expr]


@dataclass(frozen=True)
class Plane:
    """A solution for the joint before the linkage or after it: its q and the target in the plane.

    `beside` is the square of how far the target is from the plane where no turn changes that, `margin` how far a turn is from where its two
    ways are one, below 0 beyond; `free` says whether any q will do as well. Of a joint after the linkage `held` is which point of its last
    link is to be at the target.
    """

    q: tuple[sympy.Expr, ...]
    target: Planar
    beside: sympy.Expr = _ZERO
    margin: sympy.Expr = _ONE
    free: sympy.Basic = sympy.false
    after: tuple[sympy.Expr, ...] = ()
    held: Planar | None = None


@dataclass(frozen=True)
class Arrival:
    """Of a row whose triad is closed by steps: where the foot gets to, the triad's unknowns there, and the status of the way."""

    target: Planar
    unknowns: Exprs
    state: sympy.Expr


def linkage_inverse(mechanism: Mechanism, leg: Limb) -> Iterator[Solve | Function]:
    """`inverse` and what is chosen or measured of its rows, of a linkage that dyads alone place, whether drives or the foot hold it."""
    found = inverse_class(mechanism, leg)
    results = row_ports(leg, found, "q", "status")
    yield dyad_rows(mechanism, leg, "inverse", results)
    yield _inverse_branch(mechanism, leg, found)
    yield _inverse_near(mechanism, leg, found)
    yield _inverse_admissible(mechanism, leg, found)
    yield _inverse_distance(mechanism, leg, found)


def _inverse_branch(mechanism: Mechanism, leg: Limb, found: InverseClass) -> Function:
    """One row by its number, without the others."""
    assert leg.linkage is not None
    tape, slots, port = Tape(), len(found.branch_names), Port("branch", kind="integer")
    branch = symbols_of(port)[0]
    rows = LinkageRows(leg, leg.linkage, symbols_of(TARGET), parameter_symbols(mechanism), tape)
    values, status = rows.one(branch, slots)
    known = Both(LessEqual(0, branch), Less(branch, slots))
    stray = tape.let("stray", Select(known, 0, sympy.sqrt(-1 - branch**2)))  # NaN for an unknown branch
    outputs = [joint_port("q", leg.joints), _STATUS]
    words = signature(mechanism, leg.name, "inverse_branch", [TARGET, port], outputs, ONE_BRANCH, _SOURCE)
    return tape.function(words, [*(value + stray for value in values), Select(known, status, BAD_INPUT)])


def _inverse_near(mechanism: Mechanism, leg: Limb, found: InverseClass) -> Solve:
    """One row of all."""
    slots = len(found.branch_names)
    rows = row_ports(leg, found, "rows", "states")
    port = joint_port("q_seed", leg.joints)
    words = signature(mechanism, leg.name, "inverse_near", [TARGET, port], [joint_port("q", leg.joints), _STATUS], NEAREST_BRANCH, _SOURCE)
    kernel = dyad_rows(mechanism, leg, "inverse_rows", rows)
    steps = (
        Step(kernel, ("p", *parameters_of(mechanism), "rows", "states")),
        Step(nearest(mechanism, leg, slots), ("rows", "states", port.name, "q", "status")),
    )
    return Solve(words, rows, steps, Solve(words, rows, steps))


def _inverse_admissible(mechanism: Mechanism, leg: Limb, found: InverseClass) -> Solve:
    """One row of all that is within the limits, or what a search within them finds."""
    rows, searched = row_ports(leg, found, "rows", "states"), DrivenSearch(mechanism, Route(leg.name, (leg,)))
    kernel = Step(dyad_rows(mechanism, leg, "inverse_rows", rows), ("p", *parameters_of(mechanism), "rows", "states"))
    steps = (kernel, *searched.within("rows", "states", len(found.branch_names)))
    return Solve(admissible_words(mechanism, leg), (*rows, *searched.ports), steps, callbacks=(searched.motion,))


def _inverse_distance(mechanism: Mechanism, leg: Limb, found: InverseClass) -> Solve:
    """Of all rows."""
    rows, output = row_ports(leg, found, "rows", "states"), Port("distance", (len(found.branch_names),), "m")
    words = signature(mechanism, leg.name, "inverse_distance", [TARGET], [output], DISTANCE_DOC, "as inverse")
    given = parameters_of(mechanism)
    steps = (
        Step(dyad_rows(mechanism, leg, "inverse_rows", rows), ("p", *given, "rows", "states")),
        Step(row_distances(mechanism, leg, output), ("rows", "p", *given, "distance")),
    )
    return Solve(words, rows, steps, Solve(words, rows, steps))


def dyad_rows(mechanism: Mechanism, leg: Limb, name: str, outputs: tuple[Port, Port]) -> Function:
    """All rows, each in closed form."""
    assert leg.linkage is not None
    tape = Tape()
    rows = LinkageRows(leg, leg.linkage, symbols_of(TARGET), parameter_symbols(mechanism), tape).all()
    doc = (
        "All joint values that reach p, a row a branch; unreachable rows hold the closest configuration of the dyad that cannot close, "
        "INFEASIBLE ones reach p with a dyad on the other side than the spec's assembly."
    )
    words = signature(mechanism, leg.name, name, [TARGET], outputs, doc, _SOURCE)
    return tape.function(words, [*(value for row, _ in rows for value in row), *(status for _, status in rows)])


class LinkageRows:
    """The branches on one tape."""

    def __init__(self, leg: Limb, linkage: Linkage, p: Exprs, parameters: Parameters, tape: Tape) -> None:
        self._leg, self._linkage, self._parameters, self._tape = leg, linkage, parameters, tape
        self._p: Vec = (p[0], p[1], p[2])
        self._taint = tape.let("taint", sympy.Add(*(Residue(x) for x in (*p, *parameters.values()))))

    def all(self) -> list[tuple[list[sympy.Expr], sympy.Expr]]:
        """q and status of every branch, in order."""
        choices = list(product((1, -1), repeat=len(self._sided)))
        return [self.row(turn, signs) for turn in range(len(self.planes)) for signs in choices]

    @cached_property
    def planes(self) -> tuple[Plane, ...]:
        """Both ways of the joint that turns; one where there is none."""
        return tuple(self._plane(turn) for turn in ((_ONE, -_ONE) if self._turning else (_ONE,)))

    @property
    def _turning(self) -> bool:
        """Whether a joint before the linkage or after it has two ways."""
        return any(joint.kind == "revolute" for joint in (*self._leg.serial, *self._leg.distal))

    def row(self, turn: int, signs: Sequence[int], arrival: Arrival | None = None) -> tuple[list[sympy.Expr], sympy.Expr]:
        """q and status for one of the planes and the signs of the dyads that have sides."""
        chosen_signs = dict(zip(self._sided, map(sympy.Integer, signs), strict=True))
        return self._row(self.planes[turn], chosen_signs, sympy.true if turn else sympy.false, arrival)

    def one(self, branch: sympy.Expr, slots: int) -> tuple[list[sympy.Expr], sympy.Expr]:
        """q and status of the branch of this number, whose binary digits are its signs."""
        signs = []
        for _ in range(slots.bit_length() - 1):
            slots //= 2
            upper = Less(branch, slots)
            signs.append(self._tape.let("sign", Select(upper, 1, -1)))
            branch = self._tape.let("rest", Select(upper, branch, branch - slots))
        turn = signs.pop(0) if self._turning else _ONE
        return self._row(self._plane(turn), dict(zip(self._sided, signs, strict=True)), less(turn, 0))

    @property
    def _sided(self) -> list[str]:
        """Names of the groups that have two sides."""
        return [group.name for group in self._linkage.inverse.dyads if SIDES[group.kind]]

    def _plane(self, turn: sympy.Expr) -> Plane:
        """Where the joint before the linkage, if there is one, puts its plane; `turn` is 1 or -1."""
        mount = frame_of(self._leg.mount, self._parameters)
        plane = frame_of(self._leg.tip, self._parameters)
        if not self._leg.serial:
            x, y, z = self._local(mount * plane, self._p)
            if self._leg.distal:
                return self._hung(self._tape.vector("seen", (x, y, z)), turn)
            return Plane((), (x, y), beside=self._tape.let("off_plane", z**2))
        joint = self._leg.serial[0]
        base = mount * frame_of(joint.before, self._parameters)
        hung = frame_of(joint.after, self._parameters) * plane
        return self._turned(hung, self._tape.vector("seen", self._local(base, self._p)), turn)

    def _hung(self, seen: Vec, sign: sympy.Expr) -> Plane:
        """The joint after the linkage takes the foot as far from the plane as the target `seen` in it is."""
        joint, tape = self._leg.distal[0], self._tape
        stand, lever = (self._frame(*poses) for poses in ((joint.before,), (joint.after, self._leg.foot)))
        nx, ny, nz = (column[2] for column in stand.rotation)
        x, y, z = lever.origin
        zero = expression(joint.zero, self._parameters)
        if joint.kind == "prismatic":
            way = tape.let("hung_way", (seen[2] - stand.origin[2] - nx * x - ny * y - nz * z) / nz)
            margin, value, swung = _ONE, joint.sign * (way - zero), (x, y, z + way)
        else:
            a, b = tape.let("hung_a", nx * x + ny * y), tape.let("hung_b", ny * x - nx * y)
            c = tape.let("hung_c", seen[2] - stand.origin[2] - nz * z)
            size, inside, (cosine, sine) = self._crossing("hung", (a, b, c), sign)
            turn = tape.let("hung_turn", Angle(sine, cosine))
            cos, sin = tape.let("hung_cosine", sympy.cos(turn)), tape.let("hung_sine", sympy.sin(turn))
            margin, swung = tape.let("hung_margin", inside / size), (cos * x - sin * y, sin * x + cos * y, z)
            value = joint.sign * (turn - zero)
            if joint.zero != ZERO:
                value = Angle(sympy.sin(value), sympy.cos(value))
        held = plus(stand.origin, times(stand.rotation, tape.vector("swung", swung)))
        end = [expression(entry, self._parameters) for entry in self._linkage.foot[1]]
        point = (tape.let("held_x", end[0] + held[0]), tape.let("held_y", end[1] + held[1]))
        return Plane((), (seen[0], seen[1]), margin=margin, after=(tape.let("hung", value),), held=point)

    def _crossing(self, name: str, factors: Exprs, sign: sympy.Expr) -> tuple[sympy.Expr, sympy.Expr, Planar]:
        """Where A cos t + B sin t = C: A^2 + B^2, that less C^2 (negative where there is no t), cosine and sine of t."""
        (a, b, c), tape = factors, self._tape
        size = tape.let(f"{name}_size", a**2 + b**2)
        inside = tape.let(f"{name}_inside", size - c**2)
        root = tape.let(f"{name}_root", sign * sympy.sqrt(Select(less(inside, 0), 0, inside)))
        return size, inside, (tape.let(f"{name}_cos", (a * c - b * root) / size), tape.let(f"{name}_sin", (b * c + a * root) / size))

    def _frame(self, *poses: Transform) -> Frame:
        """Constant poses one after another."""
        frame = Frame()
        for pose in poses:
            frame = frame * frame_of(pose, self._parameters)
        return frame

    def _local(self, frame: Frame, point: Vec) -> Vec:
        offset = minus(point, frame.origin)
        x, y, z = (dot(column, offset) for column in frame.rotation)
        return (x, y, z)

    def _turned(self, hung: Frame, w: Vec, sign: sympy.Expr) -> Plane:
        """The joint turns the plane, `hung` on it, onto the target: A cos t + B sin t = C."""
        (nx, ny, nz), tape, joint = hung.rotation[2], self._tape, self._leg.serial[0]
        a, b = tape.let("plane_a", nx * w[0] + ny * w[1]), tape.let("plane_b", nx * w[1] - ny * w[0])
        c = tape.let("plane_c", dot((nx, ny, nz), hung.origin) - nz * w[2])
        size, inside, (cosine, sine) = self._crossing("plane", (a, b, c), sign)
        free = less(size, sympy.Rational(1, 10**24))
        angle = Select(free, 0, Angle(sine, cosine))
        turn = tape.let("plane_turn", angle)
        cos, sin = tape.let("plane_cosine", sympy.cos(turn)), tape.let("plane_sine", sympy.sin(turn))
        back = (cos * w[0] + sin * w[1], cos * w[1] - sin * w[0], w[2])
        x, y, _ = self._local(hung, tape.vector("turned_back", back))
        value = joint.sign * (turn - expression(joint.zero, self._parameters))
        if joint.zero != ZERO:
            value = Angle(sympy.sin(value), sympy.cos(value))
        beside = tape.let("plane_beside", Select(free, c**2, 0))
        margin = tape.let("plane_margin", Select(free, 1, inside / tape.let("plane_divisor", Select(free, 1, size))))
        return Plane((tape.let("turn", value),), (tape.let("target_x", x), tape.let("target_y", y)), beside, margin, free)

    def _row(
        self, plane: Plane, signs: dict[str, sympy.Expr], second: sympy.Basic, arrival: Arrival | None = None
    ) -> tuple[list[sympy.Expr], sympy.Expr]:
        tape, order = self._tape, self._linkage.inverse
        root = lambda square: sympy.sqrt(Select(less(square, 0), 0, square))  # noqa: E731 - a formula
        target, unknowns = (arrival.target, arrival.unknowns) if arrival else (plane.target, ())
        placing = Placing(self._linkage, order, tape, {}, {}, signs, self._parameters, target, root, unknowns, plane.held)
        bars = sorted(self._linkage.structure.bars)
        drives = [placing.measured(pair) for pair in self._linkage.driven] + [self._length(placing, bar) for bar in bars]
        values = [tape.let("drive", value + self._taint) for value in (*plane.q, *drives, *plane.after)]
        return values, self._status(plane, placing, signs, second, arrival)

    def _length(self, placing: Placing, bar: int) -> sympy.Expr:
        first, second = (placing.joint(index) for index, pair in enumerate(self._linkage.structure.pairs) if bar in pair.bodies)
        return sympy.sqrt(square(difference(second, first)))

    def _status(
        self, plane: Plane, placing: Placing, signs: dict[str, sympy.Expr], second: sympy.Basic, arrival: Arrival | None
    ) -> sympy.Expr:
        """The worst of what can be said."""
        status: sympy.Expr = OK
        for group in self._linkage.forward.dyads:
            if SIDES[group.kind]:
                status = Select(less(self._side(group, placing) * self._linkage.side(group), 0), INFEASIBLE, status)
        for margin in placing.margins:
            if not SIDES[margin.group.kind]:
                status = Select(less(margin.value, _TOLERANCE**2), SINGULAR, status)
            else:
                repeated = both(less(signs[margin.group.name], 0), less(margin.value, _TOLERANCE**2))
                status = Select(repeated, DUPLICATE, status)
        status = Select(both(second, less(plane.margin, _TOLERANCE**2)), DUPLICATE, status)
        status = Select(plane.free, chosen(second, DUPLICATE, SINGULAR), status)
        for value in (plane.margin, *(margin.value for margin in placing.margins)):
            status = Select(less(value, -_TOLERANCE), UNREACHABLE, status)
        status = Select(less(_TOLERANCE**2, plane.beside), UNREACHABLE, status)
        if arrival:
            short = Select(Same(arrival.state, NO_CONVERGENCE), NO_CONVERGENCE, UNREACHABLE)
            status = Select(Same(arrival.state, OK), status, short)
        return Select(Finite(self._taint), status, BAD_INPUT)

    def _side(self, group: Group, placing: Placing) -> sympy.Expr:
        """Positive where the group is on its first side."""
        if group.kind == "RRR":
            p, q, pin = (placing.joint(pair) for pair in group.pairs)
            return self._tape.let(f"{group.name}_side", outer(difference(q, p), difference(pin, p)))
        return self._tape.let(f"{group.name}_side", placing.ahead(group))
