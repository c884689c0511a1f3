"""Joint rates and accelerations from the foot's: the Jacobian inverted, damped near singularities."""

from decimal import Decimal

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT, number
from walkgen.signature import STATUSES, Port, Signature
from walkgen.symbolic.forward import PathFunctions, Route, bias, flat
from walkgen.symbolic.function import Finite, Function, Less, Select, Solve, Step
from walkgen.symbolic.ports import joint_port, parameter_ports, signature
from walkgen.symbolic.tape import Tape, Vec, cross, dot, minus, symbols_of

_JACOBIAN = Port("J", (3, 3), "m/rad")
_OK, _SINGULAR, _BAD_INPUT = (sympy.Integer(STATUSES.index(name)) for name in ("OK", "SINGULAR", "BAD_INPUT"))
_SOURCE = "qd = J^-1 v; damped least squares with lambda^2 = (1 - (s/eps)^2) lambda_max^2 (Nakamura and Hanafusa 1986)"
_STATUS = Port("status", kind="integer")


def inverse_velocity(mechanism: Mechanism, leg: Limb) -> Solve:
    """qd of a wanted foot velocity."""
    inputs = [joint_port("q", leg.joints), Port("v", (3,), "m/s")]
    doc = "Joint rates that give the foot velocity v; SINGULAR while damped, |qd| <= |v| / (2 lambda)."
    words = signature(mechanism, leg.name, "inverse_velocity", inputs, [joint_port("qd", leg.joints, "/s"), _STATUS], doc, _SOURCE)
    path = PathFunctions(mechanism, Route(leg.name, (leg,)))
    jacobian = path.motion.kinematics.jacobian
    kernel = path.tape.function(_kernel(words, "velocity_jacobian", words.inputs[:1] + words.inputs[2:], ()), flat(jacobian))
    closed = _closed_form(words, path.tape, jacobian, _vector(symbols_of(inputs[1])), _damping(mechanism, leg))
    arguments = ("q", *(port.name for port in parameter_ports(mechanism)), "J")
    return Solve(words, (_JACOBIAN,), (Step(kernel, arguments), _solve(mechanism, leg, "v", "qd")), closed)


def inverse_acceleration(mechanism: Mechanism, leg: Limb) -> Solve:
    """qdd of a wanted foot acceleration at given joint rates."""
    inputs = [joint_port("q", leg.joints), joint_port("qd", leg.joints, "/s"), Port("a", (3,), "m/s^2")]
    doc = "Joint accelerations that give the foot acceleration a; SINGULAR while damped."
    words = signature(mechanism, leg.name, "inverse_acceleration", inputs, [joint_port("qdd", leg.joints, "/s^2"), _STATUS], doc, _SOURCE)
    path = PathFunctions(mechanism, Route(leg.name, (leg,)))
    wanted = path.tape.vector("wanted", minus(_vector(symbols_of(inputs[2])), bias(path.motion)[0]))
    rest = Port("rest", (3,), "m/s^2")
    kernel = path.tape.function(
        _kernel(words, "acceleration_jacobian", words.inputs, (rest,)), (*flat(path.motion.kinematics.jacobian), *wanted)
    )
    closed = _closed_form(words, path.tape, path.motion.kinematics.jacobian, wanted, _damping(mechanism, leg))
    arguments = (*(port.name for port in words.inputs), "J", "rest")
    return Solve(words, (_JACOBIAN, rest), (Step(kernel, arguments), _solve(mechanism, leg, "rest", "qdd")), closed)


def _kernel(words: Signature, name: str, inputs: tuple[Port, ...], more: tuple[Port, ...]) -> Signature:
    return Signature(words.robot, words.owner, name, inputs, (_JACOBIAN, *more), "", words.source)


def _vector(symbols: tuple[sympy.Symbol, ...]) -> Vec:
    return (symbols[0], symbols[1], symbols[2])


def _damping(mechanism: Mechanism, leg: Limb) -> tuple[Decimal, Decimal]:
    """Epsilon and lambda_max as 20-digit decimals, at the default parameters."""
    assert leg.damping is not None
    epsilon, largest = (Decimal(CONTEXT.nstr(number(value, mechanism), 20)) for value in leg.damping)
    return epsilon, largest


def _solve(mechanism: Mechanism, leg: Limb, rate: str, output: str) -> Step:
    return Step("wg_damped_inverse_3", ("J", rate, *_damping(mechanism, leg), output, "status"))


def _closed_form(words: Signature, tape: Tape, columns: tuple[Vec, ...], rate: Vec, damping: tuple[Decimal, Decimal]) -> Function:
    """The same map without iteration: the smallest singular value from the cubic of J J', both solves by Cramer's rule."""
    epsilon, largest = (sympy.Rational(str(value)) for value in damping)
    first, second, third = columns
    gram = [[tape.let("gram", dot([c[i] for c in columns], [c[j] for c in columns])) for j in range(3)] for i in range(3)]
    smallest2 = _smallest_eigenvalue(gram, tape)
    damped = Less(smallest2, epsilon**2)
    lambda2 = tape.let("lambda2", (1 - smallest2 / epsilon**2) * largest**2)
    direct = _cramer(columns, rate, tape, "direct")
    loaded = [[gram[i][j] + (lambda2 if i == j else 0) for j in range(3)] for i in range(3)]
    along = _cramer(tuple(_vector3([loaded[i][j] for i in range(3)]) for j in range(3)), rate, tape, "damped")
    rates = [
        tape.let("rate", Select(damped, dot(column, along), value)) for column, value in zip((first, second, third), direct, strict=True)
    ]
    finite = Finite(tape.let("sum", sympy.Add(*rate, *(entry for column in columns for entry in column))))
    return tape.function(words, [*rates, Select(finite, Select(damped, _SINGULAR, _OK), _BAD_INPUT)])


def _vector3(entries: list[sympy.Expr]) -> Vec:
    return (entries[0], entries[1], entries[2])


def _cramer(columns: tuple[Vec, ...], right: Vec, tape: Tape, name: str) -> Vec:
    """Solve a 3x3 system given by columns."""
    a, b, c = (tape.vector(f"{name}_column", column) for column in columns)
    bc = tape.vector(f"{name}_minor", cross(b, c))
    scale = tape.let(f"{name}_det", dot(a, bc))
    ca, ab = (tape.vector(f"{name}_minor", cross(*pair)) for pair in ((c, a), (a, b)))
    x, y, z = (tape.let(f"{name}_solution", dot(minor, right) / scale) for minor in (bc, ca, ab))
    return (x, y, z)


def _smallest_eigenvalue(gram: list[list[sympy.Expr]], tape: Tape) -> sympy.Expr:
    """Of a symmetric positive 3x3 matrix, by the trigonometric solution of its cubic (Smith 1961)."""
    mean = tape.let("mean", (gram[0][0] + gram[1][1] + gram[2][2]) / 3)
    shifted = [[tape.let("shifted", gram[i][j] - (mean if i == j else 0)) for j in range(3)] for i in range(3)]
    spread2 = tape.let("spread2", sympy.Add(*(shifted[i][j] ** 2 for i in range(3) for j in range(3))) / 6)
    spread = tape.let("spread", sympy.sqrt(spread2))
    columns = tuple(_vector3([shifted[i][j] for i in range(3)]) for j in range(3))
    half = tape.let("half_det", dot(columns[0], tape.vector("minor", cross(columns[1], columns[2]))) / 2)
    cube = tape.let("cube", spread * spread2)
    other = tape.let("other", sympy.sqrt(Select(Less(half**2, cube**2), (cube - half) * (cube + half), 0)))
    angle = tape.let("third_angle", sympy.atan2(other, half) / 3)
    value = tape.let("eigenvalue", mean + 2 * spread * sympy.cos(angle + 2 * sympy.pi / 3))
    return tape.let("smallest2", Select(Less(value, 0), 0, value))
