"""Turns a generated folder into a Robot: the compiled library where there is one or can be one, else NumPy."""

import ctypes
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from walkgen.errors import Problem, ToolchainError
from walkgen.runtime import contact, settling, stability
from walkgen.runtime.calls import Function, Vectorised, as_called
from walkgen.runtime.counted import Counted
from walkgen.runtime.direct import direct, insist
from walkgen.runtime.manifest import FunctionEntry, Manifest, read_manifest
from walkgen.runtime.modules import execute
from walkgen.runtime.robot import Chain, Gait, Leg, Robot, Route, Schedule, Terrain
from walkgen.runtime.rows import ManyRows
from walkgen.runtime.ufuncs import Loops, find_loops, make_ufunc
from walkgen.signature import Signature
from walkgen.toolchain import build_library, check_sources, find_library

_VARIABLE = "WALKGEN_BACKEND"
_BACKENDS = ("c", "direct", "ufunc", "numpy")
"""Compiled; with direct calls of one row, or without; NumPy code."""
_NONE: Mapping[str, Function] = MappingProxyType({})


@dataclass(frozen=True)
class _Backend:
    """Bare functions by full name, what computes them and why that; the loops of those that may be called past NumPy's ufuncs."""

    name: str
    reason: str
    functions: Mapping[str, Function]
    loops: Mapping[str, Loops] = field(default_factory=dict)


def load(path: str | os.PathLike[str], *, threads: int = 1) -> Robot:
    """Load what `walkgen build` generated.

    The library in `_build` is used when it was made from exactly these sources, else it is compiled now; without a
    compiler the robot falls back to `<robot>_numpy.py`. Calls of one row go past NumPy's ufuncs where Python's headers are. The environment
    variable WALKGEN_BACKEND forces one: c, numpy; direct or ufunc, compiled with or without such calls.

    Args:
        path: the robot's folder, such as `generated/mero`.
        threads: how many a call with thousands of rows may use, where functions are compiled; the numbers are the same.

    Raises:
        ToolchainError: no generated robot there, its files do not belong together, or no backend works.
    """
    folder = Path(path).resolve()
    manifest = read_manifest(folder)
    check_sources(folder, manifest.sources, manifest.digest)
    return _robot(folder, manifest, _threaded(_backend(folder, manifest), manifest, threads))


def _threaded(backend: _Backend, manifest: Manifest, threads: int) -> _Backend:
    if threads <= 1:
        return backend
    signatures = {entry.signature.full_name: entry.signature for entry in manifest.functions}
    return replace(backend, functions={name: _of_many_rows(each, signatures[name], threads) for name, each in backend.functions.items()})


def _of_many_rows(function: Function, signature: Signature, threads: int) -> Function:
    """A compiled function with room for large results and so many threads; as it is where a call chooses its sizes."""
    return ManyRows(function, signature, threads) if isinstance(function, np.ufunc) and not signature.counts else function


def _backend(folder: Path, manifest: Manifest) -> _Backend:
    wanted = os.environ.get(_VARIABLE, "")
    if wanted not in {"", *_BACKENDS}:
        raise ToolchainError(Problem("WG407", f"{_VARIABLE}={wanted} is not a backend", f"use {', '.join(_BACKENDS)}, or unset it"))
    if wanted == "numpy":
        return _numpy(folder, manifest, f"{_VARIABLE}=numpy")
    if wanted == "direct":
        insist()
    try:
        compiled = _compiled(folder, manifest)
        return replace(compiled, loops={}) if wanted == "ufunc" else compiled
    except ToolchainError as error:
        if wanted or not _numpy_file(folder, manifest).exists():
            raise
        return _numpy(folder, manifest, "; ".join(problem.message.splitlines()[0] for problem in error.problems))


def _compiled(folder: Path, manifest: Manifest) -> _Backend:
    if "c" not in manifest.targets:
        raise ToolchainError(Problem("WG409", f"{manifest.robot} was built without C", 'add "c" to [generate] targets and build again'))
    library, reason = _library(folder, manifest)
    signatures = {entry.signature.full_name: entry.signature for entry in manifest.functions}
    found = {name: find_loops(signature, library, manifest.float32) for name, signature in signatures.items()}
    loops = {name: addresses for name, addresses in found.items() if addresses}
    functions: dict[str, Function] = {name: make_ufunc(signatures[name], library, addresses) for name, addresses in loops.items()}
    others = [entry for entry in manifest.functions if entry.signature.full_name not in functions]
    if others and _numpy_file(folder, manifest).exists():
        functions |= _vectorised(folder, manifest, others)
    return _Backend("c", reason, functions, loops)


def _library(folder: Path, manifest: Manifest) -> tuple[ctypes.CDLL, str]:
    """The library built earlier, or one compiled now, also where the earlier one does not load on this machine."""
    found = find_library(folder, manifest.robot, manifest.digest)
    if found:
        try:
            return ctypes.CDLL(str(found.path)), f"found {found.path}"
        except OSError:
            found = None
    built = build_library(folder, manifest.robot, manifest.sources, manifest.digest)
    try:
        return ctypes.CDLL(str(built.path)), f"compiled {built.path}"
    except OSError as error:
        raise ToolchainError(
            Problem("WG406", f"the compiled library does not load: {error}", "walkgen doctor shows the compilers")
        ) from error


def _numpy_file(folder: Path, manifest: Manifest) -> Path:
    return folder / f"{manifest.robot}_numpy.py"


def _numpy(folder: Path, manifest: Manifest, reason: str) -> _Backend:
    return _Backend("numpy", reason, _vectorised(folder, manifest, manifest.functions))


def _vectorised(folder: Path, manifest: Manifest, entries: Sequence[FunctionEntry]) -> dict[str, Function]:
    path = _numpy_file(folder, manifest)
    try:
        module = execute(path)
    except FileNotFoundError as error:
        raise ToolchainError(Problem("WG409", f"{path} was not built", 'add "numpy" to [generate] targets and build again')) from error
    names = {entry.signature.full_name: entry.signature for entry in entries}
    bare = {full: getattr(module, full.removeprefix(f"{manifest.robot}_"), None) for full in names}
    return {full: Vectorised(function, names[full]) for full, function in bare.items() if function is not None}


def _robot(folder: Path, manifest: Manifest, backend: _Backend) -> Robot:
    limits = _limits(manifest)
    defaults = {parameter["name"]: float(parameter["default"]) for parameter in manifest.parameters}
    functions = _callable(manifest, backend, tuple(defaults.values()))
    owned = {owner: MappingProxyType(own) for owner, own in _by_owner(manifest, functions).items()}
    return Robot(
        name=manifest.robot,
        description=manifest.description,
        folder=folder,
        platforms=manifest.platforms,
        joint_names=manifest.joint_names,
        limits=limits,
        parameters=MappingProxyType(defaults),
        legs=MappingProxyType({leg["name"]: _leg(leg, limits, owned.get(leg["name"], _NONE)) for leg in manifest.legs}),
        chains=MappingProxyType({chain["name"]: _chain(chain, limits, owned.get(chain["name"], _NONE)) for chain in manifest.chains}),
        routes=MappingProxyType({route["name"]: _route(route, owned.get(route["owner"], _NONE)) for route in manifest.routes}),
        terrain=Terrain("terrain", manifest.patches, owned.get("terrain", _NONE)) if manifest.patches else None,
        gaits=MappingProxyType({gait["name"]: _gait(gait, owned.get(gait["owner"], _NONE)) for gait in manifest.gaits}),
        functions=MappingProxyType(functions),
        backend=backend.name,
        backend_reason=backend.reason,
        entries=manifest.functions,
    )


def _callable(manifest: Manifest, backend: _Backend, defaults: tuple[float, ...]) -> dict[str, Function]:
    single = manifest.float32 and backend.name == "c"
    signatures = {entry.signature.full_name: entry.signature for entry in manifest.functions}

    def called(name: str, function: Function) -> Function:
        return as_called(function, signatures[name], defaults, single)

    functions = {name: called(name, backend.functions[name]) for name in signatures if name in backend.functions}
    for name, loops in backend.loops.items():
        large = called(name, _of_many_rows(backend.functions[name], signatures[name], threads=1))
        functions[name] = direct(functions[name], signatures[name], loops, large)
    return functions | _solves(manifest.robot, functions) | stability.named(manifest.robot, functions, signatures)


def _solves(robot: str, functions: Mapping[str, Function]) -> dict[str, Function]:
    """What stands in front of solves: the one `contact_forces` of several methods, `settle`."""
    start = f"{robot}_{contact.NAME}"
    solves = {name.removeprefix(f"{robot}_"): function for name, function in functions.items() if name.startswith(start)}
    fronts: dict[str, Function] = {start: contact.ContactForces(solves)} if start in functions else {}
    slid = f"{robot}_{settling.NAME}"
    solve = functions.get(slid)
    return fronts | ({slid: settling.Settle(solve)} if isinstance(solve, Counted) else {})


def _by_owner(manifest: Manifest, functions: Mapping[str, Function]) -> dict[str, dict[str, Function]]:
    owned: dict[str, dict[str, Function]] = {}
    for signature in (entry.signature for entry in manifest.functions):
        if signature.full_name in functions:
            owned.setdefault(signature.owner, {})[signature.name] = functions[signature.full_name]
    return owned


def _limits(manifest: Manifest) -> np.ndarray:
    limits = np.array([(-np.inf, np.inf) if pair is None else pair for pair in manifest.limits]).reshape(-1, 2)
    limits.setflags(write=False)
    return limits


def _leg(entry: Mapping[str, Any], limits: np.ndarray, functions: Mapping[str, Function]) -> Leg:
    part = slice(*entry["slice"])
    joints, branches = tuple(entry["joints"]), tuple(entry["branch_names"])
    return Leg(entry["name"], entry["platform"], joints, part, limits[part], branches, entry["inverse_class"], functions)


def _chain(entry: Mapping[str, Any], limits: np.ndarray, functions: Mapping[str, Function]) -> Chain:
    part = slice(*entry["slice"])
    return Chain(entry["name"], entry["parent"], entry["child"], tuple(entry["joints"]), part, limits[part], functions)


def _route(entry: Mapping[str, Any], functions: Mapping[str, Function]) -> Route:
    indices = np.array(entry["indices"], dtype=np.intp)
    indices.setflags(write=False)
    return Route(entry["name"], entry["owner"], indices, functions)


def _gait(entry: Mapping[str, Any], functions: Mapping[str, Function]) -> Gait | Schedule:
    return _schedule(entry, functions) if "events" in entry else _cycle(entry, functions)


def _schedule(entry: Mapping[str, Any], functions: Mapping[str, Function]) -> Schedule:
    return Schedule(
        events=tuple((float(at), leg, does) for at, leg, does in entry["events"]),
        lifted=tuple(entry["lifted"]),
        functions=functions,
        **_stepping(entry),
    )


def _cycle(entry: Mapping[str, Any], functions: Mapping[str, Function]) -> Gait:
    return Gait(
        duty_factor=tuple(map(float, entry["duty_factor"])),
        phase=tuple(map(float, entry["phase"])),
        period=float(entry["period"]),
        heel_off=float(entry.get("heel_off", 0.5)),
        functions=functions,
        **_stepping(entry),
    )


def _stepping(entry: Mapping[str, Any]) -> dict[str, Any]:
    """What gaits of all kinds have."""
    numbers = {key: None if entry[key] is None else float(entry[key]) for key in ("lift", "margin")}
    stance = None if entry["stance"] is None else tuple((float(x), float(y), float(z)) for x, y, z in entry["stance"])
    texts = {key: entry[key] for key in ("name", "kind", "body")}
    return {
        **texts,
        **numbers,
        "legs": tuple(entry["legs"]),
        "stride": float(entry["stride"]),
        "stance": stance,
        "static": bool(entry["static"]),
    }
