"""Friction in the pairs of linkages with triads beside free bodies with it; their efforts as linear functions of what links weigh."""

import numpy as np
import pytest

from linkages.newton_euler import Bodies, Motion
from linkages.placed import as_unknowns
from linkages.rubbed import Rubbed
from linkages.starts import Drawn
from linkages.test_linkage_regressor import standard
from linkages.topologies import spec

RUBBED = ("assembly_status", "transmission_angles", "joint_reactions", "driving_forces", "inverse_dynamics", "forward_dynamics")
WEIGHED = ("foot_position", "assembly_status", "transmission_angles", "inverse_dynamics", "regressor")
GRAVITY = (0.7, -9.8)
BOLT = "viscous = 0.8, coulomb = 1.5, mu = 0.2, radius = 0.03"
FRICTION = {
    "stephenson_2": {"a": "coulomb = 1.5", "f": BOLT, "d": "viscous = 0.4"},
    "loop_of_four": {"c": BOLT, "f": "mu = 0.1, radius = 0.04", "g": "coulomb = 2"},
    "plate_on_sliders": {"b": BOLT, "into": "coulomb = 3, viscous = 5, mu = 0.15", "on": "mu = 0.3"},
    "cross_slide": {"down": "mu = 0.2", "over": "viscous = 4", "q": BOLT},
}
QUICK = ("stephenson_2",)
NAMES = [pytest.param(name, marks=() if name in QUICK else pytest.mark.nightly) for name in FRICTION]


def drawn(name, functions, folder, friction):
    """Code, and the sets that assemble away from dead points: dimensions, drives, poses."""
    sets = Drawn(name, 6, 5, folder)
    code, rows = sets.code(("foot_position", *functions), friction), np.flatnonzero(sets.closes)
    sets.started(code, rows, [0] * len(rows))
    drives, dimensions = sets.drives[rows], sets.dimensions[rows]
    away = (np.abs(np.sin(code["leg_transmission_angles"](drives, dimensions))) > 0.2).all(-1)
    assert away.any()
    sets.started(code, rows[away], [0] * away.sum())
    return code, dimensions[away], drives[away], as_unknowns(code["leg_poses"](drives[away], dimensions[away]))


@pytest.mark.parametrize("name", NAMES)
def test_drives_and_pairs_beside_free_bodies(name, tmp_path):
    """A dense system whose links are rubbed as their tables say gives the same efforts and reactions; accelerations undo efforts."""
    code, dimensions, drives, poses = drawn(name, RUBBED, tmp_path, FRICTION[name])
    text, random = spec(name, RUBBED, FRICTION[name]), np.random.default_rng(32)
    qd, qdd, f = random.normal(size=drives.shape) / 5, random.normal(size=drives.shape), random.normal(size=(len(drives), 3)) * 100
    reactions, forces, tau = (
        code[f"leg_{function}"](drives, qd, qdd, f, dimensions) for function in ("joint_reactions", "driving_forces", "inverse_dynamics")
    )
    for row, (one, q, x) in enumerate(zip(dimensions, drives, poses, strict=True)):
        motion = Motion(text, one, q, x, qd[row], qdd[row])
        rubbed = Rubbed(motion, Motion(text, one, q, x, qd[row]), GRAVITY, f[row][:2])
        bodies = Bodies(motion, GRAVITY, f[row][:2], rubbed.loads)
        wanted = rubbed.given.copy()
        wanted[: len(bodies.ends)] += bodies.reactions
        scale = np.abs(bodies.unknowns).max()
        assert np.abs(reactions[row] - wanted).max() < 1e-6 * scale
        own = np.array(rubbed.efforts)[rubbed.drives] if any(rubbed.drives) else 0.0
        assert np.abs(forces[row] - bodies.unknowns[bodies.drives] - own).max() < 1e-6 * scale
        assert rubbed.power > 0
    assert code["leg_forward_dynamics"](drives, qd, tau, f, dimensions) == pytest.approx(qdd, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("name", NAMES)
def test_efforts_are_linear_in_what_links_weigh(name, tmp_path):
    code, dimensions, drives, _ = drawn(name, WEIGHED, tmp_path, {})
    random, numbers = np.random.default_rng(4), standard(spec(name, WEIGHED))
    qd, qdd = random.normal(size=(2, *drives.shape))
    tau = code["leg_inverse_dynamics"](drives, qd, qdd, np.zeros(3), dimensions)
    Y = code["leg_regressor"](drives, qd, qdd, dimensions)
    assert np.abs(Y @ numbers - tau).max() < 1e-11 * np.abs(tau).max()
    assert np.abs(tau).min() > 1e-3
