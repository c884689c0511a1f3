"""Where a linkage's pairs are: links keep the lengths that the spec gives them, sliders their guides; the self-test has its own numbers."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from linkages.theory import BOXES
from walkgen import selftest
from walkgen.model.assemble import assemble
from walkgen.model.walk import defaults
from walkgen.pipeline import BuildOptions, build
from walkgen.runtime import load
from walkgen.spec.read import read
from walkgen.spec.scalar import evaluate

SPECS = Path(__file__).parents[2] / "specs"
FUNCTIONS = ("pair_positions", "foot_position", "joint_frames")


@pytest.fixture(scope="module", params=["odex", *(pytest.param(name, marks=pytest.mark.nightly) for name in ("garrec", "bessonov"))])
def case(request, tmp_path_factory):
    path, folder = SPECS / f"{request.param}.toml", tmp_path_factory.mktemp(request.param)
    robot = load(build(path, folder, BuildOptions(targets=("c", "numpy"), functions=FUNCTIONS)).folder)
    return assemble(read(path), SPECS), robot, BOXES[request.param]


def test_links_are_as_long_as_the_spec_says(case):
    """Of all pins of a link that is no bar of a driven cylinder; such a bar is as long as its q."""
    mechanism, robot, box = case
    linkage, values = mechanism.legs[0].linkage, defaults(mechanism)
    leg = next(iter(robot.legs.values()))
    drives = np.random.default_rng(1).uniform(*box, (20, len(box[0])))
    q = np.column_stack([np.full(20, 0.3), drives])
    points = leg.pair_positions(q)
    pairs = linkage.structure.pairs
    assert points.shape == (20, len(pairs) + 1, 3)
    np.testing.assert_allclose(points[:, -1], leg.foot_position(q), rtol=0, atol=1e-14)
    own = {body: {} for body in range(len(linkage.structure.names))}
    for number, (pair, ends) in enumerate(zip(pairs, linkage.points, strict=True)):
        if pair.kind == "R":
            for body, end in zip(pair.bodies, ends, strict=True):
                own[body][number] = None if end is None else [float(evaluate(entry, np_numbers, values)) for entry in end]
    checked = 0
    for body, places in own.items():
        for here, there in combinations(places, 2):
            if places[here] is not None and places[there] is not None:
                length = np.hypot(*np.subtract(places[here], places[there]))
                np.testing.assert_allclose(np.linalg.norm(points[:, here] - points[:, there], axis=-1), length, rtol=0, atol=1e-14)
                checked += 1
            else:
                away = np.linalg.norm(points[:, here] - points[:, there], axis=-1)
                assert min(np.abs(away - drive).max() for drive in drives.T) < 1e-14, body
                checked += 1
    assert checked >= 8


class np_numbers:  # noqa: N801 (stands for a module)
    mpf = float
    pi = np.pi
    sqrt, sin, cos = np.sqrt, np.sin, np.cos


def test_all_pairs_lie_in_the_legs_plane(case):
    _, robot, box = case
    leg = next(iter(robot.legs.values()))
    q = np.array([0.4, *np.mean(box, axis=0)])
    points = leg.pair_positions(q)
    _, singular, _ = np.linalg.svd(points - points.mean(axis=0))
    assert singular[2] < 1e-13
    assert singular[1] > 0.1


def test_the_self_test_knows_them(case):
    assert selftest.run(case[1].folder) == 0
