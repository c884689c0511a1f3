"""The stable pose to which a robot slides on three feet: its weight and feet, the ground of its spec, and a solve between them."""

from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port
from walkgen.symbolic.function import Function, Solve, Step
from walkgen.symbolic.ports import parameter_ports, signature

FEET = 3
_OUTPUTS = (
    Port("pose", (4, 4), "1 and m"),
    Port("status", kind="integer"),
    Port("normal_forces", (FEET,), "N"),
    Port("path", ("poses", 4, 4), "1 and m"),
    Port("steps", kind="integer"),
)
_DOC = (
    "The stable pose to which the robot, rigid at q, slides on three feet, so slowly that inertia does not count: from base_pose, its feet "
    "put on the terrain, by steps in which the fastest foot goes at most `step`. feet: their numbers; wrench: on the robot beside its "
    "weight, force and moment about the world's origin. path: the poses on the way, the first of them where there are more than room for; "
    "rows beyond its `steps` + 1 poses repeat the last. Where it ends depends on where it starts. INFEASIBLE where a foot lifts off or "
    "leaves the terrain, pose is then the last before; NO_CONVERGENCE after most_steps; SINGULAR for feet on a line; BAD_INPUT off the "
    "terrain and where it has no mu."
)


def settle(mechanism: Mechanism, foot_positions: Function, weight: Function | None, surface: Solve) -> Solve | None:
    """P3; None where there are too few legs or there is no mass.

    Args:
        mechanism: the robot.
        foot_positions: of its q, in the first platform's frame.
        weight: of its q, centre of mass there and weight in the world.
        surface: of a point, what the solve asks of the ground.
    """
    legs = len(mechanism.legs)
    if legs < FEET or weight is None:
        return None
    (feet_at,), (q, *_) = foot_positions.signature.outputs, foot_positions.signature.inputs
    given = (q.name, *(port.name for port in parameter_ports(mechanism)))
    carried = weight.signature.outputs
    found = (*(port.name for port in carried), "wrench", "base_pose", surface.signature.full_name, "step", "most_steps", "poses")
    steps = (
        Step(foot_positions, (*given, feet_at.name)),
        Step(weight, (*given, *(port.name for port in carried))),
        Step("wg_settle", (legs, feet_at.name, "feet", *found, "pose", "normal_forces", "path", "steps", "status")),
    )
    words = signature(mechanism, "", "settle", _inputs(q, legs), _OUTPUTS, _DOC, "theory 4.2, P3: T = -(mu N / |V| + c) V")
    return Solve(words, (feet_at, *carried), steps, tables=surface.tables, callbacks=(surface,))


def _inputs(q: Port, legs: int) -> tuple[Port, ...]:
    """A robot of three legs stands on all of them where nothing else is said."""
    return (
        Port("base_pose", (4, 4), "1 and m"),
        q,
        Port("feet", (FEET,), kind="integer", default=(0.0, 1.0, 2.0) if legs == FEET else ()),
        Port("wrench", (6,), "N, N m", default=(0.0,) * 6),
        Port("step", (), "m", default=(0.01,)),
        Port("most_steps", kind="integer", default=(500.0,)),
    )
