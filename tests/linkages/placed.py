"""NumPy code of a spec's functions, and of one more that tells the poses of all links."""

import runpy

import numpy as np

from walkgen.emit.artifact import RobotCode
from walkgen.emit.numpy_printer import numpy_artifact
from walkgen.graph.lower import lower
from walkgen.model.assemble import assemble
from walkgen.signature import Port
from walkgen.spec.read import read
from walkgen.symbolic.closing import closed
from walkgen.symbolic.closure import forward_placing
from walkgen.symbolic.derive import derive
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.tape import Tape, symbols_of


def code_of(text, names, folder):
    """Functions by name as in the generated module, `leg_poses` of a linkage among them: x, y, cosine and sine of every link."""
    path = folder / "spec.toml"
    path.write_text(text, encoding="utf-8")
    mechanism = assemble(read(path), folder)
    told = [closed(mechanism, poses(mechanism))] if mechanism.legs[0].linkage else []
    derived = [*derive(mechanism, tuple(names)), *told]
    code = RobotCode(mechanism, tuple(lower(function, True) for function in derived), "", ("numpy",))
    module = folder / "code.py"
    module.write_text(numpy_artifact(code).text, encoding="utf-8")
    return runpy.run_path(str(module))


def poses(mechanism):
    """Of the links in the plane, the frame first."""
    leg, tape = mechanism.legs[0], Tape()
    port, first = joint_port("q", leg.joints), len(leg.serial)
    placing = forward_placing(leg, symbols_of(port)[first : first + len(leg.drives)], parameter_symbols(mechanism), tape)
    links = len(leg.linkage.masses)
    entries = [entry for pose in map(placing.pose, range(links)) for entry in (*pose.origin, *pose.rotor)]
    words = signature(mechanism, leg.name, "poses", [port], [Port("poses", (links, 4))], "Poses of the links.", "")
    return tape.function(words, entries)


def as_unknowns(poses):
    """x, y and angle of every link but the frame."""
    angles = np.arctan2(poses[:, 1:, 3], poses[:, 1:, 2])
    return np.concatenate([poses[:, 1:, :2], angles[..., None]], -1).reshape(len(poses), -1)
