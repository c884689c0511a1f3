"""A linkage's frame weighs what its own table and the cylinders on it say, carried by the joint before it."""

from pathlib import Path

import numpy as np

from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.model.assemble import assemble
from walkgen.spec.read import read
from walkgen.symbolic.derive import derive

TEXT = (Path(__file__).parents[2] / "specs" / "hydraulic_leg.toml").read_text(encoding="utf-8")
LUMP = "masses = { at_first = 1.5, at_second = 1.2 }"
FRAME = "[leg_designs.hydraulic.links.frame]    # the linkage's fixed link\n"
YAW = "limits_deg = [-45, 45]\n"
MASS, COM, INERTIA = 2.0, np.array([0.03, 0.07]), 0.05
END = np.array([-0.25, 0.10])


def functions(text, folder, *names):
    path = folder / "spec.toml"
    path.write_text(text, encoding="utf-8")
    return {program.signature.name: program for program in map(lower, derive(assemble(read(path), folder), names))}


def on_the_yaw_link():
    """Frame and lump as one body of the yaw joint: the plane's X and Y are that frame's x, 0.1 m out, and z."""
    mass = MASS + 1.5
    com = (MASS * COM + 1.5 * END) / mass
    turning = INERTIA + MASS * np.sum((COM - com) ** 2) + 1.5 * np.sum((END - com) ** 2)
    inertia = [turning / 2, turning, turning / 2, 0, 0, 0]
    return f"link = {{ mass = {mass}, com = [{0.1 + com[0]}, 0, {com[1]}], inertia = {[float(entry) for entry in inertia]} }}\n"


def test_frame_and_lumps_count(tmp_path):
    own = TEXT.replace(FRAME, f"{FRAME}mass = {MASS}\ncom = {COM.tolist()}\ninertia = {INERTIA}\n")
    other = TEXT.replace(LUMP, "masses = { at_second = 1.2 }").replace(YAW, YAW + on_the_yaw_link())
    assert len({own, other, TEXT}) == 3
    programs = [functions(text, tmp_path, "floating_inverse_dynamics", "mass_matrix") for text in (own, other)]
    random = np.random.default_rng(1)
    q = [0.3, 0.33, 0.31]
    state = {"base_pose": np.eye(4).ravel(), "q": q, "v": random.normal(size=9), "a": random.normal(size=9), "foot_forces": np.zeros(3)}
    efforts = [interpret(each["floating_inverse_dynamics"], state)["tau"] for each in programs]
    assert np.abs(np.subtract(*efforts)).max() <= 1e-12 * np.abs(efforts[0]).max()
    masses = [interpret(each["mass_matrix"], {"q": q})["M"] for each in programs]
    assert np.abs(np.subtract(*masses)).max() <= 1e-12 * np.abs(masses[0]).max()
    bare = functions(TEXT, tmp_path, "mass_matrix")["mass_matrix"]
    assert masses[0][0] > interpret(bare, {"q": q})["M"][0] + 0.01
