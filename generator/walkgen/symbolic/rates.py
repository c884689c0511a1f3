"""Joint rates and accelerations from the foot's, of legs and routes of any number of joints: damped near singularities."""

from dataclasses import dataclass
from decimal import Decimal

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.forward import PathFunctions, Route, flat
from walkgen.symbolic.function import Function, Solve, Step
from walkgen.symbolic.ports import joint_port, joint_unit, parameter_ports, signature
from walkgen.symbolic.rate_damping import rate_damping
from walkgen.symbolic.rates_closed import Damping, closed_rates
from walkgen.symbolic.tape import Tape, Vec, minus, symbols_of

_DAMPED = "damped least squares with lambda^2 = (1 - (s/eps)^2) lambda_max^2 (Nakamura and Hanafusa 1986)"
_STATUS = Port("status", kind="integer")


@dataclass(frozen=True)
class _Words:
    """What the rates of so many joints are, and by which equation; `{0}` is what is wanted of the foot, `{1}` its symbol."""

    meaning: str
    equation: str


_FEWER = _Words("closest to the foot {0} {1}; UNREACHABLE where they do not give it, SINGULAR while damped", "qd = (J' J)^-1 J' v")
_THREE = _Words("that give the foot {0} {1}; SINGULAR while damped", "qd = J^-1 v")
_MORE = _Words("of least norm that give the foot {0} {1}; SINGULAR while damped", "qd = J' (J J')^-1 v")


def inverse_velocity(mechanism: Mechanism, route: Route) -> Solve:
    """qd of a wanted foot velocity; damping is that of the route's leg."""
    wanted, path = Port("v", (3,), "m/s"), PathFunctions(mechanism, route)
    words = _signature(mechanism, route, "inverse_velocity", wanted)
    jacobian, columns = _jacobian(route), path.motion.kinematics.jacobian
    kernel = path.tape.function(_kernel(words, "velocity_jacobian", (words.inputs[0], *words.inputs[2:]), (jacobian,)), flat(columns))
    closed = _closed_form(words, path.tape, columns, _vector(symbols_of(wanted)), rate_damping(mechanism, route.limbs[-1]))
    arguments = ("q", *(port.name for port in parameter_ports(mechanism)), "J")
    return Solve(words, (jacobian,), (Step(kernel, arguments), _solve(mechanism, route, "v", "qd")), closed)


def inverse_acceleration(mechanism: Mechanism, route: Route) -> Solve:
    """qdd of a wanted foot acceleration at given joint rates; damping is that of the route's leg."""
    acceleration, path = Port("a", (3,), "m/s^2"), PathFunctions(mechanism, route)
    words = _signature(mechanism, route, "inverse_acceleration", acceleration)
    wanted = path.tape.vector("wanted", minus(_vector(symbols_of(acceleration)), path.motion.kinematics.bias(path.motion.qd)[0]))
    jacobian, rest, columns = _jacobian(route), Port("rest", (3,), "m/s^2"), path.motion.kinematics.jacobian
    kernel = path.tape.function(_kernel(words, "acceleration_jacobian", words.inputs, (jacobian, rest)), (*flat(columns), *wanted))
    closed = _closed_form(words, path.tape, columns, wanted, rate_damping(mechanism, route.limbs[-1]))
    arguments = (*(port.name for port in words.inputs), "J", "rest")
    return Solve(words, (jacobian, rest), (Step(kernel, arguments), _solve(mechanism, route, "rest", "qdd")), closed)


def _signature(mechanism: Mechanism, route: Route, name: str, wanted: Port) -> Signature:
    """Of either function; the bound on |qd| is stated for velocities, whose right side is the user's own."""
    joints = route.joints
    words = _FEWER if len(joints) < 3 else _THREE if len(joints) == 3 else _MORE
    if wanted.name == "v":
        inputs, output = [joint_port("q", joints), wanted], joint_port("qd", joints, "/s")
        doc = f"Joint rates {words.meaning.format('velocity', 'v')}, |qd| <= |v| / (2 lambda)."
    else:
        inputs, output = [joint_port("q", joints), joint_port("qd", joints, "/s"), wanted], joint_port("qdd", joints, "/s^2")
        doc = f"Joint accelerations {words.meaning.format('acceleration', 'a')}."
    return signature(mechanism, route.owner, name, inputs, [output, _STATUS], doc, f"{words.equation}; {_DAMPED}")


def _jacobian(route: Route) -> Port:
    return Port("J", (3, len(route.joints)), f"m/({joint_unit(route.joints)})")


def _kernel(words: Signature, name: str, inputs: tuple[Port, ...], outputs: tuple[Port, ...]) -> Signature:
    return Signature(words.robot, words.owner, name, inputs, outputs, "", words.source)


def _vector(symbols: tuple[sympy.Symbol, ...]) -> Vec:
    return (symbols[0], symbols[1], symbols[2])


def _solve(mechanism: Mechanism, route: Route, rate: str, output: str) -> Step:
    """Three joints have a routine of their own, which is faster."""
    count = len(route.joints)
    damping = rate_damping(mechanism, route.limbs[-1])
    if count == 3:
        return Step("wg_damped_inverse_3", ("J", rate, *damping, output, "status"))
    return Step("wg_damped_inverse", ("J", rate, count, *damping, output, "status"))


def _closed_form(words: Signature, tape: Tape, columns: tuple[Vec, ...], rate: Vec, damping: tuple[Decimal, Decimal]) -> Function:
    """The same map without routines."""
    epsilon, largest = (sympy.Rational(str(value)) for value in damping)
    return tape.function(words, closed_rates(columns, rate, Damping(epsilon, largest), tape))
