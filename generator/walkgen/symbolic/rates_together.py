"""Joint rates and accelerations of a foot's velocity and acceleration at once: one set of sines and one factorisation serve both."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.signature import STATUSES, Port, Signature
from walkgen.spec.scalar import ZERO
from walkgen.symbolic.choices import both, chosen, either, less, same
from walkgen.symbolic.columns import column_ports, columns_rest, columns_step, has_spare_joints
from walkgen.symbolic.forward import PathFunctions, Route, Sided
from walkgen.symbolic.frames import Frame, expression, parameter_symbols
from walkgen.symbolic.function import Epsilon, Function, Residue, Solve, Step
from walkgen.symbolic.path import Kinematics, Path, path_of, quarter_turned
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.rate_damping import rate_damping
from walkgen.symbolic.rates import REST, STATUS, damped_step, exact, jacobian_port, jacobian_step, vector, words_of
from walkgen.symbolic.rates_closed import closed_rates
from walkgen.symbolic.split import factored
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Columns, Tape, Vec, dot, minus, symbols_of, times

_V, _A = Port("v", (3,), "m/s"), Port("a", (3,), "m/s^2")
_BIAS = Port("bias", (6,), "m/s^2 and rad/s^2")
_OK, _NOT_SURE, _BAD_INPUT = (sympy.Integer(STATUSES.index(name)) for name in ("OK", "UNREACHABLE", "BAD_INPUT"))
_LEAST = sympy.Rational(1, 10**5)
"""Products of three numbers of a Jacobian of this norm do not vanish, in float either."""


def inverse_velocity_acceleration(mechanism: Mechanism, route: Route, sided: Sided | None = None) -> Solve:
    """qd and qdd of a wanted foot velocity and acceleration: what `inverse_velocity` and, at its qd, `inverse_acceleration` give."""
    joints, told, name = route.joints, words_of(route), "inverse_velocity_acceleration"
    outputs = (joint_port("qd", joints, "/s"), joint_port("qdd", joints, "/s^2"), STATUS)
    doc = f"Joint rates {told.meaning.format('velocity', 'v')}; joint accelerations at these rates, likewise of a."
    words = signature(mechanism, route.owner, name, (joint_port("q", joints), _V, _A), outputs, doc, told.source)
    path = PathFunctions(mechanism, route)
    quick = _regular(mechanism, route)
    steps = _one_after_the_other(mechanism, route, PathFunctions(mechanism, route, sided), unsure=quick is not None)
    if quick is not None:
        guard, names = ("wg_any_unreachable", ("status", 1)), (*(port.name for port in words.inputs), "qd", "qdd", "status")
        steps = (Step(quick, names), *(replace(step, guard=guard) for step in steps))
    kept = (*column_ports(route), REST) if has_spare_joints(route, path) else (jacobian_port(route), _BIAS, REST)
    return Solve(words, (*kept, *_found(route)), steps, _closed_form(mechanism, route, words, path))


# ---- any pose


def _found(route: Route) -> tuple[Port, Port, Port, Port]:
    """Rates, accelerations and both statuses before they are joined."""
    reals = joint_port("rates", route.joints, "/s"), joint_port("further", route.joints, "/s^2")
    return *reals, Port("first", kind="integer"), Port("second", kind="integer")


def _one_after_the_other(mechanism: Mechanism, route: Route, path: PathFunctions, *, unsure: bool) -> tuple[Step, ...]:
    spare = has_spare_joints(route, path)
    return (
        columns_step(mechanism, route, path) if spare else jacobian_step(mechanism, route, path),
        damped_step(mechanism, route, "v", "rates", "first", unsure=unsure),
        *((columns_rest(route, "rates"),) if spare else _bias_steps(mechanism, route, path)),
        damped_step(mechanism, route, "rest", "further", "second", unsure=unsure),
        Step(_joined(mechanism, route), ("rates", "further", "first", "second", "qd", "qdd", "status")),
    )


def _bias_steps(mechanism: Mechanism, route: Route, path: PathFunctions) -> tuple[Step, Step]:
    """q, rates -> bias, as `foot_bias_acceleration` computes it, whose code then serves; a, bias -> rest."""
    moving = joint_port("q", route.joints), joint_port("qd", route.joints, "/s"), *path.sides
    words = signature(mechanism, route.owner, "rates_bias", moving, (_BIAS,), "", words_of(route).source)
    bias = path.tape.function(words, tuple(chain.from_iterable(path.motion.kinematics.bias(path.motion.qd))))
    names = path.arguments(words.inputs[2:])
    wanted = Signature(mechanism.name, route.owner, "rates_wanted", (_A, _BIAS), (REST,), "", "")
    rest = Tape().function(wanted, minus(vector(_A), symbols_of(_BIAS)[:3]))
    return Step(bias, ("q", "rates", *names, "bias")), Step(rest, ("a", "bias", "rest"))


def _joined(mechanism: Mechanism, route: Route) -> Function:
    found, outputs = _found(route), (joint_port("qd", route.joints, "/s"), joint_port("qdd", route.joints, "/s^2"), STATUS)
    words = Signature(mechanism.name, route.owner, "rates_joined", found, outputs, "", "")
    rates, accelerations, (first,), (second,) = map(symbols_of, found)
    tape = Tape()
    return tape.function(words, _together(rates, accelerations, first, second, tape))


def _together(
    rates: Sequence[sympy.Expr], accelerations: Sequence[sympy.Expr], first: sympy.Expr, second: sympy.Expr, tape: Tape
) -> tuple[sympy.Expr, ...]:
    """Both answers as one: all NaN of a bad input, else the first status where the second finds nothing worse."""
    poison = tape.let("poison", sympy.Add(*(Residue(each) for each in (*rates, *accelerations))))
    status = chosen(either(same(first, _BAD_INPUT), same(second, _OK)), first, second)
    return (*(rate + poison for rate in (*rates, *accelerations)), status)


def _closed_form(mechanism: Mechanism, route: Route, words: Signature, path: PathFunctions) -> Function:
    """The same map without routines."""
    tape, kinematics, damping = path.tape, path.motion.kinematics, exact(rate_damping(mechanism, route.limbs[-1]))
    *rates, first = closed_rates(kinematics.jacobian, vector(_V), damping, tape)
    rates = [tape.let("rate", rate) for rate in rates]
    rest = tape.vector("wanted", minus(vector(_A), kinematics.bias(rates)[0]))
    *accelerations, second = closed_rates(kinematics.jacobian, rest, damping, tape)
    accelerations = [tape.let("acceleration", each) for each in accelerations]
    return tape.function(words, _together(rates, accelerations, first, second, tape))


# ---- three joints in series at a pose that is surely regular


def _regular(mechanism: Mechanism, route: Route) -> Function | None:
    """q, v, a -> qd, qdd and OK, or UNREACHABLE where that is not sure: near singular poses, and where an input is not finite.

    All is done in the axes of the second joint, where a Jacobian has most zeros. With singular values s1 >= s2 >= s3 of J, |det J| =
    s1 s2 s3 and s1 s2 <= |J|^2 / 2 (Frobenius), so s3 >= 2 |det J| / |J|^2; the margin, more than 32 roundings times |J| since
    2 |J| <= 1 + |J|^2, covers the error of det J. None of other paths, and where no pose is regular.
    """
    if len(route.joints) != 3 or route.limbs[-1].linkage is not None or route.limbs[-1].curved_sole is not None:
        return None
    outputs = (joint_port("qd", route.joints, "/s"), joint_port("qdd", route.joints, "/s^2"), STATUS)
    words = signature(mechanism, route.owner, "regular_rates", (joint_port("q", route.joints), _V, _A), outputs, "", words_of(route).source)
    tape = Tape()
    path = path_of(route.limbs, symbols_of(joint_port("q", route.joints)), parameter_symbols(mechanism))
    kinematics = Kinematics(_seen_from_second(path), tape)
    if (inverse := factored(kinematics.jacobian, tape)) is None:
        return None
    rates = inverse.solve(_turned(path, vector(_V), "v", tape))
    rest = kinematics.bias(rates, start=_negative(_turned(path, vector(_A), "a", tape)))[0]
    accelerations = inverse.solve(_negative(rest))
    epsilon = exact(rate_damping(mechanism, route.limbs[-1])).epsilon
    poison = Residue(tape.let("total", sympy.Add(*rates, *accelerations)))
    sure = _is_regular(kinematics.jacobian, inverse.determinant, epsilon, poison, tape)
    return tape.function(words, (*rates, *accelerations, chosen(sure, _OK, _NOT_SURE)))


def _negative(vector: Vec) -> Vec:
    return minus(ZERO_VECTOR, vector)


def _is_regular(columns: Sequence[Vec], determinant: sympy.Expr, epsilon: sympy.Rational, poison: sympy.Expr, tape: Tape) -> sympy.Basic:
    """Where nothing overflows: the margin grows faster than det J. Nor does anything vanish where the bound is not too small."""
    square = tape.let("square", sympy.Add(*(dot(column, column) for column in columns)))
    margin = 16 * Epsilon() * (1 + square)
    far = less(tape.let("least", (epsilon + margin) * square + poison), 2 * sympy.Abs(determinant))
    return far if epsilon > _LEAST else both(far, less(_LEAST**2, square))


def _axes_of_second(path: Path) -> Columns:
    """In those of the first joint's frame before its motion; known numbers only, so that zeros stay zeros."""
    rotation = path.links[1].rotation
    return rotation if all(entry.is_number for column in rotation for entry in column) else IDENTITY


def _transposed(columns: Columns) -> Columns:
    x, y, z = zip(*columns, strict=True)
    return (x, y, z)


def _seen_from_second(path: Path) -> Path:
    """The path in the axes of the second joint, the first at rest."""
    still = replace(path.joints[0], zero=ZERO)
    links = (Frame(_transposed(_axes_of_second(path))), *path.links[1:])
    return replace(path, joints=(still, *path.joints[1:]), links=links, q=(sympy.S.Zero, *path.q[1:]))


def _turned(path: Path, wanted: Vec, name: str, tape: Tape) -> Vec:
    """A vector of the base's axes in those of the second joint before its motion."""
    joint = path.joints[0]
    x, y, z = tape.vector(f"{name}_mount", times(_transposed(path.links[0].rotation), wanted))
    if joint.kind == "revolute":
        cosine, sine = quarter_turned(joint.name, joint.sign * path.q[0], expression(joint.zero, path.parameters), tape)
        x, y = tape.let(f"{name}_along", cosine * x + sine * y), tape.let(f"{name}_across", cosine * y - sine * x)
    return tape.vector(f"{name}_{joint.name}", times(_transposed(_axes_of_second(path)), (x, y, z)))
