"""The inverse of a leg whose linkage has one drive: its foot moves on a curve, which the joint before the linkage carries along.

Where that joint puts the foot nearest to a target does not depend on the drive's neighbours: what is left is the distance of two curves'
points in the half plane of radius and height (a turning joint), across the joint (a sliding one), or in space (none), a function of the
drive alone.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property

import sympy

from walkgen.model.classify import InverseClass, inverse_class
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.spec.scalar import ZERO
from walkgen.symbolic.branches import SINGULAR
from walkgen.symbolic.choices import less
from walkgen.symbolic.closure import forward_placing
from walkgen.symbolic.frames import Frame, expression, frame_of, parameter_symbols
from walkgen.symbolic.function import Angle, Both, Function, Same, Select, Solve, Step
from walkgen.symbolic.planar_motion import Coordinate, PlanarMotion
from walkgen.symbolic.ports import DRIVE, joint_port, joint_unit, signature
from walkgen.symbolic.rows import TARGET, parameters_of
from walkgen.symbolic.screws import limits_of
from walkgen.symbolic.selection import by_index, nearest
from walkgen.symbolic.starts import found_start
from walkgen.symbolic.tape import Tape, Vec, dot, minus, plus, scaled, symbols_of

Exprs = Sequence[sympy.Expr]
_STATUS = Port("status", kind="integer")
_AIM, _BOUNDS = Port("aim", (3,), "m"), Port("bounds", (2,))
_PROFILE = Port("profile", (6,))
_SOURCE = "the least distances of a coupler curve from a point"
_SEAM = sympy.Rational(1, 7)
"""Where the turn of a turning drive begins beyond -pi: linkages are often special where cranks and ground are in line."""
_ON_AXIS = sympy.Rational(1, 10**24)
_ZERO = sympy.S.Zero


def curve_inverse(mechanism: Mechanism, leg: Limb) -> Iterator[Solve]:
    """`inverse`, `inverse_branch`, `inverse_near` and `inverse_distance`."""
    assert leg.linkage is not None
    curve = CurveInverse(mechanism, leg, leg.linkage)
    yield from (curve.inverse(), curve.inverse_branch(), curve.inverse_near(), curve.inverse_distance())


class CurveInverse:
    """The rows of one leg, and what is chosen among them."""

    def __init__(self, mechanism: Mechanism, leg: Limb, linkage: Linkage) -> None:
        self._mechanism, self._leg, self._linkage = mechanism, leg, linkage
        self._parameters = parameter_symbols(mechanism)
        self._joint = leg.serial[0] if leg.serial else None
        found: InverseClass = inverse_class(mechanism, leg)
        self._slots = len(found.branch_names)

    # ---- functions

    def inverse(self) -> Solve:
        """All rows."""
        doc = (
            "All joint values that reach p, a row a value of the drive, in order of the drive; rows beyond the last are UNREACHABLE and "
            "hold the first again, or the joint values of all that come closest."
        )
        words = signature(self._mechanism, self._leg.name, "inverse", [TARGET], self._results("q", "status"), doc, _SOURCE)
        return Solve(words, self._locals, self._steps("q", "status"), callbacks=(self._curve,))

    def inverse_branch(self) -> Solve:
        """One row by its number."""
        port = Port("branch", kind="integer")
        return self._one("inverse_branch", port, by_index, "The joint values of one branch that reach p.")

    def inverse_near(self) -> Solve:
        """The row nearest to a seed."""
        port = joint_port("q_seed", self._leg.joints)
        doc = "The joint values that reach p and are nearest to q_seed (sum of squares, turns taken off); no branch has to be chosen."
        return self._one("inverse_near", port, nearest, doc)

    def inverse_distance(self) -> Solve:
        """Of every row from the target."""
        output = Port("distance", (self._slots,), "m")
        doc = "Distance from p of the foot at every branch of inverse: 0 but for rounding where it reaches, NaN for a bad input."
        words = signature(self._mechanism, self._leg.name, "inverse_distance", [TARGET], [output], doc, "as inverse")
        last = Step(self._distances(output), (*self._named_feet, "p", *parameters_of(self._mechanism), "distance"))
        rows = (*self._locals, *self._results("rows", "row_states"))
        return Solve(words, rows, (*self._steps("rows", "row_states"), last), callbacks=(self._curve,))

    def _one(self, name: str, port: Port, choose: Callable[[Mechanism, Limb, int], Function], doc: str) -> Solve:
        outputs = [joint_port("q", self._leg.joints), _STATUS]
        words = signature(self._mechanism, self._leg.name, name, [TARGET, port], outputs, doc, _SOURCE)
        last = Step(choose(self._mechanism, self._leg, self._slots), ("rows", "row_states", port.name, "q", "status"))
        rows = (*self._locals, *self._results("rows", "row_states"))
        return Solve(words, rows, (*self._steps("rows", "row_states"), last), callbacks=(self._curve,))

    # ---- steps

    def _results(self, rows: str, states: str) -> tuple[Port, Port]:
        return (
            Port(rows, (self._slots, len(self._leg.joints)), joint_unit(self._leg.joints)),
            Port(states, (self._slots,), kind="integer"),
        )

    @property
    def _locals(self) -> tuple[Port, ...]:
        found = (_AIM, _BOUNDS, Port("drives", (self._slots,)), Port("states", (self._slots,), kind="integer"))
        return (*found, *self._singled, *self._feet)

    @cached_property
    def _singled(self) -> tuple[Port, ...]:
        """The drive of every row."""
        return tuple(Port(f"drive_{number}", (1,)) for number in range(1, self._slots + 1))

    @cached_property
    def _feet(self) -> tuple[Port, ...]:
        """The foot of every row, in the linkage's plane."""
        return tuple(Port(f"foot_{number}", (2,), "m") for number in range(1, self._slots + 1))

    def _steps(self, rows: str, states: str) -> tuple[Step, ...]:
        given = parameters_of(self._mechanism)
        turning = int(self._leg.joints[-1].kind == "revolute")
        return (
            Step(self._aim, ("p", *given, "aim", "bounds")),
            Step("wg_curve_roots", ("bounds", "aim", self._curve.signature.full_name, turning, "drives", "states")),
            *self._foot_steps(),
            Step(self._rows, ("drives", "states", *self._named_feet, "p", *given, rows, states)),
        )

    @property
    def _named_feet(self) -> tuple[str, ...]:
        return tuple(port.name for port in self._feet)

    def _foot_steps(self) -> Iterator[Step]:
        """Every row's foot, one after another."""
        drives, tape = Port("drives", (self._slots,)), Tape()
        words = Signature(self._mechanism.name, self._leg.name, "curve_drives", (drives,), self._singled, "", "")
        yield Step(tape.function(words, symbols_of(drives)), ("drives", *(port.name for port in self._singled)))
        for drive, foot in zip(self._singled, self._feet, strict=True):
            yield Step(self._foot, (drive.name, *parameters_of(self._mechanism), foot.name))

    @cached_property
    def _foot(self) -> Function:
        """The foot in the linkage's plane."""
        tape, (drive,) = Tape(), symbols_of(DRIVE)
        words = signature(self._mechanism, self._leg.name, "curve_foot", [DRIVE], [Port("foot", (2,), "m")], "", "")
        return tape.function(words, self._planar(drive, tape))

    @cached_property
    def _curve(self) -> Solve:
        """Of the drive, as the routine calls it."""
        words = signature(self._mechanism, self._leg.name, "curve", [DRIVE], [_PROFILE], "", "")
        step = Step(self._profile, ("drive", *parameters_of(self._mechanism), "profile"))
        return Solve(words, (), (step,))

    @cached_property
    def _profile(self) -> Function:
        """The foot where the joint before the linkage does not count, and its slopes by the drive."""
        tape, (drive,) = Tape(), symbols_of(DRIVE)
        at = self._planar(drive, tape)
        motion = PlanarMotion(tape, [drive], [Coordinate("foot_x", at[0]), Coordinate("foot_y", at[1])])
        foot, axes = tape.vector("foot", self._hung(at)), self._hinge[1].rotation
        (along_x,), (along_y,) = motion.slopes
        speed = tape.vector("speed", plus(scaled(along_x, axes[0]), scaled(along_y, axes[1])))
        words = signature(self._mechanism, self._leg.name, "curve_profile", [DRIVE], [_PROFILE], "", "")
        return tape.function(words, [*self._seen(foot, tape), *self._speed(foot, speed, tape)])

    @cached_property
    def _aim(self) -> Function:
        """The target likewise, and between which drives to look."""
        tape = Tape()
        aim = self._seen(self._target(tape), tape)
        words = signature(self._mechanism, self._leg.name, "curve_aim", [TARGET], [_AIM, _BOUNDS], "", "")
        return tape.function(words, [*aim, *self._bounds()])

    @cached_property
    def _rows(self) -> Function:
        """Joint values of the drives found: the joint turned or slid as near to the target as it comes."""
        drives, states = Port("drives", (self._slots,)), Port("states", (self._slots,), kind="integer")
        tape = Tape()
        target = self._target(tape)
        rows: list[sympy.Expr] = []
        statuses = []
        for drive, state, foot in zip(symbols_of(drives), symbols_of(states), self._feet, strict=True):
            values, free = self._carried(symbols_of(foot), target, tape)
            rows += [*values, drive]
            statuses.append(Select(Both(free, Same(state, 0)), SINGULAR, state) if free != sympy.false else state)
        given = [drives, states, *self._feet, TARGET]
        words = signature(self._mechanism, self._leg.name, "curve_rows", given, self._results("q", "status"), "", "")
        return tape.function(words, [*rows, *statuses])

    def _distances(self, output: Port) -> Function:
        """Of every row's foot from the target, where the joint before the linkage does not count: it brings them as near as it can."""
        tape = Tape()
        aim = self._seen(self._target(tape), tape)
        gaps = [minus(self._seen(self._hung(symbols_of(foot)), tape), aim) for foot in self._feet]
        words = signature(self._mechanism, self._leg.name, "curve_distances", [*self._feet, TARGET], [output], "", "")
        return tape.function(words, [sympy.sqrt(dot(gap, gap)) for gap in gaps])

    # ---- geometry

    def _planar(self, drive: sympy.Expr, tape: Tape) -> tuple[sympy.Expr, sympy.Expr]:
        """The foot in the linkage's plane."""
        placing = forward_placing(self._leg, [drive], self._parameters, tape)
        x, y = placing.point(self._linkage.foot[0], placing.planar(self._linkage.foot[1]))
        return tape.let("foot_x", x), tape.let("foot_y", y)

    @cached_property
    def _hinge(self) -> tuple[Frame, Frame]:
        """Where the joint is, its z axis the joint's, and the plane seen from there with the joint at rest."""
        mount, plane = frame_of(self._leg.mount, self._parameters), frame_of(self._leg.tip, self._parameters)
        if self._joint is None:
            return mount, plane
        return mount * frame_of(self._joint.before, self._parameters), frame_of(self._joint.after, self._parameters) * plane

    def _hung(self, at: Exprs) -> Vec:
        plane = self._hinge[1]
        return plus(plane.origin, plus(scaled(at[0], plane.rotation[0]), scaled(at[1], plane.rotation[1])))

    def _target(self, tape: Tape) -> Vec:
        """From the joint."""
        x, y, z = symbols_of(TARGET)
        base = self._hinge[0]
        away = minus((x, y, z), base.origin)
        u, v, w = (dot(column, away) for column in base.rotation)
        return tape.vector("target", (u, v, w))

    def _seen(self, point: Vec, tape: Tape) -> Vec:
        """What the joint cannot change of a point."""
        x, y, z = point
        if self._joint is None:
            return point
        if self._joint.kind == "prismatic":
            return (x, y, _ZERO)
        return (tape.let("radius", sympy.sqrt(x**2 + y**2)), z, _ZERO)

    def _speed(self, point: Vec, speed: Vec, tape: Tape) -> Exprs:
        if self._joint is None:
            return speed
        if self._joint.kind == "prismatic":
            return (speed[0], speed[1], _ZERO)
        radius = tape.let("radius", sympy.sqrt(point[0] ** 2 + point[1] ** 2))
        outwards = tape.let("outwards", (point[0] * speed[0] + point[1] * speed[1]) / radius)
        return (Select(less(_ZERO, radius), outwards, tape.let("out", sympy.sqrt(speed[0] ** 2 + speed[1] ** 2))), speed[2], _ZERO)

    def _bounds(self) -> Exprs:
        """A turn, about the start of triads, or the limits and half of their width beyond them."""
        drive = self._leg.joints[-1]
        if drive.kind == "revolute":
            held = self._linkage.forward.triads
            seam = sympy.Rational(str(found_start(self._mechanism, self._leg).drives[0])) if held else _SEAM
            return (seam - sympy.pi, seam + sympy.pi)
        low, high = limits_of(drive, self._parameters)
        least, most = (3 * low - high) / 2, (3 * high - low) / 2
        return (Select(less(least, 0), 0, least) if self._linkage.structure.bars else least, most)

    def _carried(self, at: Exprs, target: Vec, tape: Tape) -> tuple[Exprs, sympy.Basic]:
        """The joint's value, none without a joint, and whether any value will do."""
        joint = self._joint
        if joint is None:
            return (), sympy.false
        zero, foot = expression(joint.zero, self._parameters), tape.vector("foot", self._hung(at))
        if joint.kind == "prismatic":
            return (tape.let("slide", joint.sign * (target[2] - foot[2] - zero)),), sympy.false
        sine = tape.let("turn_sine", foot[0] * target[1] - foot[1] * target[0])
        cosine = tape.let("turn_cosine", foot[0] * target[0] + foot[1] * target[1])
        size = tape.let("turn_size", target[0] ** 2 + target[1] ** 2)
        free = less(size, _ON_AXIS)
        turn = tape.let("turn", joint.sign * (tape.let("turned", Select(free, 0, Angle(sine, cosine))) - zero))
        if joint.zero != ZERO:
            turn = tape.let("turn_wrapped", Angle(sympy.sin(turn), sympy.cos(turn)))
        return (turn,), free
