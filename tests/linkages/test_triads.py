"""Triads of random dimensions, drawn before it is known whether they assemble, beside the equations of all links solved by numbers."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from linkages.closure import Closure, apart
from linkages.newton_euler import Bodies, Motion
from linkages.placed import as_unknowns
from linkages.starts import Drawn, by_numbers, moved
from linkages.topologies import TRIADS, spec

FUNCTIONS = (
    "foot_position",
    "foot_jacobian",
    "foot_hessian",
    "assembly_status",
    "transmission_angles",
    "joint_reactions",
    "driving_forces",
    "mass_matrix",
    "kinetic_energy",
)
OK, UNREACHABLE, NO_CONVERGENCE = 0, 1, 4
QUICK = ("stephenson_2",)
NAMES = [pytest.param(name, marks=() if name in QUICK else pytest.mark.nightly) for name in TRIADS]
"""A plate on bars; at night struts with sliders on one end or both, loops of four links, a triad off the frame, three cylinders."""
ASSEMBLED = {
    "stephenson_2": 3,
    "loop_of_four": 5,
    "three_cylinders": 6,
    "plate_on_sliders": 5,
    "cross_slide": 4,
    "cross_slide_loop": 1,
    "two_cranks": 3,
    "hung_triad": 2,
}
"""How many assemble of six random sets."""
STARTS, GRAVITY = 30, (0.7, -9.8)


@dataclass
class Sets:
    """Generated code with the sets that assemble: dimensions, drives, poses of the assembly that is taken."""

    drawn: Drawn
    code: dict[str, Any]
    text: str
    dimensions: np.ndarray
    drives: np.ndarray
    poses: np.ndarray

    def call(self, name, drives, *more):
        return self.code[f"leg_{name}"](drives, *more, self.dimensions)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    done = {}

    def of(name, count=6):
        if (name, count) not in done:
            drawn = Drawn(name, count, 5, tmp_path_factory.mktemp(name))
            code, rows = drawn.code(FUNCTIONS), np.flatnonzero(drawn.closes)
            drawn.started(code, rows, [0] * len(rows))
            dimensions, drives = drawn.dimensions[rows], drawn.drives[rows]
            poses = as_unknowns(code["leg_poses"](drives, dimensions))
            done[name, count] = Sets(drawn, code, spec(name, FUNCTIONS), dimensions, drives, poses)
        return done[name, count]

    return of


@pytest.mark.parametrize("name", NAMES)
def test_all_assemblies(made, name):
    """All that numbers find, in the same poses, and no others that do not close or are the same; loops close to rounding."""
    sets, random = made(name), np.random.default_rng(3)
    drawn = sets.drawn
    assert drawn.closes.sum() == ASSEMBLED[name]
    for row, found in enumerate(drawn.assemblies):
        wanted = by_numbers(sets.text, drawn.topology.sides, drawn.dimensions[row], drawn.drives[row], random, STARTS)
        assert len(found) >= len(wanted)
        if found:
            drawn.started(sets.code, [row] * len(found), range(len(found)))
            many = np.tile(drawn.drives[row], (len(found), 1)), np.tile(drawn.dimensions[row], (len(found), 1))
            own = as_unknowns(sets.code["leg_poses"](*many))
            size = max(1.0, np.abs(own).max())
            closure = Closure(sets.text, many[1], many[0])
            assert np.abs(closure.equations(own)[0]).max() < 1e-14 * size**2
            condition = max(1.0, np.linalg.cond(closure.equations(own)[1]).max() / 1e3)
            near = [min(apart(pose, one) for one in own) for pose in wanted]
            assert max(near, default=0) < 1e-12 * size * condition
            assert min((apart(one, own[other]) for other in range(len(own)) for one in own[:other]), default=1) > 1e-6


@pytest.mark.parametrize("name", NAMES)
def test_drives_move_to_where_slow_ones_get(made, name):
    """The assembly that is continuous from the start, or none where a dead point lies on the way."""
    sets, random = made(name), np.random.default_rng(4)
    rows = np.flatnonzero(sets.drawn.closes)
    sets.drawn.started(sets.code, rows, [0] * len(rows))
    far = np.array([np.pi if joint == "R" else 0.4 for joint in _kinds(name)])
    end = sets.drives + far * random.uniform(-1, 1, sets.drives.shape)
    wanted, there = moved(sets.text, sets.dimensions, sets.poses, sets.drives, end, 250 if name in QUICK else 500)
    status, own = sets.call("assembly_status", end), as_unknowns(sets.call("poses", end))
    assert set(status) <= {OK, UNREACHABLE, NO_CONVERGENCE}
    assert np.array_equal(status == OK, there)
    assert np.array_equal(np.isfinite(own).all(-1), there)
    assert np.all(apart(own[there], wanted[there]) < 1e-11)
    turned = sets.call("poses", end + np.where(far > 3, 2 * np.pi, 0))
    assert as_unknowns(turned)[there] == pytest.approx(own[there], abs=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_slopes_and_curvatures(made, name):
    sets, step = made(name), 1e-4
    rows = np.flatnonzero(sets.drawn.closes)
    sets.drawn.started(sets.code, rows, [0] * len(rows))
    away = np.abs(np.sin(sets.call("transmission_angles", sets.drives))).min(-1) > 0.2
    J, H = sets.call("foot_jacobian", sets.drives), sets.call("foot_hessian", sets.drives)
    for drive in range(sets.drives.shape[1]):
        e = step * np.eye(sets.drives.shape[1])[drive]
        position, slope = (
            sum(w * sets.call(function, sets.drives + k * e) for k, w in ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))) / step
            for function in ("foot_position", "foot_jacobian")
        )
        assert J[away][..., drive] == pytest.approx(position[away], rel=1e-6, abs=1e-6)
        assert H[away][..., drive] == pytest.approx(slope[away], rel=1e-5, abs=1e-5)
    assert away.any()


@pytest.mark.parametrize("name", NAMES)
def test_free_bodies(made, name):
    """Reactions beside a dense solution of all links' equations of motion, the drives' efforts beside it and virtual work."""
    sets, random = made(name), np.random.default_rng(22)
    rows = np.flatnonzero(sets.drawn.closes)
    sets.drawn.started(sets.code, rows, [0] * len(rows))
    away = np.abs(np.sin(sets.call("transmission_angles", sets.drives))).min(-1) > 0.2
    rates, seconds = random.normal(size=sets.drives.shape) / 5, random.normal(size=sets.drives.shape)
    load = random.normal(size=(len(rows), 3)) * 100
    reactions = sets.call("joint_reactions", sets.drives, rates, seconds, load)
    forces = sets.call("driving_forces", sets.drives, rates, seconds, load)
    for row in np.flatnonzero(away):
        moving = Motion(sets.text, sets.dimensions[row], sets.drives[row], sets.poses[row], rates[row], seconds[row])
        bodies = Bodies(moving, GRAVITY, load[row][:2])
        scale = np.abs(bodies.unknowns).max()
        assert bodies.rank == len(bodies.unknowns)
        assert np.abs(reactions[row] - bodies.reactions).max() < 1e-6 * scale
        assert np.abs(bodies.sums(reactions[row])).max() < 1e-6 * scale
        pins = [number for number, kind in enumerate(_kinds(name)) if kind == "R"]
        moments = bodies.reactions[:, 2]
        for number in pins:
            assert np.abs(np.abs(moments) - abs(forces[row][number])).min() < 1e-6 * scale
    assert away.any()


@pytest.mark.parametrize("name", NAMES)
def test_mass_is_twice_the_energy(made, name):
    sets, random = made(name), np.random.default_rng(6)
    rates = random.normal(size=sets.drives.shape)
    energy, mass = sets.call("kinetic_energy", sets.drives, rates), sets.call("mass_matrix", sets.drives)
    assert np.einsum("ni,nij,nj->n", rates, mass, rates) / 2 == pytest.approx(energy, rel=1e-9)
    assert np.linalg.eigvalsh(mass).min() > 0


def _kinds(name):
    """Of the drives, in the order of q."""
    topology = TRIADS[name]
    return "R" * topology.pins.count("*") + "P" * (topology.sliders + topology.cylinders).count("*")
