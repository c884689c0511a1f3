"""A built robot of elastic links: its functions in C, NumPy and CasADi against the frame of beams, and why others are missing."""

import numpy as np
import pytest

from mechanisms.elastic_robots import module, random_stand
from oracles.beam_frame import frame, spread
from oracles.walker import read
from walkgen.errors import UnsupportedMechanism
from walkgen.pipeline import build
from walkgen.runtime import load
from walkgen.runtime.solves.contact_stiffness import contact_stiffness

WANTED = '[generate]\nfunctions = ["foot_compliance", "stance_compliance", "load_misfit", "chain_reactions", "foot_positions"]\n'
LOAD = 600.0
CONTACTS = (("contact_points", "sole"), ("contact_normals", "sole"))


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("elastic")
    text = module().replace("[sections]", WANTED + "[sections]", 1)
    (folder / "bench.toml").write_text(text)
    build(folder / "bench.toml", folder)
    return text, load(folder / "bench")


def test_loads_on_all_platforms_spread_as_in_a_frame_of_beams(built):
    """The functions' compliance and misfit through the spreading, batched."""
    text, robot = built
    rng, walker = np.random.default_rng(3), read(text)
    q = rng.uniform(-0.5, 0.5, (3, walker.joint_count))
    loads = LOAD * rng.normal(size=(3, 2, 6)) / 4.0
    C, e, points = robot.stance_compliance(q), robot.load_misfit(q, loads), robot.foot_positions(q)
    for row in range(3):
        model = frame(text, q[row])
        forces, _ = model.forces(dict(zip(walker.platforms, loads[row], strict=True)))
        np.testing.assert_allclose(spread(points[row], C[row], loads[row].sum(axis=0), e[row])[0], forces, rtol=0, atol=1e-9)
        normals = forces / np.linalg.norm(forces, axis=1)[:, None]
        found = contact_stiffness(points[row], normals, np.full(3, 0.5), loads[row].sum(axis=0), C[row].reshape(3, 3, 3, 3), e[row])
        np.testing.assert_allclose(found[0], forces, rtol=0, atol=1e-9)


def test_casadi_agrees(built):
    text, robot = built
    q, loads = np.random.default_rng(4).uniform(-0.5, 0.5, read(text).joint_count), np.arange(12.0).reshape(2, 6)
    forces = np.arange(9.0).reshape(3, 3)
    for name, arguments in (("stance_compliance", (q,)), ("load_misfit", (q, loads)), ("chain_reactions", (q, forces, loads))):
        found = np.array(robot.casadi(name)(*arguments))
        np.testing.assert_allclose(found, getattr(robot, name)(*arguments), rtol=1e-11, atol=1e-14)


def test_missing_functions_say_why(tmp_path):
    text = random_stand(np.random.default_rng(5), 1).replace(', link = { section = "middle" }', "")
    (tmp_path / "bench.toml").write_text(text.replace("[sections]", '[generate]\nfunctions = ["foot_position"]\n[sections]', 1))
    build(tmp_path / "bench.toml", tmp_path)
    robot = load(tmp_path / "bench")
    with pytest.raises(UnsupportedMechanism, match="section"):
        _ = robot.legs["leg0"].foot_compliance
    for name in ("sole_points", "sole_normal", "ground_pressure", "sole_compliance"):
        with pytest.raises(UnsupportedMechanism, match="sole"):
            getattr(robot.legs["leg0"], name)
    for name, word in (("stance_compliance", "section"), ("load_misfit", "elastic"), ("chain_reactions", "chains"), *CONTACTS):
        with pytest.raises(UnsupportedMechanism, match=word):
            getattr(robot, name)
