"""How far the ground yields: the formula, rigid patches, and an elastic robot's feet on it beside a hand-made compliance."""

import numpy as np
import pytest

from mechanisms.elastic_robots import stand
from oracles.stands import O13_Q, O13_WRENCH
from terrain.grounds import explicit, spec

KN, KT = 2.0e5, 1.5e5
PATCHES = (
    explicit("0.2*x*y", f"kn = {KN}\nkt = {KT}\nmu = 0.6\ndomain = {{ x = [0, 1], y = [-1, 1] }}"),
    explicit("0.1*x**2", f"kn = {KN}\ndomain = {{ x = [-1, 0], y = [-1, 1] }}"),
    'surface = "implicit"\nf = "(x - 3)**2 + y**2 + z**2 - 1"\nkt = "soft"\ndomain = { x = [2, 4], y = [-1, 1] }',
    'surface = "plane"\npoint = [0, 5, 0]\nnormal = [0, 0, 1]\ndomain = { x = [-1, 1], y = [4, 6] }',
)
PARAMETERS = 'soft = { value = 1e4, unit = "N/m", runtime = true }'
POINTS = np.array([[0.5, 0.4, 0.3], [-0.5, 0.2, 0.0], [3.2, -0.3, 1.0], [0.1, 5.2, 0.0], [9.0, 9.0, 0.0]])


def formula(n, kn, kt):
    along = n[..., :, None] * n[..., None, :]
    return along / np.asarray(kn)[..., None, None] + (np.eye(3) - along) / np.asarray(kt)[..., None, None]


@pytest.fixture(scope="module")
def ground(built):
    return built(spec(*PATCHES, parameters=PARAMETERS, functions=("normal", "ground", "compliance"), casadi=True))


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_the_formula(ground, backend):
    terrain = getattr(ground, backend).terrain
    found = terrain.compliance(POINTS)
    expected = formula(terrain.normal(POINTS[:4]), [KN, KN, np.inf, np.inf], [KT, np.inf, 1e4, np.inf])
    np.testing.assert_allclose(found[:4], expected, rtol=1e-14)
    assert np.isnan(found[4]).all()
    assert not found[3].any()
    _, kn, kt = terrain.ground(POINTS)
    np.testing.assert_allclose(found[:4], formula(terrain.normal(POINTS[:4]), kn[:4], kt[:4]), rtol=1e-14)
    np.testing.assert_allclose(terrain.compliance(POINTS[2], param=[1e3]), 10 * found[2], rtol=1e-14)


def test_casadi_agrees(ground):
    function, terrain = ground.c.casadi("terrain_compliance"), ground.c.terrain
    for point in POINTS:
        np.testing.assert_allclose(np.array(function(point, [1e4])), terrain.compliance(point), rtol=1e-12, atol=1e-20)


def test_elastic_legs_on_ground_that_yields(built):
    """Legs and ground in series, the robot turned in the world: as with a compliance made by hand in the platform's frame."""
    wanted = '[generate]\nfunctions = ["foot_positions", "stance_compliance", "contact_forces", "contact_forces_stiffness", "compliance"]\n'
    patch = f'[[terrain]]\nname = "soft"\nsurface = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\nkn = {KN}\nkt = {KT}\n'
    robot = built(stand().replace("[sections]", f"{wanted}[sections]") + patch).c
    q = np.ravel(O13_Q)
    points, whole = robot.foot_positions(q), robot.stance_compliance(q)
    legs = np.stack([whole[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] for i in range(4)])
    by_hand = legs + np.diag([1 / KT, 1 / KT, 1 / KN])
    expected, *_ = robot.contact_forces(points, [0, 0, 1], 5.0, O13_WRENCH, method="stiffness", compliance=by_hand)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    series = turn @ legs @ turn.T + robot.terrain.compliance(points @ turn.T)
    load = np.concatenate([turn @ O13_WRENCH[:3], turn @ O13_WRENCH[3:]])
    f, status, *_ = robot.contact_forces(points @ turn.T, [0, 0, 1], 5.0, load, method="stiffness", compliance=series)
    assert status == 0
    np.testing.assert_allclose(f @ turn, expected, rtol=0, atol=1e-9)
    rigid, *_ = robot.contact_forces(points, [0, 0, 1], 5.0, O13_WRENCH, method="stiffness", compliance=legs)
    assert np.abs(rigid - expected).max() > 1e-2
