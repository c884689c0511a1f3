"""Says why a robot or a part of it has no function of a name, so that a user learns more than that it is not there."""

from collections.abc import Iterable
from difflib import get_close_matches

from walkgen.errors import Problem, UnsupportedMechanism

_BRANCHES = frozenset({"inverse", "inverse_branch", "inverse_distance"})
_BRANCHED_JOINTS = 3
_FORWARD = (
    "foot_position foot_rotation foot_pose foot_jacobian foot_position_jacobian foot_spatial_jacobian foot_hessian foot_velocity "
    "foot_acceleration foot_bias_acceleration foot_torque joint_frames"
)
_SEEDED = "inverse_near inverse_pose within_limits inverse_velocity inverse_acceleration inverse_velocity_acceleration"
_LIMB_DYNAMICS = "inverse_dynamics forward_dynamics mass_matrix bias gravity_torque coriolis_matrix kinetic_energy potential_energy"
_ROLLING = (
    "link_angles joint_angles flat_ankle flat_position flat_motion stance_position hip_position toe_rolling toe_motion heel_rolling "
    "heel_motion contact_line stance_forces stance_forces_passive stance_forces_pressure stance_forces_load stance_forces_ankle "
    "stance_forces_rolling stance_forces_sliding"
)
_LEG = (
    f"{_FORWARD} inverse inverse_branch inverse_admissible inverse_distance {_SEEDED} {_LIMB_DYNAMICS} inverse_dynamics_derivatives "
    "regressor base_parameters foot_compliance sole_points sole_normal sole_compliance ground_pressure driving_forces joint_reactions "
    f"transmission_angles pair_positions power assembly_status {_ROLLING}"
)
_ROBOT = (
    "platform_poses foot_positions foot_jacobians contact_points contact_normals adapt adapt_velocity com com_jacobian "
    "centroidal_momentum_matrix momentum momentum_rate demanded_wrench floating_mass_matrix floating_inverse_dynamics contact_forces "
    "friction_needed slip settle chain_reactions stance_compliance load_misfit stability_margins stability_margins_d_com feasible_region "
    "disturbance_margin tipping_acceleration tipping_time tipping_tilt tipping_speed_limit centroidal_inertia terrain gait"
)
_STABILITY = ("stability_margins", "stability_margins_d_com", "feasible_region", "disturbance_margin")
VOCABULARY = {
    "leg": frozenset(_LEG.split()),
    "chain": frozenset({"pose", "jacobian", "frames"}),
    "terrain": frozenset({"height", "normal", "tangents", "curvature", "ground", "compliance", "patch", "project"}),
    "gait": frozenset({"states", "leg_phase", "next_event", "foot_transfers", "foot_targets"}),
    "schedule": frozenset({"states", "leg_phase", "next_event", "foot_transfers"}),
    "route": frozenset(f"{_FORWARD} {_SEEDED}".split()),
    "robot": frozenset(_ROBOT.split()),
}
"""Names that walkgen knows for each kind of owner; not every mechanism has them all."""


_FLAT = frozenset({"inverse", "inverse_branch", "inverse_near", "inverse_pose", "inverse_admissible", "inverse_distance"})
_NEEDS = {
    **dict.fromkeys(_ROLLING.split(), "its design has no curved_sole, or that has no such curve"),
    "contact_line": "its design has no curved_sole with a width",
    "foot_compliance": "a link of some length has no cross-section: name one of [sections] as section in every link of the leg",
    "stance_compliance": "a link of some length has no cross-section: name one of [sections] as section in every link of all legs",
    "load_misfit": "no chain is elastic: name one of [sections] as section in the links of chains, and of all legs",
    "chain_reactions": "it has no connecting chains",
    **dict.fromkeys(
        (*_STABILITY, "tipping_acceleration", "tipping_time", "tipping_tilt", "tipping_speed_limit"), "it stands on fewer than two points"
    ),
    "adapt": "it takes connecting chains with joints, and legs of exactly three q, which follow: those of more have freedom of their own, "
    "those of fewer miss targets, and so do those on curved soles, which move in planes and put their feet flat",
    "adapt_velocity": "it takes connecting chains with joints, and legs of exactly three q: those of more have freedom of their own, "
    "those of fewer, and those on curved soles, do not move their feet every way",
    "settle": "it takes three legs, mass and the ground that [[terrain]] describes",
    **dict.fromkeys(("sole_points", "sole_normal"), "it stands on a point: its design may have a sole or a curved_sole"),
    "ground_pressure": "it stands on no rectangle: sole in its design is one",
    "sole_compliance": "it stands on a point, or a link of some length has no cross-section: give the design a sole and its links sections",
    "foot_transfers": "the gait has no lift",
    "foot_targets": "the gait has no stance",
    "contact_points": "every leg stands on a point, and foot_positions has them: a leg design may have a sole or a curved_sole",
    "contact_normals": "every leg stands on a point, which has no normal: a leg design may have a sole or a curved_sole",
}


_ROLLS = "the foot rolls on a curved sole: flat_position, stance_position and *_motion lead to hip, knee and ankle"


class MissingFunction(UnsupportedMechanism, AttributeError):
    """A function that walkgen knows but this robot does not have; also an AttributeError, so that hasattr answers False."""


def absent(kind: str, owner: str, name: str, built: Iterable[str], *, joints: int = 0) -> AttributeError:
    """What to raise for a name that `owner` does not have.

    Args:
        kind: leg, chain, route, terrain, gait, schedule or robot.
        owner: its name.
        name: what was asked for.
        built: the names it does have.
        joints: how many it has, for a leg.

    Returns:
        MissingFunction for a name of walkgen's vocabulary, a plain AttributeError for any other.
    """
    names = sorted(built)
    near = get_close_matches(name, names, 1)
    cure = f"did you mean {near[0]}?" if near else f"it has {', '.join(names) or 'no functions'}"
    if name.removesuffix("_d_param") not in VOCABULARY[kind]:
        return AttributeError(f"{kind} {owner!r} has no {name!r}; {cure}")
    reason = _ROLLS if name in _FLAT and not set(names).isdisjoint(_ROLLING.split()) else _reason(name, joints)
    return MissingFunction(Problem("WG410", f"{kind} {owner!r} has no {name!r}: {reason}", cure))


def _reason(name: str, joints: int) -> str:
    if name in _BRANCHES and joints > _BRANCHED_JOINTS:
        return f"{joints} joints reach a position in infinitely many ways; inverse_near and inverse_pose start from a seed"
    if name == "inverse_pose" and 0 < joints <= _BRANCHED_JOINTS:
        return f"{joints} joints cannot give the foot every pose; inverse reaches positions"
    if name in _NEEDS:
        return f"{_NEEDS[name]}, or [generate] functions leaves it out"
    if name == "gait":
        return "its spec has no [gait]"
    if name == "terrain":
        return "its spec describes no ground: [[terrain]] does"
    return "it was not built: [generate] functions leaves it out, or walkgen does not derive it for this mechanism"
