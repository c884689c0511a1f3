"""From the foot to the drives of legs with joints after their linkage: all branches, or what a search finds; in C, CasADi and NumPy."""

import numpy as np
import pytest

from linkages.chained import with_joints
from linkages.placed import code_of
from linkages.topologies import TOPOLOGIES, spec
from walkgen.model.classify import inverse_class
from walkgen.pipeline import mechanism_of

FUNCTIONS = ("foot_position", "foot_jacobian", "assembly_status", "inverse", "inverse_branch", "inverse_distance", "inverse_near")
OK, UNREACHABLE, BAD_INPUT, NO_CONVERGENCE, INFEASIBLE = 0, 1, 2, 4, 5
LEGS = {
    "a slide after five bars": ("five_bar", "P", [0.3, 0.1, 0.5, 0.55, 0.7, 0.65, 0.4, 0.2]),
    "a turn after five bars": ("five_bar", "R", [0.3, 0.1, 0.5, 0.55, 0.7, 0.65, 0.4, 0.2]),
    "a turn after cylinders": ("hydraulic", "R", None),
}
BUILT = (
    "foot_pose",
    "foot_jacobian",
    "inverse_near",
    "inverse_pose",
    "inverse_admissible",
    "inverse_velocity",
    "inverse_dynamics",
    "joint_reactions",
)


def text_of(topology, before, after, functions, values=None):
    topology_text = spec(topology, functions, values=values).replace("runtime = true", "runtime = false")
    return with_joints(topology_text, before, after).replace('targets = ["numpy"]', 'targets = ["c", "casadi", "numpy"]')


def turns_off(name, away):
    """Differences of turning q within half a turn."""
    topology, after, _ = LEGS[name]
    turning = [*([True, True] if topology == "five_bar" else [False, False]), after == "R"]
    return np.where(turning, np.angle(np.exp(1j * away)), away)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", LEGS)
def test_all_branches(tmp_path, name):
    topology, after, values = LEGS[name]
    code = code_of(text_of(topology, "", after, FUNCTIONS, values), FUNCTIONS, tmp_path)
    random = np.random.default_rng(3)
    q = np.concatenate([TOPOLOGIES[topology].draw(random, 600)[1], random.uniform(-1, 1, (600, 1))], -1)
    q = q[code["leg_assembly_status"](q) == OK]
    assert len(q) > 60
    p = code["leg_foot_position"](q)
    rows, status = code["leg_inverse"](p)
    assert rows.shape[1] == (2 if after == "R" else 1) * (2 if topology == "hydraulic" else 4)
    assert set(np.unique(status)) <= {OK, UNREACHABLE, INFEASIBLE}
    distance = np.linalg.norm(code["leg_foot_position"](rows) - p[:, None], axis=-1)
    size = 1 + np.linalg.norm(code["leg_foot_jacobian"](rows), axis=(-2, -1))
    assert (distance / size)[status == OK].max() < 1e-14
    assert not (distance[status != OK] < 1e-9).any()  # with the spec's sides they lie elsewhere
    away = np.where(status == OK, np.abs(turns_off(name, rows - q[:, None])).max(-1), np.inf)
    inverse = np.linalg.norm(np.linalg.inv(code["leg_foot_jacobian"](q)), axis=(1, 2))
    assert np.all(away.min(-1) <= 1e-14 * inverse * (1 + np.nanmax(size, -1)))
    assert code["leg_inverse_distance"](p) == pytest.approx(distance, abs=1e-13, nan_ok=True)
    for slot in range(rows.shape[1]):
        one, state = code["leg_inverse_branch"](p, np.full(len(p), slot))
        assert np.array_equal(state, status[:, slot])
        assert one == pytest.approx(rows[:, slot], abs=1e-13)
    near, states = code["leg_inverse_near"](p, q)
    assert (states == OK).all()
    assert np.abs(turns_off(name, near - q)).max(-1) == pytest.approx(away.min(-1), abs=1e-9)
    assert (code["leg_inverse"](100 * np.ones(3))[1] == UNREACHABLE).all()
    assert (code["leg_inverse"]([np.nan, 0, 0])[1] == 2).all()


def test_why_there_are_no_branches(tmp_path):
    for topology, before, after, turn, reason in (
        ("five_bar", "R", "R", "20, 70, 0", "one after it and none before"),
        ("five_bar", "", "R", "0, 0, 40", "after_0 moves the foot along the linkage's plane alone"),
        ("five_bar", "", "P", "90, 0, 0", "after_0 moves the foot along the linkage's plane alone"),
        ("four_bar", "", "R", "20, 70, 0", "1 drives do not place the foot in the plane"),
    ):
        path = tmp_path / "spec.toml"
        path.write_text(
            with_joints(spec(topology, ()).replace("functions = []", 'functions = "all"'), before, after, turn), encoding="utf-8"
        )
        mechanism = mechanism_of(path)
        found = inverse_class(mechanism, mechanism.legs[0])
        assert not found.name
        assert reason in found.reason


@pytest.fixture(scope="module")
def robots(built):
    """One leg of five q, three drives too many for branches, in C and NumPy."""
    robot = built(text_of("hydraulic", "R", "RP", BUILT))
    return robot, [(each, each.legs["leg"]) for each in (robot.c, robot.numpy)]


def assembled(leg, count):
    random = np.random.default_rng(4)
    q = np.concatenate([random.uniform(-1, 1, (400, 1)), TOPOLOGIES["hydraulic"].draw(random, 400)[1], random.uniform(-1, 1, (400, 2))], -1)
    return q[np.isfinite(leg.foot_pose(q)).all((1, 2))][:count]


def test_the_nearest_by_a_search(robots):
    (_, (_, leg), (_, peer)) = robots[0], *robots[1]
    q = assembled(leg, 8)
    target = leg.foot_pose(q)[:, :3, 3]
    seed = q + 0.05
    found, status = leg.inverse_near(target, seed)
    assert (status == OK).all()
    assert leg.foot_pose(found)[:, :3, 3] == pytest.approx(target, abs=1e-10)
    assert np.abs(found - seed).max() < 0.5
    other, states = peer.inverse_near(target, seed)
    assert np.array_equal(status, states)
    assert peer.foot_pose(other)[:, :3, 3] == pytest.approx(target, abs=1e-10)
    best, fits = leg.inverse_admissible(target)
    assert leg.foot_pose(best[fits == OK])[:, :3, 3] == pytest.approx(target[fits == OK], abs=1e-10)
    v = np.full((8, 3), 0.1)
    rates, done = leg.inverse_velocity(q, v)
    assert np.einsum("kij,kj->ki", leg.foot_jacobian(q), rates)[done == OK] == pytest.approx(v[done == OK], abs=1e-12)


def test_one_function_in_three_ways(robots):
    robot, ((_, leg), (_, peer)) = robots
    random, q = np.random.default_rng(6), assembled(leg, 3)
    given = {"q": q, "qd": random.uniform(-1, 1, q.shape), "qdd": random.uniform(-1, 1, q.shape), "f": random.uniform(-9, 9, (3, 3))}
    for name, inputs in {"foot_pose": "q", "foot_jacobian": "q", "inverse_dynamics": "q qd qdd f", "joint_reactions": "q qd qdd f"}.items():
        arguments = [given[key] for key in inputs.split()]
        wanted = getattr(leg, name)(*arguments)
        assert getattr(peer, name)(*arguments) == pytest.approx(wanted, abs=1e-10 * (1 + np.abs(wanted).max()))
        casadi = robot.c.casadi(f"hydraulic_leg_{name}")
        for index in range(3):
            own = np.array(casadi(*(each[index] for each in arguments)))
            assert own.reshape(wanted[index].shape) == pytest.approx(wanted[index], abs=1e-10 * (1 + np.abs(wanted).max()))
    near = robot.c.casadi("hydraulic_leg_inverse_near")
    target = leg.foot_pose(q)[:, :3, 3]
    found, status = near(target[0], q[0] + 0.01)
    assert float(status) == OK
    assert leg.foot_pose(np.array(found).ravel())[:3, 3] == pytest.approx(target[0], abs=1e-9)


def test_a_pose_from_a_seed(robots):
    """Five q keep a pose that they had; far off nothing does."""
    robot, pair = robots
    q = assembled(pair[0][1], 6)
    T = pair[0][1].foot_pose(q)
    for _, leg in pair:
        found, status = leg.inverse_pose(T, q + 0.01)
        assert (status == OK).all()
        assert leg.foot_pose(found) == pytest.approx(T, abs=1e-8)
        assert found == pytest.approx(q, abs=1e-6)
        away = T.copy()
        away[:, :3, 3] += 5.0
        assert (leg.inverse_pose(away, q)[1] == NO_CONVERGENCE).all()
        assert (leg.inverse_pose(np.full((4, 4), np.nan), q)[1] == BAD_INPUT).all()
    own, state = robot.c.casadi("hydraulic_leg_inverse_pose")(T[0], q[0] + 0.01)
    assert float(state) == OK
    assert np.array(own).ravel() == pytest.approx(q[0], abs=1e-6)
