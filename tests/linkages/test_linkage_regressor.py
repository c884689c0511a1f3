"""Efforts of legs with linkages as linear functions of what their links weigh: all ten numbers of every link, and the fewest that tell."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from linkages.theory import BOXES
from linkages.topologies import TOPOLOGIES, spec
from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.model.assemble import assemble
from walkgen.spec.read import read
from walkgen.symbolic.derive import derive

SPECS = Path(__file__).parents[2] / "specs"
NAMES = ("inverse_dynamics", "regressor", "base_parameters")
DRIVES = BOXES | {"hydraulic_leg": ((0.27, 0.27), (0.36, 0.36)), "minitaur": ((-np.pi, -np.pi), (np.pi, np.pi))}
YAWED = ("odex", "bessonov", "garrec", "hydraulic_leg")
COUNTS = {"hydraulic_leg": 15, "pantograph": 9, "odex": 29, "bessonov": 30, "garrec": 33, "minitaur": 11}
LIGHT = ("hydraulic_leg",)
ACCURACY = 1e-11


def programs(text, folder):
    path = folder / "spec.toml"
    path.write_text(text, encoding="utf-8")
    mechanism = assemble(read(path), folder)
    leg = mechanism.legs[0].name
    found = {function.signature.name: function for function in derive(mechanism, NAMES) if function.signature.owner == leg}
    return {name: lower(function, True) for name, function in found.items()}


def standard(text):
    """Ten numbers a link: of the joints in series (only the frame weighs, on the last of them), then of the linkage's."""
    design = next(iter(tomllib.loads(text)["leg_designs"].values()))
    bodies = {name: [] for name in ("frame", *(name for name in design["links"] if name != "frame"))}
    for name, link in design["links"].items():
        if "mass" in link:
            bodies[name].append((link["mass"], np.array(link.get("com", (0, 0))), link.get("inertia", 0.0)))
    for cylinder in design.get("cylinders", ()):
        for end, key in zip(cylinder["between"], ("at_first", "at_second"), strict=True):
            name, _, point = end.partition(".")
            bodies[name].append((cylinder.get("masses", {}).get(key, 0.0), np.array(design["links"][name]["points"][point]), 0.0))
    rows = [plate(parts) for name, parts in bodies.items() if name != "frame"]
    frame = [on_frame(design, plate(bodies["frame"]))] if design.get("joints") else []
    return np.concatenate([*frame, *rows])


def plate(parts):
    """Mass, first moments and tensor about the origin of a flat plate in the plane z = 0."""
    mass = sum(part[0] for part in parts)
    com = sum((part[0] * part[1] for part in parts), np.zeros(2)) / (mass or 1)
    turning = sum(inertia + weight * np.sum((at - com) ** 2) for weight, at, inertia in parts)
    return ten(mass, np.array([*com, 0]), np.diag([turning / 2, turning / 2, turning]))


def ten(mass, c, about_com):
    J = about_com + mass * (c @ c * np.eye(3) - np.outer(c, c))
    return np.array([mass, *(mass * c), J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]])


def on_frame(design, numbers):
    """The plane's X, Y, Z are x, z, -y of the joint's frame, its origin at `xyz`."""
    mass, first, (xx, yy, zz, xy, xz, yz) = numbers[0], numbers[1:4], numbers[4:]
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    c = first / (mass or 1)
    about_com = turn @ (tensor - mass * (c @ c * np.eye(3) - np.outer(c, c))) @ turn.T
    return ten(mass, turn @ c + np.array(design["plane"].get("xyz", (0, 0, 0))), about_com)


def value(program, states, **more):
    names = [port.name for port in program.signature.inputs]
    inputs = {"f": np.zeros(3), **dict(zip(("q", "qd", "qdd"), states, strict=True)), **more}
    found = interpret(program, {name: inputs[name] for name in names})
    return [np.reshape(found[port.name], port.shape) for port in program.signature.outputs]


def states(random, low, high, count):
    low, high = np.array(low), np.array(high)
    for _ in range(count):
        yield random.uniform(low, high), random.uniform(-2, 2, len(low)), random.uniform(-2, 2, len(low))


def close(one, other):
    return np.abs(one - other).max() <= ACCURACY * max(1, np.abs(other).max())


def rank(matrix):
    """Of the columns scaled alike; rounding does not count as a column."""
    scales = np.linalg.norm(matrix, axis=0)
    felt = scales > 1e-10 * np.max(scales)
    sizes = np.linalg.svd(matrix[:, felt] / scales[felt], compute_uv=False)
    return int(np.sum(sizes > 1e-9 * sizes[0]))


@pytest.mark.parametrize("name", [name if name in LIGHT else pytest.param(name, marks=pytest.mark.nightly) for name in COUNTS])
def test_shipped_legs(name, tmp_path):
    text = (SPECS / f"{name}.toml").read_text(encoding="utf-8")
    text = text.replace(".links.frame]", ".links.frame]\nmass = 1.7\ncom = [0.03, 0.05]\ninertia = 0.02", 1)
    found, numbers = programs(text, tmp_path), standard(text)
    yaw = [1.0] if name in YAWED else []
    low, high = ([*(sign * turn for turn in yaw), *bound] for sign, bound in zip((-1, 1), DRIVES[name], strict=True))
    random, whole, fewest = np.random.default_rng(3), [], []
    for state in states(random, low, high, 4 * COUNTS[name]):
        (tau,), (Y,), (base, p) = (value(found[each], state) for each in NAMES)
        assert close(Y @ numbers, tau)
        assert close(base @ p, tau)
        whole.append(Y)
        fewest.append(base)
    assert base.shape[1] == COUNTS[name]
    assert rank(np.vstack(whole)) == COUNTS[name] == rank(np.vstack(fewest))


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["four_bar", "inverted_slider_crank", "telescope", "five_bar"])
def test_dimensions_as_parameters(name, tmp_path):
    """Factors among the parameters that stay are right for every size of the links, not only for the spec's."""
    text, topology = spec(name, NAMES), TOPOLOGIES[name]
    found, random = programs(text, tmp_path), np.random.default_rng(4)
    dimensions, drives = topology.draw(random, 30)
    compared, numbers = 0, standard(text)
    for param, q in zip(dimensions, drives, strict=True):
        state = (q, *random.uniform(-2, 2, (2, len(q))))
        (tau,), (Y,), (base, p) = (value(found[each], state, param=param) for each in NAMES)
        if np.isfinite(tau).all():
            compared += 1
            assert close(Y @ numbers, tau)
            assert close(base @ p, tau)
    assert compared > 10
