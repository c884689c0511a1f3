"""A joint that turns a linkage's plane, or the foot out of it: where its two ways are one, and where it turns in vain."""

import numpy as np
import pytest

from linkages.placed import code_of

FUNCTIONS = ("foot_position", "assembly_status", "inverse", "inverse_branch", "inverse_near", "inverse_distance")
OFFSET = 0.04
"""Of the plane from the yaw axis, and of the foot from the ankle's."""
SPEC = """
walkgen = 1
robot = {{ name = "bot", gravity = [0, 0, -9.81] }}
platforms = [{{ name = "body" }}]
legs = [{{ name = "leg", design = "leg", platform = "body" }}]
generate = {{ functions = {functions}, targets = ["numpy"] }}
[leg_designs.leg]
five_bar = {{ ground = 0.1, cranks = [0.3, 0.3], couplers = [0.4, 0.4] }}
dh = "classic"
{joint}"""
YAW = f"""plane = {{ xyz = [0.0, {OFFSET}, 0.0], rpy_deg = [90, 0, 0] }}
joints = [{{ name = "yaw", type = "revolute", a = 0, d = 0, alpha_deg = 0 }}]
"""
ANKLE = f"""linkage_end = {{ rpy_deg = [90, 0, 0] }}
foot = {{ xyz = [0.0, 0.0, -0.05] }}
joints_after = [{{ name = "ankle", type = "revolute", a = {OFFSET}, d = 0, alpha_deg = 0 }}]
"""
OK, UNREACHABLE, SINGULAR, INFEASIBLE, DUPLICATE = 0, 1, 3, 5, 6


def code(joint, folder):
    return code_of(SPEC.format(functions=list(FUNCTIONS), joint=joint), FUNCTIONS, folder)


def on_the_edge(beyond):
    """Targets as far from the yaw axis as the plane is, or as far from the plane as the ankle brings the foot, and a bit less, or more."""
    angle, height = np.meshgrid(np.linspace(-3, 3, 7), np.linspace(-0.6, -0.3, 5))
    near = OFFSET * (1 - beyond)
    around = np.stack([near * np.cos(angle), near * np.sin(angle), height], -1).reshape(-1, 3)
    aside = np.stack([angle / 15, height, np.full_like(angle, OFFSET * (1 + beyond))], -1).reshape(-1, 3)
    return {YAW: around, ANKLE: np.concatenate([aside, aside * [1, 1, -1]])}


@pytest.mark.parametrize("joint", [YAW, ANKLE], ids=["before", "after"])
def test_two_ways_that_are_one(tmp_path, joint):
    leg = code(joint, tmp_path)
    target = on_the_edge(1e-13)[joint]
    rows, status = leg["leg_inverse"](target)
    (first, second), (states, others) = (np.split(each, 2, axis=1) for each in (rows, status))
    assert first == pytest.approx(second, abs=1e-12)
    assert (states == OK).any()
    assert set(np.unique(states)) <= {OK, UNREACHABLE, INFEASIBLE, DUPLICATE}
    assert np.array_equal(others, np.where(states == UNREACHABLE, UNREACHABLE, DUPLICATE))
    distance = np.linalg.norm(leg["leg_foot_position"](rows) - target[:, None], axis=-1)
    assert distance[status == OK].max() < 1e-12
    assert (leg["leg_inverse"](on_the_edge(1e-9)[joint])[1] == UNREACHABLE).all()
    apart = leg["leg_inverse"](on_the_edge(-1e-9)[joint])[1]
    assert np.array_equal(*np.split(apart, 2, axis=1))
    assert (apart == OK).any()


def test_a_target_on_the_axis_of_a_plane_beside_it(tmp_path):
    """No turn brings the plane there: the closest point of it is as far away as the plane."""
    leg, target = code(YAW, tmp_path), np.stack([np.zeros(9), np.zeros(9), np.linspace(-0.6, -0.3, 9)], -1)
    rows, status = leg["leg_inverse"](target)
    assert (status == UNREACHABLE).all()
    assert np.nanmin(leg["leg_inverse_distance"](target), -1) == pytest.approx(np.full(9, OFFSET), abs=1e-12)
    assert (leg["leg_inverse_near"](target, rows[:, 0])[1] == UNREACHABLE).all()


def test_a_target_on_the_axis_in_the_plane(tmp_path):
    leg = code(YAW.replace(f"{OFFSET}", "0.0"), tmp_path)
    _, status = leg["leg_inverse"]([0.0, 0.0, -0.5])
    assert SINGULAR in status
    assert set(status) <= {SINGULAR, DUPLICATE, UNREACHABLE}
