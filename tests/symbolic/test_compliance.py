"""Compliance of locked legs and chains: the theory's stands, an own finite-element model for random robots, statics of chains."""

import re
import tomllib

import numpy as np
import pytest
import sympy
from dynamic_legs import value, written

from mechanisms.elastic_robots import HEAD, random_stand, stand
from oracles.beam_frame import beam_axes, frame, grasp, segments, spread
from oracles.stands import (
    O12_AXIAL,
    O12_FOOT,
    O12_PLAIN,
    O12_Q,
    O13_DELTA,
    O13_F,
    O13_Q,
    O13_WRENCH,
    O14_F,
    O14_PLAIN,
    O14_Q,
    O14_WRENCH,
    symmetric,
)
from oracles.walker import read
from walkgen.graph.lower import lower
from walkgen.pipeline import mechanism_of
from walkgen.symbolic.chain_reactions import chain_reactions
from walkgen.symbolic.compliance import StanceCompliance, foot_compliance

LOAD = 588.6


def leg_program(folder, text, index=0):
    mechanism = mechanism_of(written(folder, text))
    return lower(foot_compliance(mechanism, mechanism.legs[index]))


def robot_programs(folder, text):
    mechanism = mechanism_of(written(folder, text))
    found = StanceCompliance(mechanism).functions()
    return {name: lower(build()) for name, build in found.items()}


def stretchless(text):
    return re.sub(r"A = [0-9e.-]+", "A = 1e9", text)


@pytest.fixture(scope="module")
def chapter(tmp_path_factory):
    folder = tmp_path_factory.mktemp("chapter")
    return tuple(robot_programs(folder, text)["stance_compliance"] for text in (stand(), stretchless(stand())))


@pytest.mark.parametrize(("change", "expected"), [(str, O12_AXIAL), (stretchless, O12_PLAIN)])
def test_o12_leg(tmp_path, change, expected):
    C = value(leg_program(tmp_path, change(stand())), O12_Q)
    np.testing.assert_allclose(C, symmetric(expected), rtol=1e-11, atol=1e-16)


def test_o13_and_o14_stands(chapter):
    """Level walking has tangential forces; a frame of beams and the compliance form agree."""
    walker = read(stand())
    for q, wrench, expected, accuracy in ((O13_Q, O13_WRENCH, O13_F, 1e-11 * LOAD), (O14_Q, O14_WRENCH, O14_F, 1e-6)):
        points = walker.foot_positions(q)
        f, delta = spread(points, value(chapter[0], q), wrench)
        np.testing.assert_allclose(f, expected, rtol=0, atol=accuracy)
        forces, displacement = frame(stand(), q).forces({"base": wrench})
        np.testing.assert_allclose(forces, f, rtol=0, atol=1e-9)
        np.testing.assert_allclose(displacement, delta, rtol=0, atol=1e-13)
        if q is O13_Q:
            np.testing.assert_allclose(points[0], O12_FOOT, rtol=0, atol=1e-15)
            np.testing.assert_allclose(delta, O13_DELTA, rtol=1e-11)
    plain, _ = spread(walker.foot_positions(O14_Q), value(chapter[1], O14_Q), O14_WRENCH)
    np.testing.assert_allclose(np.abs(plain[:, 1]), O14_PLAIN, rtol=0, atol=5e-4)


NIGHTLY = [pytest.param(*case, marks=pytest.mark.nightly) for case in ((4, 1, True), (6, 1, True), (6, 3, True), (6, 3, False))]


@pytest.mark.parametrize(("feet", "platforms", "elastic"), [(3, 1, True), (4, 2, True), *NIGHTLY])
def test_random_robots_are_frames_of_beams(tmp_path, feet, platforms, elastic):
    """Legs of any convention and kind, mirrored ones, chains, loads on every platform, springs under the feet."""
    rng = np.random.default_rng([feet, platforms, elastic])
    text = random_stand(rng, feet, platforms=platforms, elastic=elastic)
    found, walker = robot_programs(tmp_path, text), read(text)
    assert ("load_misfit" in found) == (elastic and platforms > 1)
    q = rng.uniform(-1.0, 1.0, walker.joint_count)
    loads = LOAD * rng.normal(size=(platforms, 6)) / np.sqrt(6 * platforms)
    points, C = walker.foot_positions(q), value(found["stance_compliance"], q)
    e = value(found["load_misfit"], q, loads) if "load_misfit" in found else np.zeros((feet, 3))
    model = frame(text, q)
    named = dict(zip(walker.platforms, loads, strict=True))
    f, delta = spread(points, C, loads.sum(axis=0), e)
    forces, displacement = model.forces(named)
    np.testing.assert_allclose(forces, f, rtol=0, atol=1e-9)
    np.testing.assert_allclose(displacement, delta, rtol=1e-9, atol=1e-12)

    away, off = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(feet)], 1e-3 * rng.normal(size=(feet, 3))
    springs = np.array([Q @ np.diag([2e5, 1.5e5, 1.5e5]) @ Q.T for Q in away])
    soft = C.copy()
    for foot, spring in enumerate(springs):
        soft[3 * foot : 3 * foot + 3, 3 * foot : 3 * foot + 3] += np.linalg.inv(spring)
    f, _ = spread(points, soft, loads.sum(axis=0), e + off)
    forces, _ = model.forces(named, springs, off)
    np.testing.assert_allclose(forces, f, rtol=0, atol=1e-9)


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(3))
def test_a_leg_is_its_block(tmp_path, seed):
    """In its own platform's axes; symmetric and positive."""
    rng = np.random.default_rng(seed)
    text = random_stand(rng, 2, platforms=2, elastic=False)
    mechanism, walker = mechanism_of(written(tmp_path, text)), read(text)
    q = rng.uniform(-1.0, 1.0, walker.joint_count)
    C = value(lower(StanceCompliance(mechanism).stance_compliance()), q)
    for index, leg in enumerate(walker.legs):
        own = value(lower(foot_compliance(mechanism, mechanism.legs[index])), q[walker.slice(leg.name)])
        R = walker.platform_pose(leg.platform, q)[:3, :3]
        np.testing.assert_allclose(C[3 * index : 3 * index + 3, 3 * index : 3 * index + 3], R @ own @ R.T, rtol=1e-9, atol=1e-15)
        assert (own == own.T).all()
        assert np.linalg.eigvalsh(own)[0] > 0.0


def _ram(d: float, alpha: int) -> str:
    rows = f'{{ name = "ram", type = "prismatic", a = 0.0, alpha_deg = {alpha}, d = {d}, link = {{ section = "tube" }} }}'
    section = "[sections]\ntube = { E = 70e9, G = 26e9, A = 2e-4, Iy = 1e-8, Iz = 4e-8, J = 1.5e-8 }\n"
    design = f'[leg_designs.ram]\ndh = "classic"\njoints = [{rows}]\n'
    return f'{HEAD}{section}{design}[[platforms]]\nname = "base"\n[[legs]]\nname = "leg"\ndesign = "ram"\nplatform = "base"\n'


@pytest.mark.parametrize("length", [0.5, 0.0])
def test_a_ram_is_as_soft_as_it_is_long(tmp_path, length):
    """A cantilever: L/EA and L^3/3EI; local z where the link runs along z is the frame's x. Drawn in, it does not yield."""
    C = value(leg_program(tmp_path, _ram(0.2, 0)), [length - 0.2])
    expected = np.diag([length**3 / (3 * 70e9 * 1e-8), length**3 / (3 * 70e9 * 4e-8), length / (70e9 * 2e-4)])
    np.testing.assert_allclose(C, expected, rtol=1e-12, atol=1e-22)


def test_sections_may_be_runtime_parameters(tmp_path):
    text = stand().replace("a = 0.35", 'a = "thigh"').replace("E = 70e9", 'E = "young"')
    head = '[parameters]\nthigh = { value = 0.3, runtime = true, unit = "m" }\nyoung = { value = 50e9, runtime = true, unit = "Pa" }\n'
    program = leg_program(tmp_path, text.replace("[leg_designs", head + "[leg_designs", 1))
    np.testing.assert_allclose(value(program, O12_Q, [0.35, 70e9]), symmetric(O12_AXIAL), rtol=1e-11, atol=1e-16)


def test_without_sections_there_is_none(tmp_path):
    """A link of no length needs none."""
    bare = mechanism_of(written(tmp_path, stand().replace(', link = { section = "middle" }', "")))
    assert foot_compliance(bare, bare.legs[0]) is None
    assert StanceCompliance(bare).functions() == {}
    short = mechanism_of(written(tmp_path, stand().replace("a = 0.08", "a = 0.0").replace(', link = { section = "upper" }', "")))
    assert foot_compliance(short, short.legs[0]) is not None


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.nightly) for seed in (1, 2))])
def test_chains_carry_what_lies_beyond(tmp_path, seed):
    """The part beyond each joint is in equilibrium: by a sum over bodies that the walker places, the moment about the joint's axis."""
    rng = np.random.default_rng(seed)
    text = random_stand(rng, 4, platforms=3)
    program = lower(chain_reactions(mechanism_of(written(tmp_path, text)))["chain_reactions"]())
    walker, table = read(text), tomllib.loads(text)
    q, forces, loads = rng.uniform(-1, 1, walker.joint_count), rng.normal(size=(4, 3)), rng.normal(size=(3, 6))
    found, feet, row = value(program, q, forces, loads), walker.foot_positions(q), 0
    for platform in table["platforms"][1:]:
        chain = walker.chains[platform["name"]]
        beyond = [name for name in walker.platforms if platform["name"] in _up(table, name)]
        total = sum(loads[walker.platforms.index(name)] for name in beyond)
        for leg, force, foot in zip(walker.legs, forces, feet, strict=True):
            if leg.platform in beyond:
                total = total + np.concatenate([force, np.cross(foot, force)])
        design = table["chain_designs"][platform["chain"]]
        links = frame_links(text, chain, design, q, walker)
        for link in links:
            np.testing.assert_allclose(found[row, :3], total[:3], rtol=0, atol=1e-13)
            np.testing.assert_allclose(found[row, 3:], total[3:] - np.cross(link.a, total[:3]), rtol=0, atol=1e-13)
            row += 1
    assert row == len(found)


def frame_links(text, chain, design, q, walker):
    sections = tomllib.loads(text)["sections"]
    base = walker.platform_pose(chain.platform, q)
    return segments(chain, design["joints"], design.get("dh"), q[walker.slice(chain.name)], base, sections)


def _up(table, name):
    """The platform and those that carry it."""
    parents = {platform["name"]: platform.get("parent") for platform in table["platforms"]}
    while name is not None:
        yield name
        name = parents[name]


def force_method(points, C, wrench, kept, loaded=None):
    """The chapter's equations (9): six kept reactions from balance (8), not from (9) (erratum 18), the others X from delta X = -delta_0."""
    G, size = grasp(points), 3 * len(points)
    free = [index for index in range(size) if index not in kept]
    B, f0 = np.zeros((size, len(free))), np.zeros(size)
    B[free, range(len(free))] = 1.0
    B[kept] = -np.linalg.solve(G[:, kept], G[:, free])
    f0[kept] = -np.linalg.solve(G[:, kept], wrench)
    X = np.linalg.solve(B.T @ C @ B, -B.T @ (C if loaded is None else loaded) @ f0)
    return (f0 + B @ X).reshape(-1, 3)


def test_the_force_method_is_the_compliance_form(chapter):
    """With its basic system: foot 1 pinned, two directions of foot 2, one of foot 3; 3 legs are 3-fold, 4 are 6-fold."""
    points, C = read(stand()).foot_positions(O13_Q), value(chapter[0], O13_Q)
    np.testing.assert_allclose(force_method(points, C, O13_WRENCH, [0, 1, 2, 4, 5, 8]), O13_F, rtol=0, atol=1e-9)
    for feet, fold in ((3, 3), (4, 6)):
        assert 3 * feet - np.linalg.matrix_rank(grasp(points[:feet])) == fold


def shared_moment(lower, upper, length):
    """The chapter's rule for the integral of a product of two moments along a link, both given at its ends."""
    (a, b), (c, d) = lower, upper
    return length / 6 * ((a + b) * (c + d) + a * c + b * d)


def chapter_coefficients(points, segments_of, bending="E", pitch_only=False):
    """delta_ij of unit reactions from moments at the links' ends, torsion by GJ, bending by E I (or, as printed, by G I)."""
    size = 3 * len(points)
    delta = np.zeros((size, size))
    for foot, (point, links) in enumerate(zip(points, segments_of, strict=True)):
        own = slice(3 * foot, 3 * foot + 3)
        for link in links:
            s, L = link.section, float(np.linalg.norm(link.b - link.a))
            rigid = (s["G"] * s["J"], s[bending] * s["Iy"], s[bending] * s["Iz"])
            for k, axis in enumerate(beam_axes(link).astype(float)):
                m = np.array([np.cross(axis, point - end) for end in (link.a, link.b)])
                if not pitch_only or k == 1:
                    delta[own, own] += [
                        [shared_moment((m[0][i], m[1][i]), (m[0][j], m[1][j]), L) / rigid[k] for j in range(3)] for i in range(3)
                    ]
    return delta


def test_errata_of_the_force_method(chapter):
    """delta_ij takes m_i m_j (19), bending over E I and not G I (20), delta_i0 all nine terms a leg (21)."""
    walker, model = read(stand()), frame(stand(), O13_Q)
    points = walker.foot_positions(O13_Q)
    links = [[link for _, _, link in model.elements[3 * foot : 3 * foot + 3]] for foot in range(4)]
    plain, kept = value(chapter[1], O13_Q), [0, 1, 2, 4, 5, 8]
    right = chapter_coefficients(points, links)
    np.testing.assert_allclose(right, plain, rtol=0, atol=1e-12 * np.max(plain))
    squares = np.diag(np.diag(right))  # m_i m_i alone
    printed = chapter_coefficients(points, links, bending="G")
    expected = spread(points, plain, O13_WRENCH)[0]
    np.testing.assert_allclose(force_method(points, right, O13_WRENCH, kept), expected, rtol=0, atol=1e-9)
    for wrong in (squares, printed):
        assert np.max(np.abs(force_method(points, wrong, O13_WRENCH, kept) - expected)) > 1.0
    only_y = chapter_coefficients(points, links, pitch_only=True)
    assert np.max(np.abs(force_method(points, right, O13_WRENCH, kept, loaded=only_y) - expected)) > 1.0


def test_the_rule_for_products_is_exact():
    """Of affine moments (22), symbolically."""
    x, L, a, b, c, d = sympy.symbols("x L a b c d")
    product = (a + (b - a) * x / L) * (c + (d - c) * x / L)
    assert sympy.expand(sympy.integrate(product, (x, 0, L)) - shared_moment((a, b), (c, d), L)) == 0
