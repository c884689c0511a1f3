"""Forces of a leg that stands on a curved sole: nine equations of motion for twelve unknowns, and the three that close them (theory 8.4).

All unknowns are affine in three of them, the force on the hip and the moment of the ground's normal force about the ankle, so that closing
is a system of three equations, which sympy's zeros and ones make smaller still.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import sympy

from walkgen.signature import Port
from walkgen.symbolic.affine import FREE, Affine
from walkgen.symbolic.branches import INFEASIBLE, SINGULAR
from walkgen.symbolic.choices import at_most
from walkgen.symbolic.function import Function, LessEqual, Select
from walkgen.symbolic.rolling_leg import LinkMass, Planar
from walkgen.symbolic.settled import Case, settled
from walkgen.symbolic.sole_ports import HIP_MOTION, MOTION, PLANE, STATUS, Exprs, SoleLeg, cross, named
from walkgen.symbolic.tape import Tape, symbols_of

_UNKNOWNS = 12
_RANK = sympy.Rational(1, 10**9)
_LOAD = Port("load", (2,), "N")
_CENTRE = Port("centre", (), "m")
_MU = Port("mu")
_SIDE = Port("side", kind="integer", default=(1.0,))
_CLOSING = Port("closing", (FREE, _UNKNOWNS + 1))
_OUTPUTS = (
    Port("torque", (3,), "N m"),
    Port("hip_force", (2,), "N"),
    Port("knee_force", (2,), "N"),
    Port("ankle_force", (2,), "N"),
    Port("ground_force", (2,), "N"),
    Port("pressure_centre", (), "m"),
    Port("margins", (3,), "N, N and m"),
    STATUS,
)
_DOC = (
    "{what} of a leg that stands on its sole, "
    + PLANE
    + ", by the motions of its hip and its links. torque: of hip, knee and ankle, on the "
    "link after the joint; forces: of the body on the thigh, thigh on shank, foot on shank, ground on foot; pressure_centre: ahead of the "
    "ankle. margins: the normal force; mu times it less the tangential one; how far the pressure is inside the flat part. SINGULAR: "
    "{dead}; INFEASIBLE: the ground would have to pull."
)
_STRAIGHT = "thigh and shank are in line"


@dataclass(frozen=True)
class Balance:
    """All twelve unknowns of the system, and what it is closed by."""

    hip: tuple[Affine, Affine]
    knee: tuple[Affine, Affine]
    ankle: tuple[Affine, Affine]
    ground: tuple[Affine, Affine]
    moment: Affine
    torque: tuple[Affine, Affine, Affine]

    @property
    def unknowns(self) -> tuple[Affine, ...]:
        """R01, R12, R32, N, T, m_N, M01, M12, M23."""
        return (*self.hip, *self.knee, *self.ankle, self.ground[1], self.ground[0], self.moment, *self.torque)


Closing = Callable[[Balance, Mapping[str, Exprs]], Sequence[Affine]]
"""Three that are 0, by the inputs' symbols."""


@dataclass(frozen=True)
class Mode:
    """How the system is closed: further inputs, equations, words."""

    inputs: tuple[Port, ...]
    closing: Closing
    what: str
    dead: str
    source: str


def _pressed(balance: Balance, given: Mapping[str, Exprs]) -> Affine:
    """m_N - d N."""
    return balance.moment - balance.ground[1].scaled(given["centre"][0])


def _loaded(balance: Balance, given: Mapping[str, Exprs]) -> tuple[Affine, Affine]:
    """R01 less the load."""
    x, y = (force - Affine(value) for force, value in zip(balance.hip, given["load"], strict=True))
    return x, y


def _general(balance: Balance, given: Mapping[str, Exprs]) -> list[Affine]:
    """Rows a of a z = b."""
    entries, width = given["closing"], _UNKNOWNS + 1
    rows = [entries[width * row : width * row + width] for row in range(FREE)]
    found = []
    for row in rows:
        total = Affine(-row[-1])
        for factor, unknown in zip(row[:-1], balance.unknowns, strict=True):
            total += unknown.scaled(factor)
        found.append(total)
    return found


MODES: dict[str, Mode] = {
    "stance_forces": Mode(
        (_CLOSING,),
        _general,
        "Forces and torques, closed by the three rows (a, b) of a z = b in z = (R01x, R01y, R12x, R12y, R32x, R32y, N, T, m_N, M01, M12, "
        "M23),",
        "the rows say one thing twice, or none",
        "theory 8.4: a 9x12 system and three closing rows",
    ),
    "stance_forces_passive": Mode(
        (),
        lambda balance, _: balance.torque,
        "Forces without torques in the joints",
        _STRAIGHT,
        "eq. (27), errata 8.9 to 8.11",
    ),
    "stance_forces_pressure": Mode(
        (_CENTRE,),
        lambda balance, given: (_pressed(balance, given), *balance.torque[1:]),
        "Forces with a torque of the hip alone that brings the centre of pressure to `centre` ahead of the ankle,",
        "shank and ground force are in line whatever it is",
        "eq. (28), erratum 8.13",
    ),
    "stance_forces_load": Mode(
        (_LOAD, _CENTRE),
        lambda balance, given: (*_loaded(balance, given), _pressed(balance, given)),
        "Torques that carry a `load` of the body on the hip, flat with a centre of pressure or rolling with its contact point at `centre` "
        "ahead of the ankle,",
        "never",
        "theory 8.4, load mode; erratum 8.12",
    ),
    "stance_forces_ankle": Mode(
        (_LOAD,),
        lambda balance, given: (*_loaded(balance, given), balance.torque[2]),
        "Torques of hip and knee that carry a `load` of the body on the hip, and the centre of pressure of a free ankle,",
        "never",
        "theory 8.4, load mode with M23 = 0",
    ),
    "stance_forces_rolling": Mode(
        (_CENTRE,),
        lambda balance, given: (_pressed(balance, given), *balance.torque[:2]),
        "Forces with a torque of the ankle alone, rolling with the contact point at `centre` ahead of the ankle,",
        _STRAIGHT + ", or hip and knee in line with the contact point",
        "eqs. (29), (30), errata 8.10, 8.14",
    ),
    "stance_forces_sliding": Mode(
        (_SIDE,),
        lambda balance, given: (balance.ground[0] - balance.ground[1].scaled(given["side"][0] * given["mu"][0]), *balance.torque[1:]),
        "Forces with a torque of the hip alone at the limit of friction, the ground's tangential force forward (side 1) or backward (-1),",
        "the shank is along the friction cone",
        "theory 8.4, friction limit; erratum 8.17",
    ),
}
"""Functions of a leg with a curved sole."""


class StanceForces:
    """Functions of one leg."""

    def __init__(self, own: SoleLeg) -> None:
        self._own = own

    def functions(self) -> dict[str, Callable[[], Function]]:
        """By name."""
        return {name: lambda name=name: self.function(name) for name in MODES}  # type: ignore[misc]

    def function(self, name: str) -> Function:
        """One of `MODES`."""
        mode, tape = MODES[name], Tape()
        inputs = (HIP_MOTION, MOTION, *sorted((*mode.inputs, _MU), key=lambda port: bool(port.default)))
        given = {port.name: symbols_of(port) for port in inputs}
        found, dead = self.values(tape, name, given)
        cases: list[Case] = [*dead, (LessEqual(found[10], 0), INFEASIBLE)]
        values = [symbol for port in inputs for symbol in symbols_of(port)]
        doc = _DOC.format(what=mode.what, dead=mode.dead)
        return self._own.function(tape, name, inputs, _OUTPUTS, settled(tape, values, cases, found, INFEASIBLE), doc, mode.source)

    def values(self, tape: Tape, name: str, given: Mapping[str, Exprs]) -> tuple[list[sympy.Expr], list[Case]]:
        """All outputs of a mode but the status, and where there are none, for its inputs by their names."""
        balance = self._balance(tape, given["hip"], given["angles"])
        free, dead = _closed(tape, [row.named(tape, "row") for row in MODES[name].closing(balance, given)])
        return self._outputs(tape, balance, free, given["mu"][0]), dead

    def _outputs(self, tape: Tape, balance: Balance, free: Exprs, mu: sympy.Expr) -> list[sympy.Expr]:
        def value(name: str, affine: Affine) -> sympy.Expr:
            return tape.let(name, affine.at(free))

        torque = [value("torque", entry) for entry in balance.torque]
        forces = [value("force", entry) for pair in (balance.hip, balance.knee, balance.ankle) for entry in pair]
        tangential, normal = (value(name, entry) for name, entry in zip(("tangential", "normal"), balance.ground, strict=True))
        centre = tape.let("pressure", value("moment", balance.moment) / normal)
        ahead, behind = tape.let("ahead", self._own.edge("toe") - centre), tape.let("behind", centre - self._own.edge("heel"))
        inside = Select(LessEqual(ahead, behind), ahead, behind)
        return [*torque, *forces, tangential, normal, centre, normal, mu * normal - abs(tangential), inside]

    # ---- the nine equations

    def _balance(self, tape: Tape, hip: Exprs, angles: Exprs) -> Balance:
        leg = self._own.leg
        joint, acceleration = (hip[0], hip[1]), (hip[4], hip[5])
        loads, moments, levers, places = list[Planar](), list[sympy.Expr](), list[Planar](), [joint]
        for number, (mass, length) in enumerate(zip(leg.masses, (leg.thigh, leg.shank, None), strict=True)):
            spin = _Spin.of(tape, angles[number], angles[3 + number], angles[6 + number])
            weight, lever = self._weight(tape, mass, spin, acceleration)
            loads.append(weight)
            levers.append(lever)
            moments.append(mass.inertia * angles[6 + number])
            if length is not None:
                reach = named(tape, "reach", (length * spin.cosine, length * spin.sine))
                joint = named(tape, "joint", (joint[0] + reach[0], joint[1] + reach[1]))
                acceleration = named(tape, "joint_acceleration", spin.carried(reach, acceleration))
                places.append(joint)
        return _assembled(tape, loads, moments, levers, places)

    def _weight(self, tape: Tape, mass: LinkMass, spin: "_Spin", acceleration: Planar) -> tuple[Planar, Planar]:
        """W = m (G'' + (0, g)) on level ground, and where G is from the link's joint."""
        (x, y), (c, s), own = mass.com, (spin.cosine, spin.sine), self._own.leg.weight
        lever = named(tape, "lever", (c * x - s * y, s * x + c * y))
        moved = spin.carried(lever, acceleration)
        return named(tape, "load", (mass.mass * (moved[0] + own[0]), mass.mass * (moved[1] + own[1]))), lever


@dataclass(frozen=True)
class _Spin:
    """How a link turns: cos and sin of its angle, square of its rate, its angular acceleration."""

    cosine: sympy.Expr
    sine: sympy.Expr
    square: sympy.Expr
    acceleration: sympy.Expr

    @classmethod
    def of(cls, tape: Tape, angle: sympy.Expr, rate: sympy.Expr, acceleration: sympy.Expr) -> "_Spin":
        """By its angle and derivatives."""
        return cls(tape.let("cos", sympy.cos(angle)), tape.let("sin", sympy.sin(angle)), tape.let("rate2", rate**2), acceleration)

    def carried(self, lever: Planar, base: Planar) -> Planar:
        """The acceleration of a point at a lever."""
        x, y = lever
        return base[0] - self.acceleration * y - self.square * x, base[1] + self.acceleration * x - self.square * y


def _assembled(tape: Tape, loads: Sequence[Planar], moments: Exprs, levers: Sequence[Planar], places: Sequence[Planar]) -> Balance:
    """The equations of theory 8.4, solved for all but three unknowns: link by link from the hip, then back from the ground."""
    one, nil = sympy.S.One, sympy.S.Zero
    hip = (Affine(nil, (one, nil, nil)), Affine(nil, (nil, one, nil)))
    moment = Affine(nil, (nil, nil, one))
    (first, second, third), (a, b, c) = loads, places
    knee = tuple(force - Affine(load) for force, load in zip(hip, first, strict=True))
    ankle = tuple((Affine(load) - force).named(tape, "ankle") for force, load in zip(knee, second, strict=True))
    ground = tuple((force + Affine(load)).named(tape, "ground") for force, load in zip(ankle, third, strict=True))
    thigh, shank = (a[0] - b[0], a[1] - b[1]), named(tape, "shank", (c[0] - b[0], c[1] - b[1]))
    centre = (levers[0][0] + thigh[0], levers[0][1] + thigh[1])
    turned = [
        tape.let("turned", moments[0] + cross(centre, first)),
        tape.let("turned", moments[1] + cross(levers[1], second)),
        tape.let("turned", moments[2] + cross(levers[2], third)),
    ]
    third_torque = (Affine(turned[2]) - moment - ground[0].scaled(c[1])).named(tape, "ankle_torque")
    about_knee = ankle[1].scaled(shank[0]) - ankle[0].scaled(shank[1])
    second_torque = (Affine(turned[1]) + third_torque - about_knee).named(tape, "knee_torque")
    about_hip = hip[1].scaled(thigh[0]) - hip[0].scaled(thigh[1])
    first_torque = (Affine(turned[0]) + second_torque - about_hip).named(tape, "hip_torque")
    pairs = [(pair[0], pair[1]) for pair in (knee, ankle, ground)]
    return Balance(hip, pairs[0], pairs[1], pairs[2], moment, (first_torque, second_torque, third_torque))


def _closed(tape: Tape, rows: Sequence[Affine]) -> tuple[list[sympy.Expr], list[Case]]:
    """The free unknowns by Cramer's rule, and where there are none: next to no determinant beside the rows' sizes."""
    matrix = [row.factors for row in rows]
    right = [-row.constant for row in rows]
    others = ((1, 2), (2, 0), (0, 1))
    minors = [[tape.let("minor", matrix[i][k] * matrix[j][m] - matrix[i][m] * matrix[j][k]) for k, m in others] for i, j in others]
    determinant = tape.let("determinant", sympy.Add(*(matrix[0][k] * minors[0][k] for k in range(FREE))))
    free = [tape.let("free", sympy.Add(*(right[i] * minors[i][k] for i in range(FREE))) / determinant) for k in range(FREE)]
    if determinant.is_number:
        return free, []
    size = sympy.Mul(*(tape.let("row_size", sympy.Add(*(abs(entry) for entry in row))) for row in matrix))
    return free, [(at_most(abs(determinant), _RANK * size), SINGULAR)]
