"""The manifest of a generated robot: what the runtime must know to load it without reading its code."""

import hashlib
import json
from collections.abc import Iterable
from math import isfinite, isnan
from pathlib import PurePosixPath
from typing import Any

from walkgen import __version__
from walkgen.emit.artifact import Artifact, Body, RobotCode
from walkgen.graph.program import Composite, Program
from walkgen.model.classify import inverse_class
from walkgen.model.gait import Gait, Schedule
from walkgen.model.mechanism import Joint, Limb, Mechanism, Parameter
from walkgen.model.walk import defaults, number
from walkgen.signature import Port
from walkgen.spec.checks_gait import gait_owner
from walkgen.spec.scalar import Scalar

FORMAT = 1
"""Version of the manifest's layout; the runtime refuses another."""


def manifest(code: RobotCode, sources: tuple[Artifact, ...]) -> Artifact:
    """manifest.json of the robot.

    Args:
        code: the robot and its functions.
        sources: what the library is compiled from; the digest is over names and bytes in this order.
    """
    robot = code.mechanism
    content = {
        "walkgen": __version__,
        "format": FORMAT,
        "robot": robot.name,
        "description": robot.description,
        "digest": source_digest(sources),
        "sources": [str(source.path) for source in sources],
        "float32": code.float32,
        "fma": code.fma,
        "targets": list(code.targets),
        "platforms": [platform.name for platform in robot.platforms],
        "joint_names": [joint_name(limb, joint) for limb in robot.limbs for joint in limb.joints],
        "limits": [_interval(joint.limits, robot) for limb in robot.limbs for joint in limb.joints],
        "parameters": [_parameter(parameter, robot) for parameter in robot.parameters],
        "legs": [_leg(leg, robot) for leg in robot.legs],
        "chains": [_chain(chain, robot) for chain in robot.chains],
        "routes": [_route(leg, robot) for leg in robot.legs if robot.ancestors(leg.platform)],
        **({"terrain": [patch.name for patch in robot.terrain.patches]} if robot.terrain else {}),
        **({"gaits": [_gait(gait, robot) for gait in robot.gaits]} if robot.gaits else {}),
        "functions": [_function(body) for body in code.functions],
    }
    return Artifact(PurePosixPath("manifest.json"), json.dumps(content, indent=1, allow_nan=False) + "\n")


def source_digest(sources: Iterable[Artifact]) -> str:
    """sha256, in hexadecimal, over each source's name, a NUL and its bytes."""
    digest = hashlib.sha256()
    for source in sources:
        digest.update(str(source.path).encode() + b"\0" + source.text.encode())
    return digest.hexdigest()


def joint_name(limb: Limb, joint: Joint) -> str:
    """What the robot calls the joint: its source's name, else `<leg or chain>_<joint>`."""
    return joint.source_name or f"{limb.name}_{joint.name}"


def _interval(bounds: tuple[Scalar, Scalar] | None, robot: Mechanism) -> list[float] | None:
    return None if bounds is None else [float(number(bound, robot)) for bound in bounds]


def _parameter(parameter: Parameter, robot: Mechanism) -> dict[str, Any]:
    default = float(defaults(robot)[parameter.name])
    return {"name": parameter.name, "unit": parameter.unit, "default": default, "bounds": _interval(parameter.bounds, robot)}


def _leg(leg: Limb, robot: Mechanism) -> dict[str, Any]:
    inverse = inverse_class(robot, leg)
    return {
        "name": leg.name,
        "platform": robot.platforms[leg.platform].name,
        "joints": [joint.name for joint in leg.joints],
        "slice": _slice(leg, robot),
        "branch_names": list(inverse.branch_names),
        "inverse_class": inverse.name,
    }


def _chain(chain: Limb, robot: Mechanism) -> dict[str, Any]:
    child = "" if chain.child is None else robot.platforms[chain.child].name
    return {
        "name": chain.name,
        "parent": robot.platforms[chain.platform].name,
        "child": child,
        "joints": [joint.name for joint in chain.joints],
        "slice": _slice(chain, robot),
    }


def _slice(limb: Limb, robot: Mechanism) -> list[int]:
    start = robot.offset(limb)
    return [start, start + len(limb.joints)]


def _route(leg: Limb, robot: Mechanism) -> dict[str, Any]:
    slices = [_slice(limb, robot) for limb in (*robot.ancestors(leg.platform), leg)]
    indices = [index for start, stop in slices for index in range(start, stop)]
    return {"name": leg.name, "owner": f"root_to_{leg.name}", "indices": indices}


def _gait(gait: Gait | Schedule, robot: Mechanism) -> dict[str, Any]:
    return _cycle(gait, robot) if isinstance(gait, Gait) else _schedule(gait, robot)


def _schedule(gait: Schedule, robot: Mechanism) -> dict[str, Any]:
    legs = [leg.name for leg in robot.legs]
    return {
        **_stepping(gait, robot),
        "events": [[float(event.at), legs[event.leg], event.does] for event in gait.events],
        "lifted": [leg for leg, up in zip(legs, gait.lifted, strict=True) if up],
    }


def _stepping(gait: Gait | Schedule, robot: Mechanism) -> dict[str, Any]:
    """What gaits of all kinds have."""
    return {
        "name": gait.name,
        "owner": gait_owner(gait.name),
        "kind": gait.kind,
        "legs": [leg.name for leg in robot.legs],
        "stride": float(gait.stride),
        "lift": None if gait.lift is None else float(gait.lift),
        "stance": None if gait.stance is None else [list(map(float, point)) for point in gait.stance],
        "static": gait.static,
        "body": gait.body,
        "margin": None if gait.margin is None else float(gait.margin),
    }


def _cycle(gait: Gait, robot: Mechanism) -> dict[str, Any]:
    return {
        **_stepping(gait, robot),
        "duty_factor": list(map(float, gait.duty_factor)),
        "phase": list(map(float, gait.phase)),
        "period": float(gait.period),
        **({"heel_off": float(gait.heel_off)} if any(leg.curved_sole for leg in robot.legs) else {}),
    }


def _function(body: Body) -> dict[str, Any]:
    signature = body.signature
    return {
        "owner": signature.owner,
        "name": signature.name,
        "full_name": signature.full_name,
        "inputs": [_port(port) for port in signature.inputs],
        "outputs": [_port(port) for port in signature.outputs],
        "doc": signature.doc,
        "source": signature.source,
        "operations": operations(body),
        "casadi": _in_casadi(body),
    }


def _in_casadi(body: Body) -> bool:
    return isinstance(body, Program) or not body.calls_routines or body.closed_form is not None


def operations(body: Body) -> int:
    """Arithmetic operations of the generated part; a support routine's own are not counted."""
    if isinstance(body, Composite):
        return sum(call.callee.operation_count for call in body.all_calls if isinstance(call.callee, Program))
    return body.operation_count


def _port(port: Port) -> dict[str, Any]:
    default = {"default": [_json(value) for value in port.default]} if port.default else {}
    return {"name": port.name, "shape": list(port.shape), "unit": port.unit, "kind": port.kind, **default}


def _json(value: float) -> float | str | None:
    """JSON has neither NaN, which is written as null, nor infinities, which are written as text."""
    return None if isnan(value) else value if isfinite(value) else str(value)
