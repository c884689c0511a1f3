"""The names of the functions that can be generated, so that a spec can choose among them and names can be checked for collisions."""

from typing import Final

FORWARD_FUNCTIONS: Final = (
    "foot_position",
    "foot_rotation",
    "foot_pose",
    "foot_jacobian",
    "foot_position_jacobian",
    "foot_spatial_jacobian",
    "foot_hessian",
    "foot_velocity",
    "foot_acceleration",
    "foot_bias_acceleration",
    "foot_torque",
    "joint_frames",
)
"""Of every leg, and of every route from the root platform to a foot."""

INVERSE_FUNCTIONS: Final = (
    "inverse",
    "inverse_branch",
    "inverse_near",
    "inverse_admissible",
    "inverse_distance",
    "inverse_pose",
    "within_limits",
    "inverse_velocity",
    "inverse_acceleration",
    "inverse_velocity_acceleration",
)
"""Of legs; one to three joints have branches, more have `inverse_pose`."""

RATE_FUNCTIONS: Final = ("inverse_velocity", "inverse_acceleration", "inverse_velocity_acceleration")
ROUTE_FUNCTIONS: Final = (*FORWARD_FUNCTIONS, "inverse_near", "inverse_pose", "within_limits", *RATE_FUNCTIONS)
DYNAMICS_FUNCTIONS: Final = (
    "inverse_dynamics",
    "forward_dynamics",
    "mass_matrix",
    "bias",
    "gravity_torque",
    "coriolis_matrix",
    "kinetic_energy",
    "potential_energy",
    "inverse_dynamics_derivatives",
    "regressor",
    "base_parameters",
)
"""Of every leg; `forward_dynamics` where every joint moves some mass."""

STANCE_FUNCTIONS: Final = ("stance_compliance", "load_misfit", "chain_reactions")
"""Of the robot: where its legs' links have sections, where those of chains do as well, where it has chains."""

FLOATING_FUNCTIONS: Final = (
    "com",
    "com_jacobian",
    "centroidal_momentum_matrix",
    "momentum",
    "momentum_rate",
    "demanded_wrench",
    "floating_mass_matrix",
    "floating_inverse_dynamics",
    "centroidal_inertia",
)
"""Of the robot; those of the centre of mass where it has any mass."""

CONTACT_FUNCTIONS: Final = (
    "contact_forces",
    "contact_forces_limited",
    "contact_forces_stiffness",
    "contact_forces_coupled",
    "contact_forces_vertical",
    "grasp_map",
    "friction_needed",
    "friction_share",
    "load_margin",
    "foot_admissible",
    "slip",
    "settle",
)
"""Of robots with feet to share a load, for any number of feet in contact; `settle` where there are three legs, mass and terrain."""

STABILITY_FUNCTIONS: Final = (
    "stability_margins",
    "stability_margins_d_com",
    "feasible_region",
    "disturbance_margin",
    "tipping_acceleration",
    "tipping_time",
    "tipping_tilt",
    "tipping_speed_limit",
)
"""Of robots with feet to share a load, for any number of feet in contact, or about a line between two."""

SOLE_FUNCTIONS: Final = ("sole_points", "sole_normal", "ground_pressure", "sole_compliance")
"""Of legs with a sole; `ground_pressure` of rectangular ones, `sole_compliance` where the links have sections."""

CURVED_SOLE_FUNCTIONS: Final = (
    "link_angles",
    "joint_angles",
    "flat_ankle",
    "flat_position",
    "flat_motion",
    "stance_position",
    "hip_position",
    "toe_rolling",
    "toe_motion",
    "heel_rolling",
    "heel_motion",
    "contact_line",
    "stance_forces",
    "stance_forces_passive",
    "stance_forces_pressure",
    "stance_forces_load",
    "stance_forces_ankle",
    "stance_forces_rolling",
    "stance_forces_sliding",
)
"""Of legs with a curved sole; those of toe and heel where it has them, `contact_line` where it has a width."""

LINKAGE_FUNCTIONS: Final = ("assembly_status", "transmission_angles", "pair_positions", "driving_forces", "power", "joint_reactions")
"""Of legs that end in a linkage."""

SPRING_FUNCTIONS: Final = ("spring_length", "spring_tension", "spring_energy", "spring_moment", "unbalance_moment")
"""Of legs with springs."""

LEG_FUNCTIONS: Final = (
    *FORWARD_FUNCTIONS,
    *INVERSE_FUNCTIONS,
    *DYNAMICS_FUNCTIONS,
    *SPRING_FUNCTIONS,
    *LINKAGE_FUNCTIONS,
    "foot_compliance",
    *SOLE_FUNCTIONS,
    *CURVED_SOLE_FUNCTIONS,
)
"""`foot_compliance` where the links have sections."""

CHAIN_FUNCTIONS: Final = ("pose", "jacobian", "frames")
KINEMATIC_FUNCTIONS: Final = (
    "platform_poses",
    "foot_positions",
    "foot_jacobians",
    "contact_points",
    "contact_normals",
    "adapt",
    "adapt_velocity",
)
"""Of the robot; contacts apart from feet, and their normals, where a leg has a sole."""

ROBOT_FUNCTIONS: Final = (*KINEMATIC_FUNCTIONS, *FLOATING_FUNCTIONS, *STANCE_FUNCTIONS, *CONTACT_FUNCTIONS, *STABILITY_FUNCTIONS)
TERRAIN_FUNCTIONS: Final = ("height", "normal", "tangents", "curvature", "ground", "compliance", "patch", "project")
"""Of the ground, where the spec has any."""

GAIT_FUNCTIONS: Final = ("states", "leg_phase", "next_event", "foot_transfers", "foot_targets")
"""Of every gait of the spec; `foot_transfers` where it has a lift, `foot_targets` where it has a stance too."""

FUNCTION_NAMES: Final = LEG_FUNCTIONS + CHAIN_FUNCTIONS + ROBOT_FUNCTIONS + TERRAIN_FUNCTIONS + GAIT_FUNCTIONS
