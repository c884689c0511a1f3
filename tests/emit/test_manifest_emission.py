"""The manifest: what it says of a robot, and that its digest follows the sources' names and bytes."""

import hashlib
import json
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from pathlib import PurePosixPath

from mechanisms.hand_programs import guarded_inverse, inputs, made, shapes
from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.manifest import manifest, source_digest
from walkgen.graph.program import Call, Code, Composite, Op
from walkgen.model.mechanism import Joint, Limb, Mechanism, Motion, Parameter, Platform
from walkgen.signature import Port, Signature
from walkgen.spec.scalar import Name, Pi, div, exact, mul

ZERO = exact(0)


def joint(name, after, limits=None, source_name=""):
    return Joint(name, "revolute", (), 1, ZERO, after, limits, None, None, None, "", source_name)


def dh(a, alpha):
    return (Motion("translate", 0, a), Motion("rotate", 0, alpha))


RIGHT = div(Pi(), exact(2))
LIMITS = (mul(exact(-1), div(Pi(), exact(3))), mul(exact(2), Name("reach")))
LEG_JOINTS = (
    joint("yaw", dh(ZERO, RIGHT), LIMITS),
    joint("thigh", dh(Name("reach"), ZERO), None, "HFE joint"),
    joint("shank", dh(exact(Fraction("0.4")), ZERO)),
)
ROBOT = Mechanism(
    name="toy",
    description='Says "é"',
    gravity=(ZERO, ZERO, exact(Fraction("-9.80665"))),
    platforms=(Platform("front", None, None), Platform("rear", 0, None)),
    chains=(Limb("rear", 0, (), (joint("twist", ()), joint("bend", ())), (), child=1),),
    legs=(Limb("head_leg", 0, (), LEG_JOINTS, ()), Limb("tail_leg", 1, (), (joint("wag", ()),), ())),
    parameters=(Parameter("reach", exact(Fraction("0.35")), "m", (exact(Fraction("0.1")), exact(1))),),
    sections=(),
)
SOURCES = (Artifact(PurePosixPath("toy.h"), "é"), Artifact(PurePosixPath("toy.c"), "int x;\n"))


def written(*bodies, **changes):
    code = replace(RobotCode(ROBOT, bodies, "0" * 64), **changes)
    return json.loads(manifest(code, SOURCES).text)


def port(name, unit, kind):
    return {"name": name, "shape": [], "unit": unit, "kind": kind}


def test_robot():
    found = written(targets=("c", "numpy"), fma=False, float32=True)
    assert {key: found[key] for key in ("format", "robot", "description", "float32", "fma", "targets", "platforms", "sources")} == {
        "format": 1,
        "robot": "toy",
        "description": 'Says "é"',
        "float32": True,
        "fma": False,
        "targets": ["c", "numpy"],
        "platforms": ["front", "rear"],
        "sources": ["toy.h", "toy.c"],
    }


def test_joints_and_limits_in_the_order_of_q():
    """Limits are the doubles nearest to the exact ones: -pi/3 is not -math.pi/3."""
    found = written()
    assert found["joint_names"] == ["rear_twist", "rear_bend", "head_leg_yaw", "HFE joint", "head_leg_shank", "tail_leg_wag"]
    assert found["limits"] == [None, None, [-1.0471975511965979, 0.7], None, None, None]


def test_parts():
    found = written()
    assert found["parameters"] == [{"name": "reach", "unit": "m", "default": 0.35, "bounds": [0.1, 1.0]}]
    assert found["chains"] == [{"name": "rear", "parent": "front", "child": "rear", "joints": ["twist", "bend"], "slice": [0, 2]}]
    assert found["routes"] == [{"name": "tail_leg", "owner": "root_to_tail_leg", "indices": [0, 1, 5]}]
    head, tail = found["legs"]
    assert (head["platform"], head["joints"], head["slice"]) == ("front", ["yaw", "thigh", "shank"], [2, 5])
    assert (head["inverse_class"], len(head["branch_names"])) == ("yaw-pitch-pitch", 4)
    assert (tail["platform"], tail["slice"], tail["inverse_class"], tail["branch_names"]) == ("rear", [5, 6], "general R", ["root_1"])


def test_functions():
    kernel = made("kernel", (Port("x", (2,)),), (Port("y"),), (*inputs(2), Op(Code.ADD, (0, 1))), (2,))
    signature = Signature("toy", "leg", "solve", (Port("x", (2,)),), (Port("y"), Port("status", kind="integer")))
    calls = (Call(kernel, ("x", "y")), Call("wg_damped_inverse_3", ("x", "x", Decimal(1), Decimal(1), "y", "status")))
    solve = Composite(signature, (), calls, ("walkgen_damped.h",))
    program, iterative = written(guarded_inverse(), solve)["functions"]
    assert program == {
        "owner": "leg",
        "name": "guarded",
        "full_name": "toy_leg_guarded",
        "inputs": [port("x", "m", "real"), port("branch", "1", "integer")],
        "outputs": [port("y", "1", "real"), port("status", "1", "integer")],
        "doc": "By hand.",
        "source": "eq. (0)",
        "operations": 7,
        "casadi": True,
    }
    assert (iterative["operations"], iterative["casadi"]) == (1, False)
    assert written(replace(solve, closed_form=shapes()))["functions"][0]["casadi"] is True


def test_digest():
    digest = hashlib.sha256(b"toy.h\0" + "é".encode() + b"toy.c\0int x;\n").hexdigest()
    assert written()["digest"] == source_digest(SOURCES) == digest
    assert source_digest(SOURCES[::-1]) != digest


def test_text_is_ascii_and_stable():
    code = RobotCode(ROBOT, (shapes(),), "0" * 64)
    artifact = manifest(code, SOURCES)
    assert artifact.path == PurePosixPath("manifest.json")
    assert artifact.text.isascii()
    assert artifact.text.endswith("}\n")
    assert artifact == manifest(code, SOURCES)
