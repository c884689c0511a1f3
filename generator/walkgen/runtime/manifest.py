"""Reads manifest.json, which says all that a loaded robot knows of itself besides its code."""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from walkgen.errors import Problem, ToolchainError
from walkgen.signature import COUNTS, Port, Signature

FORMAT = 1
_CURE = "build the robot again with this walkgen: walkgen build specs/<robot>.toml"


@dataclass(frozen=True)
class FunctionEntry:
    """One generated function: its signature, arithmetic operations, and whether CasADi has it."""

    signature: Signature
    operations: int
    casadi: bool


@dataclass(frozen=True)
class Manifest:
    """manifest.json, typed; `legs`, `chains`, `routes`, `gaits` and `parameters` keep the file's keys, `patches` are the ground's."""

    robot: str
    description: str
    digest: str
    sources: tuple[str, ...]
    float32: bool
    targets: tuple[str, ...]
    platforms: tuple[str, ...]
    joint_names: tuple[str, ...]
    limits: tuple[tuple[float, float] | None, ...]
    parameters: tuple[dict[str, Any], ...]
    legs: tuple[dict[str, Any], ...]
    chains: tuple[dict[str, Any], ...]
    routes: tuple[dict[str, Any], ...]
    patches: tuple[str, ...]
    gaits: tuple[dict[str, Any], ...]
    functions: tuple[FunctionEntry, ...]


def read_manifest(folder: Path) -> Manifest:
    """The manifest of the robot in `folder`.

    Raises:
        ToolchainError: WG404 there is none, or it is not a manifest; WG405 its format is another walkgen's.
    """
    path = folder / "manifest.json"
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        cure = "give the folder that walkgen build wrote, such as generated/mero"
        raise ToolchainError(Problem("WG404", f"{folder} holds no generated robot: manifest.json: {error.strerror}", cure)) from error
    except ValueError as error:
        raise ToolchainError(Problem("WG404", f"{path} is not a manifest: {error}", _CURE)) from error
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        version = content.get("format") if isinstance(content, dict) else None
        raise ToolchainError(Problem("WG405", f"{path} has format {version}; this walkgen reads format {FORMAT}", _CURE))
    try:
        return _manifest(content)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ToolchainError(Problem("WG404", f"{path} is not a manifest: {error!r}", _CURE)) from error


def _manifest(content: dict[str, Any]) -> Manifest:
    robot = str(content["robot"])
    return Manifest(
        robot=robot,
        description=str(content["description"]),
        digest=str(content["digest"]),
        sources=_texts(content["sources"]),
        float32=bool(content["float32"]),
        targets=_texts(content["targets"]),
        platforms=_texts(content["platforms"]),
        joint_names=_texts(content["joint_names"]),
        limits=tuple(None if pair is None else (float(pair[0]), float(pair[1])) for pair in content["limits"]),
        parameters=_tables(content["parameters"]),
        legs=_tables(content["legs"]),
        chains=_tables(content["chains"]),
        routes=_tables(content["routes"]),
        patches=_texts(content.get("terrain", [])),
        gaits=_tables(content.get("gaits", [])),
        functions=tuple(_function(entry, robot) for entry in content["functions"]),
    )


def _texts(values: list[Any]) -> tuple[str, ...]:
    return tuple(map(str, values))


def _tables(values: list[Any]) -> tuple[dict[str, Any], ...]:
    return tuple(map(dict, values))


def _function(entry: dict[str, Any], robot: str) -> FunctionEntry:
    inputs, outputs = (tuple(_port(port) for port in entry[side]) for side in ("inputs", "outputs"))
    signature = Signature(robot, entry["owner"], entry["name"], inputs, outputs, entry["doc"], entry["source"])
    return FunctionEntry(signature, int(entry["operations"]), bool(entry["casadi"]))


def _port(port: dict[str, Any]) -> Port:
    default = tuple(math.nan if value is None else float(value) for value in port.get("default", ()))
    return Port(port["name"], tuple(size if size in COUNTS else int(size) for size in port["shape"]), port["unit"], port["kind"], default)
