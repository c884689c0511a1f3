"""Joint rates and accelerations from the foot's, of legs and routes of any number of joints: damped near singularities."""

from dataclasses import dataclass
from decimal import Decimal

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.columns import column_ports, columns_rest, columns_step, has_spare_joints
from walkgen.symbolic.forward import PathFunctions, Route, Sided, flat
from walkgen.symbolic.function import Function, Solve, Step
from walkgen.symbolic.ports import joint_port, joint_unit, signature
from walkgen.symbolic.rate_damping import rate_damping
from walkgen.symbolic.rates_closed import Damping, closed_rates
from walkgen.symbolic.tape import Tape, Vec, minus, symbols_of

STATUS = Port("status", kind="integer")
REST = Port("rest", (3,), "m/s^2")
"""What is left of a wanted acceleration for the joints' accelerations."""

_DAMPED = "damped least squares with lambda^2 = (1 - (s/eps)^2) lambda_max^2 (Nakamura and Hanafusa 1986)"


@dataclass(frozen=True)
class Words:
    """What the rates of so many joints are, and by which equation; `{0}` is what is wanted of the foot, `{1}` its symbol."""

    meaning: str
    equation: str

    @property
    def source(self) -> str:
        """The equation and how it is damped."""
        return f"{self.equation}; {_DAMPED}"


_FEWER = Words("closest to the foot {0} {1}; UNREACHABLE where they do not give it, SINGULAR while damped", "qd = (J' J)^-1 J' v")
_THREE = Words("that give the foot {0} {1}; SINGULAR while damped", "qd = J^-1 v")
_MORE = Words("of least norm that give the foot {0} {1}; SINGULAR while damped", "qd = J' (J J')^-1 v")


def words_of(route: Route) -> Words:
    """By how many joints there are."""
    count = len(route.joints)
    return _FEWER if count < 3 else _THREE if count == 3 else _MORE


def inverse_velocity(mechanism: Mechanism, route: Route, sided: Sided | None = None) -> Solve:
    """qd of a wanted foot velocity; damping is that of the route's leg."""
    wanted, path, told = Port("v", (3,), "m/s"), PathFunctions(mechanism, route), words_of(route)
    doc = f"Joint rates {told.meaning.format('velocity', 'v')}, |qd| <= |v| / (2 lambda)."
    outputs = (joint_port("qd", route.joints, "/s"), STATUS)
    words = signature(mechanism, route.owner, "inverse_velocity", (joint_port("q", route.joints), wanted), outputs, doc, told.source)
    closed = _closed_form(words, path.tape, path.motion.kinematics.jacobian, vector(wanted), rate_damping(mechanism, route.limbs[-1]))
    steps = (jacobian_step(mechanism, route, PathFunctions(mechanism, route, sided)), damped_step(mechanism, route, "v", "qd", "status"))
    return Solve(words, (jacobian_port(route),), steps, closed)


def inverse_acceleration(mechanism: Mechanism, route: Route, sided: Sided | None = None) -> Solve:
    """qdd of a wanted foot acceleration at given joint rates; damping is that of the route's leg."""
    path, told = PathFunctions(mechanism, route), words_of(route)
    doc = f"Joint accelerations {told.meaning.format('acceleration', 'a')}."
    outputs = (joint_port("qdd", route.joints, "/s^2"), STATUS)
    words = signature(mechanism, route.owner, "inverse_acceleration", _moving(route), outputs, doc, told.source)
    closed = _closed_form(words, path.tape, path.motion.kinematics.jacobian, _rest(path), rate_damping(mechanism, route.limbs[-1]))
    locals_, steps = _rest_steps(mechanism, route, PathFunctions(mechanism, route, sided))
    return Solve(words, locals_, (*steps, damped_step(mechanism, route, "rest", "qdd", "status")), closed)


def _rest_steps(mechanism: Mechanism, route: Route, path: PathFunctions) -> tuple[tuple[Port, ...], tuple[Step, ...]]:
    """q, qd, a -> J, rest, and what else is found on the way."""
    if has_spare_joints(route, path):
        return (*column_ports(route), REST), (columns_step(mechanism, route, path), columns_rest(route, "qd"))
    return (jacobian_port(route), REST), (rest_step(mechanism, route, path, "qd"),)


def jacobian_step(mechanism: Mechanism, route: Route, path: PathFunctions) -> Step:
    """q -> J."""
    port = jacobian_port(route)
    inputs = (joint_port("q", route.joints), *path.sides)
    words = signature(mechanism, route.owner, "velocity_jacobian", inputs, (port,), "", words_of(route).source)
    return Step(path.tape.function(words, flat(path.motion.kinematics.jacobian)), path.arguments((*words.inputs, port)))


def rest_step(mechanism: Mechanism, route: Route, path: PathFunctions, rates: str) -> Step:
    """q, `rates`, a -> J, rest."""
    outputs = (jacobian_port(route), REST)
    inputs = (*_moving(route), *path.sides)
    words = signature(mechanism, route.owner, "acceleration_jacobian", inputs, outputs, "", words_of(route).source)
    kernel = path.tape.function(words, (*flat(path.motion.kinematics.jacobian), *_rest(path)))
    names = path.arguments((*words.inputs, *outputs))
    return Step(kernel, tuple(rates if name == "qd" else name for name in names))


def _moving(route: Route) -> tuple[Port, Port, Port]:
    return joint_port("q", route.joints), joint_port("qd", route.joints, "/s"), Port("a", (3,), "m/s^2")


def _rest(path: PathFunctions) -> Vec:
    """a - Jdot qd."""
    wanted = vector(Port("a", (3,), "m/s^2"))
    return path.tape.vector("wanted", minus(wanted, path.motion.kinematics.bias(path.motion.qd)[0]))


def jacobian_port(route: Route) -> Port:
    """The foot's Jacobian as what one step gives another."""
    return Port("J", (3, len(route.joints)), f"m/({joint_unit(route.joints)})")


def vector(port: Port) -> Vec:
    """A port's three symbols."""
    x, y, z = symbols_of(port)
    return (x, y, z)


def damped_step(mechanism: Mechanism, route: Route, rate: str, output: str, status: str, *, unsure: bool = False) -> Step:
    """J, `rate` -> `output`, `status`; three joints have a routine of their own, which is faster but at poses that are `unsure`."""
    count = len(route.joints)
    damping = rate_damping(mechanism, route.limbs[-1])
    if count == 3 and not unsure:
        return Step("wg_damped_inverse_3", ("J", rate, *damping, output, status))
    return Step("wg_damped_inverse", ("J", rate, count, *damping, output, status))


def exact(damping: tuple[Decimal, Decimal]) -> Damping:
    """As rationals."""
    epsilon, largest = (sympy.Rational(str(value)) for value in damping)
    return Damping(epsilon, largest)


def _closed_form(words: Signature, tape: Tape, columns: tuple[Vec, ...], rate: Vec, damping: tuple[Decimal, Decimal]) -> Function:
    """The same map without routines."""
    return tape.function(words, closed_rates(columns, rate, exact(damping), tape))
