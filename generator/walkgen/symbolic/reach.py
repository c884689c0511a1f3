"""The inverse by iteration from a seed: a foot position or a full pose, for arms and routes whose joints are more than three."""

from collections.abc import Sequence
from dataclasses import replace

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.signature import STATUSES, Port, Signature
from walkgen.symbolic.driven import kinematics_of
from walkgen.symbolic.forward import Route
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Finite, Function, Less, Residue, Select, Solve, Step
from walkgen.symbolic.linear import solve_symmetric
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.rows import TARGET, parameters_of
from walkgen.symbolic.screws import geometry_port, geometry_step, limits_port, limits_step, sequence_of
from walkgen.symbolic.tape import Tape, Vec, cross, dot, minus, plus, scaled, symbols_of

_STATUS = Port("status", kind="integer")
_POSE = Port("T", (4, 4), "1 and m")
_OK, _BAD_INPUT, _NO_CONVERGENCE = (sympy.Integer(STATUSES.index(name)) for name in ("OK", "BAD_INPUT", "NO_CONVERGENCE"))
_STEPS = 24
_CLOSE2 = sympy.Rational(1, 10**18)
_STEPPED = "Levenberg-Marquardt with the exact Jacobian (Sugihara 2011)"
_SOURCE = "Levenberg-Marquardt with the exact Jacobian (Sugihara 2011), from several starts"


def inverse_reach(mechanism: Mechanism, route: Route) -> Solve:
    """A configuration near the seed that brings the foot to p."""
    doc = "Joint values near q_seed that bring the foot to p, within the limits if possible; the best found where nothing does."
    return _solve(mechanism, route, "inverse_near", TARGET, "wg_inverse_reach", doc)


def inverse_pose(mechanism: Mechanism, route: Route) -> Solve:
    """A configuration near the seed that brings the foot frame to the pose T."""
    doc = (
        "Joint values near q_seed that bring the foot frame to T, within the limits where that is possible; the best found where it is not."
    )
    return _solve(mechanism, route, "inverse_pose", _POSE, "wg_inverse_pose", doc)


def inverse_pose_driven(mechanism: Mechanism, route: Route) -> Solve:
    """`inverse_pose` of a route to the foot of a linkage, whose joints' axes do not tell where it goes: from the seed alone."""
    seed, q = joint_port("q_seed", route.joints), joint_port("q", route.joints)
    doc = (
        f"Joint values near q_seed that bring the foot frame to T, by {_STEPS + 1} damped steps from the seed alone, whatever the limits: "
        "NO_CONVERGENCE where they do not get there, with NaN where the linkage stops assembling on the way."
    )
    words = signature(mechanism, route.owner, "inverse_pose", [_POSE, seed], [q, _STATUS], doc, _STEPPED)
    found = iterated(mechanism, route, _POSE, words)
    return replace(found, closed_form=found)


def _solve(mechanism: Mechanism, route: Route, name: str, target: Port, routine: str, doc: str) -> Solve:
    joints = route.joints
    seed, q = joint_port("q_seed", joints), joint_port("q", joints)
    words = signature(mechanism, route.owner, name, [target, seed], [q, _STATUS], doc, _SOURCE)
    posed = target is _POSE
    steps = (
        geometry_step(mechanism, route, posed=posed),
        limits_step(mechanism, route.owner, joints),
        Step(routine, ("geometry", target.name, "q_seed", "limits", sequence_of(joints), "q", "status")),
    )
    locals_ = (geometry_port(joints, posed=posed), limits_port(joints))
    return Solve(words, locals_, steps, iterated(mechanism, route, target, words))


def iterated(mechanism: Mechanism, route: Route, target: Port, words: Signature) -> Solve:
    """The same from the seed by a fixed number of steps, for targets without routines."""
    iterate = _Iterate(mechanism, route, target)
    given = (target.name, *parameters_of(mechanism))
    closed = (
        Step(iterate.step(), ("q_seed", *given, "q")),
        Step(iterate.step(), ("q", *given, "q"), repeat=_STEPS),
        Step(iterate.verdict(), ("q", "q_seed", *given, "status")),
    )
    return Solve(words, (), closed)


class _Iterate:
    """One damped Gauss-Newton step, for targets without routines.

    The damping goes with the squared error, so that the last steps are Newton's: then the derivative of the result by the
    target is that of the implicit function, whatever the steps before were.
    """

    def __init__(self, mechanism: Mechanism, route: Route, target: Port) -> None:
        self._mechanism, self._route, self._target = mechanism, route, target
        self._q = joint_port("q", route.joints)
        self._tape = Tape()
        self._kinematics = kinematics_of(route.limbs, symbols_of(self._q), parameter_symbols(mechanism), self._tape)
        self._error = self._missing()

    def _missing(self) -> list[sympy.Expr]:
        """Target minus foot; for a pose the rotation that is missing follows: half the sum of the axes' cross products."""
        wanted = symbols_of(self._target)
        if self._target is TARGET:
            return [*self._tape.vector("error", minus(_vector(wanted), self._kinematics.position))]
        columns = [_vector(wanted[column:12:4]) for column in range(4)]
        turn = [cross(mine, theirs) for mine, theirs in zip(self._kinematics.rotation, columns[:3], strict=True)]
        rotation = scaled(sympy.Rational(1, 2), plus(plus(turn[0], turn[1]), turn[2]))
        shift = minus(columns[3], self._kinematics.position)
        return [*self._tape.vector("error", shift), *self._tape.vector("turn", rotation)]

    @property
    def _rows(self) -> list[list[sympy.Expr]]:
        """Of the Jacobian."""
        linear, angular = self._kinematics.jacobian, self._kinematics.angular
        rows = [[column[row] for column in linear] for row in range(3)]
        return rows if self._target is TARGET else rows + [[column[row] for column in angular] for row in range(3)]

    def step(self) -> Function:
        """q, target -> the next q: q + J' (J J' + mu 1)^-1 error."""
        tape, rows = self._tape, self._rows
        square = tape.let("error2", sympy.Add(*(part**2 for part in self._error)))
        damping = tape.let("damping", square + sympy.Rational(1, 10**14))
        size = len(rows)
        gram = [[tape.let("gram", dot(rows[i], rows[j]) + (damping if i == j else 0)) for j in range(size)] for i in range(size)]
        weights = solve_symmetric(gram, self._error, tape)
        outputs = [symbol + dot([row[joint] for row in rows], weights) for joint, symbol in enumerate(symbols_of(self._q))]
        return tape.function(self._words("step", replace(self._q, name="q_next")), outputs)

    def verdict(self) -> Function:
        """OK where the target is met; steps may have led to where there is no foot."""
        seed = replace(self._q, name="q_seed")
        square = self._tape.let("error2", sympy.Add(*(part**2 for part in self._error)))
        given = (*symbols_of(seed), *symbols_of(self._target), *parameter_symbols(self._mechanism).values())
        taint = self._tape.let("taint", sympy.Add(*(Residue(x) for x in given)))
        status = Select(Finite(taint), Select(Less(square, _CLOSE2), _OK, _NO_CONVERGENCE), _BAD_INPUT)
        return self._tape.function(self._words("verdict", _STATUS, seed), [status])

    def _words(self, name: str, output: Port, *more: Port) -> Signature:
        kind = "position" if self._target is TARGET else "pose"
        inputs = [self._q, *more, self._target]
        return signature(self._mechanism, self._route.owner, f"{kind}_{name}", inputs, [output], "", _SOURCE)


def _vector(values: Sequence[sympy.Expr]) -> Vec:
    return (values[0], values[1], values[2])
