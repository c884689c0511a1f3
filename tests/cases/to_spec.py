"""Reference cases as spec text, so that walkgen meets them the way a user's robot comes in: through TOML.

Two routes: the tree of joints (origins and axes), and the case's own classical DH table.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

FOLDER = Path(__file__).parent
LEG_CASES = ("csiro_bullet_ar_leg_dh", "g1_left_leg", "phantomx_rf_leg", "puma560_first3", "scara_cobra600_rrp", "solo12_fl_leg")
ROBOT_CASES = ("mero_style_three_modules", "solo12_robot")


@dataclass(frozen=True)
class Conversion:
    """`text` is the spec; walkgen's q = the case's q[`order`]; `feet` are the legs' names in the case's order of feet."""

    text: str
    order: tuple[int, ...]
    feet: tuple[str, ...]


def case(name: str) -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    return loaded


def key(name: str) -> str:
    """A name of the case as a key of the spec language, at most 31 characters."""
    return re.sub(r"[^a-z0-9_]", "_", name.lower())[-31:]


def numbers(values: Sequence[float]) -> str:
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"


def rpy(R: Sequence[Sequence[float]]) -> tuple[float, float, float]:
    """Roll, pitch, yaw of Rz(yaw) Ry(pitch) Rx(roll)."""
    R = np.asarray(R)
    flat = np.hypot(R[0, 0], R[1, 0])
    if flat < 1e-9:  # yaw and roll turn about the same line: all of it goes to the yaw
        return 0.0, float(np.arctan2(-R[2, 0], flat)), float(np.arctan2(-R[0, 1], R[1, 1]))
    return float(np.arctan2(R[2, 1], R[2, 2])), float(np.arctan2(-R[2, 0], flat)), float(np.arctan2(R[1, 0], R[0, 0]))


# ---- the tree of joints ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Branch:
    """A run of joints: to a foot, or to the link where the paths to several feet part."""

    name: str
    parent: str
    joints: tuple[dict[str, Any], ...]
    foot: dict[str, Any] | None


def from_tree(data: dict[str, Any], functions: Sequence[str] = ()) -> Conversion:
    """Spec with a platform wherever the paths to the feet part, from the case's origins and axes; all functions, or those named."""
    model = data["model"]
    branches = _branches(model)
    chains = [branch for branch in branches if branch.foot is None]
    legs = sorted((branch for branch in branches if branch.foot), key=lambda leg: model["feet"].index(leg.foot))
    parts = [_header(data, functions), *(_design("chain", branch) for branch in chains), *(_design("leg", branch) for branch in legs)]
    parts.append(_platform(key(model["base_link"]), model["base_inertial"]))
    parts += [_child_platform(branch) for branch in chains]
    parts += [_leg(branch) for branch in legs]
    order = [model["joints"].index(joint) for branch in (*chains, *legs) for joint in branch.joints]
    return Conversion("\n".join(parts), tuple(order), tuple(leg.name for leg in legs))


def _branches(model: dict[str, Any]) -> list[Branch]:
    """Runs of joints from the base outwards, chains before what hangs on them."""
    into = {joint["child"]: joint for joint in model["joints"]}
    paths = []
    for foot in model["feet"]:
        path, link = [], foot["link"]
        while link != model["base_link"]:
            path.append(into[link])
            link = into[link]["parent"]
        paths.append((path[::-1], foot))
    return _split(key(model["base_link"]), paths)


def _split(platform: str, paths: list[tuple[list[dict[str, Any]], dict[str, Any]]]) -> list[Branch]:
    firsts = list({path[0]["name"]: None for path, _ in paths})
    found: list[Branch] = []
    for first in firsts:
        group = [(path, foot) for path, foot in paths if path[0]["name"] == first]
        if len(group) == 1:
            path, foot = group[0]
            found.append(Branch(key(foot["name"]), platform, tuple(path), foot))
            continue
        shared = 0
        while len({path[shared]["name"] for path, _ in group}) == 1:
            shared += 1
        run = tuple(group[0][0][:shared])
        name = key(run[-1]["child"])
        found.append(Branch(name, platform, run, None))
        found += _split(name, [(path[shared:], foot) for path, foot in group])
    return found


def _header(data: dict[str, Any], functions: Sequence[str]) -> str:
    name, gravity = data["name"], numbers(data["model"]["gravity"])
    wanted = f"[generate]\nfunctions = {json.dumps(functions)}\n" if functions else ""
    return f'walkgen = 1\n[robot]\nname = "{key(name)}"\ndescription = "{name}"\ngravity = {gravity}\n{wanted}'


def _design(kind: str, branch: Branch) -> str:
    table = f"{kind}_designs.{branch.name}"
    lines = [f"[{table}]"]
    if branch.foot:
        origin = branch.foot["origin"]
        lines.append(f"foot = {{ xyz = {numbers(origin['xyz'])}, rpy = {numbers(rpy(origin['R']))} }}")
    for joint in branch.joints:
        lines += _joint_row(table, joint)
        ends_in_platform = branch.foot is None and joint is branch.joints[-1]
        if not ends_in_platform:
            lines += _named_body(f"[{table}.joints.link]", joint["child_inertial"])
    return "\n".join(lines) + "\n"


def _joint_row(table: str, joint: dict[str, Any]) -> list[str]:
    origin, limits = joint["origin"], joint["limits"]
    lines = [f"[[{table}.joints]]", f'name = "{key(joint["name"])}"', f'type = "{joint["type"]}"']
    lines += [f"xyz = {numbers(origin['xyz'])}", f"rpy = {numbers(rpy(origin['R']))}", f"axis = {numbers(joint['axis'])}"]
    if "lower" in limits:
        lines.append(f"limits = {numbers([limits['lower'], limits['upper']])}")
    return lines


def _body(inertial: dict[str, Any]) -> list[str]:
    inertia = np.asarray(inertial["inertia"])
    six = [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]]
    rows = [f"mass = {float(inertial['mass'])!r}", f"com = {numbers(inertial['com'])}", f"inertia = {numbers(six)}"]
    return [*rows, "allow_unphysical = true"]


def _named_body(table: str, inertial: dict[str, Any]) -> list[str]:
    """A body under its table's header, unless it weighs and turns for nothing."""
    return [table, *_body(inertial)] if inertial["mass"] > 0 or np.any(inertial["inertia"]) else []


def _platform(name: str, inertial: dict[str, Any], extra: Sequence[str] = ()) -> str:
    body = _body(inertial) if inertial["mass"] > 0 else []
    return "\n".join(["[[platforms]]", f'name = "{name}"', *extra, *body]) + "\n"


def _child_platform(branch: Branch) -> str:
    where = [f'parent = "{branch.parent}"', f'chain = "{branch.name}"', "root = { xyz = [0, 0, 0] }", "end = { xyz = [0, 0, 0] }"]
    return _platform(branch.name, branch.joints[-1]["child_inertial"], [*where, f"source_names = {_names(branch.joints)}"])


def _leg(branch: Branch) -> str:
    lines = ["[[legs]]", f'name = "{branch.name}"', f'design = "{branch.name}"', f'platform = "{branch.parent}"']
    return "\n".join([*lines, f"source_names = {_names(branch.joints)}"]) + "\n"


def _names(joints: Sequence[dict[str, Any]]) -> str:
    return json.dumps([joint["name"] for joint in joints])


# ---- the DH table ----------------------------------------------------------------------------------------------------------------


def from_dh(data: dict[str, Any], tables: dict[str, dict[str, Any]] | None = None, functions: Sequence[str] = ()) -> Conversion:
    """Spec of serial legs on one base, from classical DH tables: the leg case's own, or `dh_chains` by foot."""
    model = data["model"]
    tables = tables or {model["feet"][0]["name"]: data["dh"]}
    index = {joint["name"]: position for position, joint in enumerate(model["joints"])}
    parts = [_header(data, functions), *(_dh_design(key(name), table) for name, table in tables.items())]
    parts.append(_platform(key(model["base_link"]), model["base_inertial"]))
    parts += [_dh_leg(key(name), table, key(model["base_link"])) for name, table in tables.items()]
    order = [index[row["joint"]] for table in tables.values() for row in table["rows"]]
    return Conversion("\n".join(parts), tuple(order), tuple(key(name) for name in tables))


def _dh_design(name: str, table: dict[str, Any]) -> str:
    lines = [f"[leg_designs.{name}]", 'dh = "classic"', f"foot = {_inline_pose(table['tool'])}"]
    for row in table["rows"]:
        lines += [f"[[leg_designs.{name}.joints]]", f'name = "{key(row["joint"])}"', f'type = "{row["type"]}"']
        lines += [f"{entry} = {row[entry]!r}" for entry in ("a", "alpha", "d", "theta")]
    return "\n".join(lines) + "\n"


def _dh_leg(name: str, table: dict[str, Any], platform: str) -> str:
    return f'[[legs]]\nname = "{name}"\ndesign = "{name}"\nplatform = "{platform}"\nmount = {_inline_pose(table["base"])}\n'


def _inline_pose(T: Sequence[Sequence[float]]) -> str:
    T = np.asarray(T)
    return f"{{ xyz = {numbers(T[:3, 3])}, rpy = {numbers(rpy(T[:3, :3]))} }}"
