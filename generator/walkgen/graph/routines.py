"""The hand-written support routines that a Composite may call: where they live and which arguments they write."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class Routine:
    """One routine, in C (`header`, in csupport) and in NumPy (`walkgen.runtime.solves.<module>`).

    The arguments stand in the order inputs, inouts, outputs. C takes them all and writes through the last two
    kinds; NumPy takes inputs and inouts and returns inouts and outputs (one bare, several as a tuple).
    """

    name: str
    header: str
    module: str
    inputs: int
    inouts: int = 0
    outputs: int = 0

    @property
    def function(self) -> str:
        """Its name in NumPy."""
        return self.name.removeprefix("wg_")

    @property
    def taken(self) -> int:
        """How many leading arguments NumPy takes."""
        return self.inputs + self.inouts


_KNOWN = (
    Routine("wg_any_unreachable", "walkgen_inverse.h", "inverse", inputs=2),
    Routine("wg_closest_yaw_pitch_pitch", "walkgen_inverse.h", "inverse", inputs=2, inouts=2),
    Routine("wg_closest_yaw_pitch_pitch_branch", "walkgen_inverse.h", "inverse", inputs=3, inouts=2),
    Routine("wg_inverse_general", "walkgen_inverse_general.h", "inverse_general", inputs=3, outputs=2),
    Routine("wg_inverse_general_branch", "walkgen_inverse_general.h", "inverse_general", inputs=4, outputs=2),
    Routine("wg_curve_roots", "walkgen_curve.h", "curve", inputs=4, outputs=2),
    Routine("wg_crossings", "walkgen_crossings.h", "crossings", inputs=5, outputs=4),
    Routine("wg_first_root", "walkgen_first_root.h", "first_root", inputs=4, outputs=2),
    Routine("wg_nearest_row", "walkgen_rows.h", "rows", inputs=5, outputs=2),
    Routine("wg_admissible_row", "walkgen_rows.h", "rows", inputs=5, outputs=2),
    Routine("wg_closest_within", "walkgen_within.h", "within", inputs=4, inouts=2),
    Routine("wg_closest_driven", "walkgen_driven.h", "driven", inputs=6, inouts=2),
    Routine("wg_inverse_driven", "walkgen_driven.h", "driven", inputs=7, outputs=2),
    Routine("wg_nearer_driven", "walkgen_driven.h", "driven", inputs=7, inouts=2),
    Routine("wg_inverse_reach", "walkgen_reach.h", "reach", inputs=5, outputs=2),
    Routine("wg_inverse_pose", "walkgen_reach.h", "reach", inputs=5, outputs=2),
    Routine("wg_heightmap", "walkgen_heightmap.h", "heightmap", inputs=6, outputs=1),
    Routine("wg_heightmap_project", "walkgen_heightmap.h", "heightmap", inputs=6, outputs=2),
    Routine("wg_gait_states", "walkgen_gait.h", "gait", inputs=5, outputs=1),
    Routine("wg_gait_phase", "walkgen_gait.h", "gait", inputs=5, outputs=1),
    Routine("wg_gait_next_event", "walkgen_gait.h", "gait", inputs=5, outputs=2),
    Routine("wg_gait_transfers", "walkgen_gait.h", "gait", inputs=8, outputs=3),
    Routine("wg_gait_targets", "walkgen_gait.h", "gait", inputs=8, outputs=3),
    Routine("wg_schedule_states", "walkgen_schedule.h", "schedule", inputs=5, outputs=1),
    Routine("wg_schedule_phase", "walkgen_schedule.h", "schedule", inputs=4, outputs=1),
    Routine("wg_schedule_next_event", "walkgen_schedule.h", "schedule", inputs=5, outputs=2),
    Routine("wg_schedule_transfers", "walkgen_schedule.h", "schedule", inputs=8, outputs=3),
    Routine("wg_adapt", "walkgen_adapt.h", "adapt", inputs=11, outputs=3),
    Routine("wg_adapt_velocity", "walkgen_adapt_velocity.h", "adapt_velocity", inputs=11, outputs=2),
    Routine("wg_contact_least_squares", "walkgen_contact.h", "contact", inputs=8, inouts=1, outputs=5),
    Routine("wg_contact_limited", "walkgen_contact_limited.h", "contact", inputs=11, inouts=1, outputs=6),
    Routine("wg_contact_stiffness", "walkgen_contact_stiffness.h", "contact_stiffness", inputs=7, outputs=5),
    Routine("wg_contact_stiffness_blocks", "walkgen_contact_stiffness.h", "contact_stiffness", inputs=7, outputs=5),
    Routine("wg_contact_vertical", "walkgen_contact_vertical.h", "contact_vertical", inputs=4, outputs=4),
    Routine("wg_grasp", "walkgen_stance.h", "stance", inputs=2, outputs=6),
    Routine("wg_friction_needed", "walkgen_friction_needed.h", "friction_needed", inputs=4, outputs=4),
    Routine("wg_friction_share", "walkgen_friction_margins.h", "friction_margins", inputs=5, outputs=2),
    Routine("wg_load_margin", "walkgen_friction_margins.h", "friction_margins", inputs=6, outputs=3),
    Routine("wg_foot_admissible", "walkgen_friction_margins.h", "friction_margins", inputs=8, outputs=2),
    Routine("wg_slip", "walkgen_slip.h", "slip", inputs=4, outputs=7),
    Routine("wg_stability_margins", "walkgen_stability.h", "stability", inputs=9, outputs=10),
    Routine("wg_stability_margins_d_com", "walkgen_stability.h", "stability", inputs=9, outputs=6),
    Routine("wg_feasible_region", "walkgen_feasible.h", "feasible", inputs=7, outputs=4),
    Routine("wg_disturbance_margin", "walkgen_feasible.h", "feasible", inputs=9, outputs=3),
    Routine("wg_tipping_time", "walkgen_tipping.h", "tipping", inputs=4, outputs=2),
    Routine("wg_tipping_tilt", "walkgen_tipping.h", "tipping", inputs=4, outputs=3),
    Routine("wg_tipping_speed_limit", "walkgen_tipping.h", "tipping", inputs=5, outputs=2),
    Routine("wg_settle", "walkgen_settle.h", "settle", inputs=11, outputs=5),
    Routine("wg_approach", "walkgen_triads.h", "triads", inputs=5, outputs=3),
    Routine("wg_close_triads", "walkgen_triads.h", "triads", inputs=5, outputs=2),
    Routine("wg_second_derivatives", "walkgen_columns.h", "columns", inputs=3, outputs=1),
    Routine("wg_rest_acceleration", "walkgen_columns.h", "columns", inputs=5, outputs=1),
    Routine("wg_damped_inverse_3", "walkgen_damped.h", "damped", inputs=4, outputs=2),
    Routine("wg_damped_inverse", "walkgen_damped_general.h", "damped_general", inputs=5, outputs=2),
)
ROUTINES: Mapping[str, Routine] = MappingProxyType({routine.name: routine for routine in _KNOWN})
