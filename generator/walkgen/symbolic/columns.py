"""What loops do over the columns of a Jacobian where a path has many joints, so that compilers get no more text than these have."""

from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port
from walkgen.symbolic.forward import Entry, PathFunctions, Route, flat
from walkgen.symbolic.function import Derivation, Solve, Step
from walkgen.symbolic.path import Kinematics
from walkgen.symbolic.ports import joint_port, joint_unit, signature

_MANY = 8
"""Joints from which on loops over their pairs are as fast as straight-line code, within a twentieth."""


def path_function(mechanism: Mechanism, route: Route, path: PathFunctions, name: str, entry: Entry) -> Derivation:
    """One entry as a function of this path; by loops where that costs nothing.

    Of a mechanism with runtime parameters there is none: they have no derivatives.
    """
    count = len(route.joints)
    if name != "foot_hessian" or count < _MANY or mechanism.parameters or not is_serial(route, path):
        return path.derivation(name, entry)
    steps = (columns_step(mechanism, route, path), Step("wg_second_derivatives", ("J", "axes", count, "H")))
    return Solve(path.words(name, entry), column_ports(route), steps, PathFunctions(mechanism, route).function(name, entry))


def is_serial(route: Route, path: PathFunctions) -> bool:
    """Whether each joint turns all columns of those behind it, and nothing else does."""
    return isinstance(path.motion.kinematics, Kinematics) and route.limbs[-1].curved_sole is None


def has_spare_joints(route: Route, path: PathFunctions) -> bool:
    """Whether rates are those of least norm of joints in series."""
    return len(route.joints) > 3 and is_serial(route, path)


def column_ports(route: Route) -> tuple[Port, Port]:
    """J and axes."""
    shape, unit = (3, len(route.joints)), joint_unit(route.joints)
    return Port("J", shape, f"m/({unit})"), Port("axes", shape, f"rad/({unit})")


def columns_step(mechanism: Mechanism, route: Route, path: PathFunctions) -> Step:
    """q -> J, axes."""
    inputs, outputs, kinematics = (joint_port("q", route.joints), *path.sides), column_ports(route), path.motion.kinematics
    words = signature(mechanism, route.owner, "columns", inputs, outputs, "", "J_i = D_i p")
    kernel = path.tape.function(words, (*flat(kinematics.jacobian), *flat(kinematics.angular)))
    return Step(kernel, path.arguments((*words.inputs, *outputs)))


def columns_rest(route: Route, rates: str) -> Step:
    """J, axes, `rates`, a -> rest."""
    return Step("wg_rest_acceleration", ("J", "axes", rates, "a", len(route.joints), "rest"))
