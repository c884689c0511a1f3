"""Soles: corners beside the oracle walk, their compliance beside a frame of beams and the foot's, pressure, ends of the language."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
from dynamic_legs import value, written
from scipy.linalg import block_diag

from mechanisms.elastic_robots import random_stand, soled, stand
from oracles.beam_frame import frame, spread
from oracles.stands import O12_Q
from oracles.walker import Walker, read
from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.model.mechanism import Mechanism
from walkgen.pipeline import mechanism_of
from walkgen.symbolic.compliance import StanceCompliance, foot_compliance, sole_compliance
from walkgen.symbolic.contact import contact_functions
from walkgen.symbolic.robot import RobotFunctions
from walkgen.symbolic.soles import SoleFunctions
from walkgen.symbolic.stance import stance_functions

LENGTH, WIDTH, KN, KT = 0.22, 0.09, 3e5, 2e5
TURNED = f"length = {LENGTH}, width_mm = 90, rpy_deg = [15, -70, 40], kn = {KN}, kt = {KT}"
CHAPTER = "length = 0.2, width = 0.1, rpy_deg = [-90, 0, 90]"
"""Across a shank that runs along x."""


@dataclass(frozen=True)
class Mixed:
    """Four legs of any convention on two platforms and an elastic chain: 0, 1 and 2 (the mirror image of 1) on soles, 3 on its foot."""

    text: str
    mechanism: Mechanism
    walker: Walker

    @cached_property
    def stance(self):
        return {name: lower(build()) for name, build in StanceCompliance(self.mechanism).functions().items()}

    def q(self, seed):
        return np.random.default_rng(seed).uniform(-1, 1, self.walker.joint_count)

    def pads(self, q):
        """How far each contact point's pad yields [k,3,3]; zeros for the foot."""
        for leg in self.walker.legs:
            own, R = q[self.walker.slice(leg.name)], self.walker.platform_pose(leg.platform, q)[:3, :3]
            yield from ([np.zeros((3, 3))] if leg.sole is None else [pad(R @ leg.sole_normal(own))] * 4)


def pad(n):
    return np.outer(n, n) / KN + (np.eye(3) - np.outer(n, n)) / KT


def leg_programs(mechanism, index, *names):
    leg = mechanism.legs[index]
    builders = SoleFunctions(mechanism, leg).functions()
    builders |= {
        "foot_compliance": lambda: foot_compliance(mechanism, leg),
        "sole_compliance": lambda: sole_compliance(mechanism, leg),
    }
    found = {name: build() for name, build in builders.items() if name in (names or builders)}
    return {name: lower(function) for name, function in found.items() if function is not None}


def close(found, expected, rtol=1e-9):
    np.testing.assert_allclose(found, expected, rtol=0, atol=rtol * np.max(np.abs(expected)))


@pytest.fixture(scope="module", params=[15, *(pytest.param(seed, marks=pytest.mark.nightly) for seed in (12, 21))])
def mixed(request, tmp_path_factory):
    """Legs 0 and 1 are classic and craig; in the nightly ones classic and by origins, by origins and craig."""
    text = soled(random_stand(np.random.default_rng(request.param), 4, platforms=2), TURNED, "design0", "design1")
    return Mixed(text, mechanism_of(written(tmp_path_factory.mktemp("mixed"), text)), read(text))


def test_points_and_normals_are_those_of_the_walk(mixed):
    """Mirrored legs, too; in the legs' own platform's frame and in the first one's."""
    walker, q = mixed.walker, mixed.q(0)
    for index, leg in enumerate(walker.legs[:3]):
        own, programs = q[walker.slice(leg.name)], leg_programs(mixed.mechanism, index, "sole_points", "sole_normal")
        corners, pose = value(programs["sole_points"], own), leg.pose(own)
        close(corners, leg.contacts(own), 1e-13)
        close(corners.mean(axis=0), pose[:3, 3], 1e-13)
        sides = np.roll(corners, -1, axis=0) - corners
        close(np.linalg.norm(sides, axis=1), [LENGTH, WIDTH, LENGTH, WIDTH], 1e-13)
        normal = value(programs["sole_normal"], own)
        close(normal, leg.sole_normal(own), 1e-13)
        close(np.cross(-sides[0], -sides[1]) / (LENGTH * WIDTH), normal, 1e-12)
    functions = RobotFunctions(mixed.mechanism).functions()
    close(value(lower(functions["contact_points"]()), q), walker.contact_points(q), 1e-13)
    turns = [walker.platform_pose(leg.platform, q)[:3, :3] for leg in walker.legs[:3]]
    soles = [turn @ leg.sole_normal(q[walker.slice(leg.name)]) for turn, leg in zip(turns, walker.legs[:3], strict=True)]
    ground = [0.0, 0.6, 0.8]  # under the foot without a sole
    found = interpret(lower(functions["contact_normals"]()), {"q": list(q), "ground": ground})["n"]
    close(np.reshape(found, (-1, 3)), [*np.repeat(soles, 4, axis=0), ground], 1e-13)


def test_a_mirrored_sole_has_its_left_on_the_left(tmp_path):
    """The corner (+,-) of a mirrored sole is the image of (+,+)."""
    text = soled(stand(), CHAPTER, "chapter").replace(
        '[[legs]]\nname = "front_right"', '[[legs]]\nname = "image"\nmirror_of = "front_left"\n[[legs]]\nname = "front_right"'
    )
    mechanism = mechanism_of(written(tmp_path, text))
    left, right = (value(leg_programs(mechanism, index)["sole_points"], O12_Q) for index in (0, 1))
    np.testing.assert_allclose(right, left[::-1] * [1, -1, 1], rtol=0, atol=1e-15)


def test_compliance_is_that_of_a_frame_of_beams(mixed):
    """Corners of one leg, of legs that share an elastic chain, and points among them, all coupled; rigid soles have six ways to move."""
    q = mixed.q(1)
    C = value(mixed.stance["stance_compliance"], q)
    assert C.shape == (39, 39)
    assert (C == C.T).all()
    close(C, frame(mixed.text, q).compliance() + block_diag(*mixed.pads(q)))
    own = value(leg_programs(mixed.mechanism, 0, "sole_compliance")["sole_compliance"], q[mixed.walker.slice("leg0")])
    close(own, C[:12, :12], 1e-12)  # leg 0 sits on the first platform


def test_equal_forces_move_the_foot_as_one_force_there(mixed):
    """But for the pads, of which four are under the sole."""
    leg, q = mixed.walker.legs[2], mixed.q(2)[mixed.walker.slice("leg2")]
    programs = leg_programs(mixed.mechanism, 2, "sole_compliance", "foot_compliance")
    corners, foot = value(programs["sole_compliance"], q).reshape(4, 3, 4, 3), value(programs["foot_compliance"], q)
    close(corners.mean(axis=(0, 2)), foot + pad(leg.sole_normal(q)) / 4, 1e-12)


def test_pads_lie_in_series_under_every_corner(tmp_path):
    text = soled(stand(), f"{CHAPTER}, kn = {KN}, kt = {KT}", "chapter")
    bare, soft = (mechanism_of(written(tmp_path, part)) for part in (soled(stand(), CHAPTER, "chapter"), text))
    programs = [leg_programs(mechanism, 0) for mechanism in (bare, soft)]
    C, padded = (value(part["sole_compliance"], O12_Q) for part in programs)
    assert np.linalg.matrix_rank(C, tol=1e-12 * np.max(C)) == 6  # of a rigid sole
    close(padded, C + np.kron(np.eye(4), pad(value(programs[0]["sole_normal"], O12_Q))), 1e-12)
    assert np.linalg.eigvalsh(padded)[0] > 0.9 / KN


def test_a_pad_that_gives_along_its_normal_alone(tmp_path):
    mechanism = mechanism_of(written(tmp_path, soled(stand(), f"{CHAPTER}, kn = {KN}", "chapter")))
    bare = mechanism_of(written(tmp_path, soled(stand(), CHAPTER, "chapter")))
    programs = leg_programs(mechanism, 0)
    more = value(programs["sole_compliance"], O12_Q) - value(leg_programs(bare, 0)["sole_compliance"], O12_Q)
    n = value(programs["sole_normal"], O12_Q)
    np.testing.assert_allclose(more, np.kron(np.eye(4), np.outer(n, n) / KN), rtol=0, atol=1e-15)


def test_loads_on_platforms_spread_over_corners(mixed):
    """The misfit of every contact point: pads are the springs of the frame of beams, the foot stands on one of its own."""
    q, loads = mixed.q(3), 100.0 * np.random.default_rng(3).normal(size=(2, 6))
    C, e = value(mixed.stance["stance_compliance"], q), value(mixed.stance["load_misfit"], q, loads)
    C[-3:, -3:] += np.eye(3) / KN
    pads = [*[*mixed.pads(q)][:-1], np.eye(3) / KN]
    f, delta = spread(mixed.walker.contact_points(q), C, loads.sum(axis=0), e)
    forces, displacement = frame(mixed.text, q).forces(dict(zip(mixed.walker.platforms, loads, strict=True)), np.linalg.inv(pads))
    np.testing.assert_allclose(forces, f, rtol=0, atol=1e-9)
    np.testing.assert_allclose(displacement, delta, rtol=1e-9, atol=1e-12)


def test_pressure_has_its_centre_where_the_forces_act(mixed):
    program, rng = leg_programs(mixed.mechanism, 1, "ground_pressure")["ground_pressure"], np.random.default_rng(4)
    normal = np.linalg.qr(rng.normal(size=(3, 3)))[0][0]
    f = rng.normal(size=(4, 3)) + 5.0 * normal
    found = interpret(program, {"f": list(f.ravel()), "normal": list(normal)})
    N = f @ normal
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [LENGTH / 2, WIDTH / 2]
    assert found["pressure"][0] == pytest.approx(N.sum() / (LENGTH * WIDTH), rel=1e-13)
    np.testing.assert_allclose(found["centre"], N @ corners / N.sum(), rtol=1e-12, atol=1e-16)


def test_sizes_may_be_runtime_parameters(tmp_path):
    head = '[parameters]\nshoe = { value = 0.3, runtime = true, unit = "m" }\npad = { value = 1e5, runtime = true, unit = "N/m" }\n'
    sole = 'length = "shoe", width = "shoe/2", rpy_deg = [-90, 0, 90], kn = "pad", kt = "pad/2"'
    text = soled(stand(), sole, "chapter").replace("[leg_designs", head + "[leg_designs", 1)
    fixed = soled(stand(), f"{CHAPTER}, kn = {KN}, kt = {KN / 2}", "chapter")
    given, plain = (leg_programs(mechanism_of(written(tmp_path, part)), 0) for part in (text, fixed))
    for name in ("sole_points", "sole_normal", "sole_compliance"):
        close(value(given[name], O12_Q, [0.2, KN]), value(plain[name], O12_Q), 1e-13)
    forces = {"f": [0.0, 0.0, 6.0] * 4, "normal": [0.0, 0.0, 1.0]}
    assert interpret(given["ground_pressure"], forces | {"param": [0.2, KN]})["pressure"] == pytest.approx([24.0 / 0.02])


def test_a_legs_own_sole_goes_before_its_designs(tmp_path):
    text = soled(stand(), CHAPTER, "chapter").replace(
        'name = "front_right"', 'name = "front_right"\nsole = { length = 0.1, width = 0.1, rpy_deg = [0, -90, 0] }'
    )
    mechanism = mechanism_of(written(tmp_path, text))
    corners = value(leg_programs(mechanism, 1)["sole_points"], O12_Q)
    close(corners, read(text).legs[1].contacts(O12_Q), 1e-13)
    assert np.linalg.norm(corners[0] - corners[1]) == pytest.approx(0.1)


def test_one_leg_on_a_sole_shares_its_load(tmp_path):
    text = random_stand(np.random.default_rng(5), 1)
    bare, soft = (mechanism_of(written(tmp_path, part)) for part in (text, soled(text, CHAPTER, "design0")))
    assert not {**contact_functions(bare), **stance_functions(bare)}
    assert {"contact_forces", "grasp_map"} <= {**contact_functions(soft), **stance_functions(soft)}.keys()


def test_without_a_sole_there_is_none(tmp_path):
    bare = mechanism_of(written(tmp_path, stand()))
    assert set(leg_programs(bare, 0)) == {"foot_compliance"}
    assert not {"contact_points", "contact_normals"} & set(RobotFunctions(bare).functions())
    rigid = mechanism_of(written(tmp_path, soled(stand(), CHAPTER, "chapter").replace(', link = { section = "middle" }', "")))
    assert set(leg_programs(rigid, 0)) == {"sole_points", "sole_normal", "ground_pressure"}
    assert {"contact_points", "contact_normals"} <= set(RobotFunctions(rigid).functions())
