"""What is drawn of a walk: platforms, chains, legs, the support polygon and the ground as points in the world."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from walkgen.gait.ground import Ground
from walkgen.gait.legs import carriers, platform_poses
from walkgen.gait.sole_outline import soles
from walkgen.gait.walk import Walk
from walkgen.runtime.robot import Chain, Leg, Robot

_MESH = 41
_AROUND = 0.5
_HALF_BODY = 0.06
Linked = Mapping[str, tuple[tuple[int, ...], ...]]
"""Of every leg with a linkage, by its name: the rows of `pair_positions` on each of its links."""
_SERIAL: Linked = MappingProxyType({})


@dataclass(frozen=True)
class Drawing:
    """Lines at chosen instants [f]; parts of a line are set apart by NaN.

    Attributes:
        times: instants [f] (s).
        rows: their numbers in the walk.
        legs: line through all legs' joints to their feet [f,p,3].
        soles: lines around curved soles [f,s,3].
        chains: line through the chains' joints, from platform to platform [f,c,3].
        platforms: closed line through the corners of every platform [f,m,3].
        polygon: closed line around the supporting feet or soles [f,p+1,3], its last corner repeated.
        ground: x, y and z of a mesh [g,g].
    """

    times: np.ndarray
    rows: np.ndarray
    legs: np.ndarray
    soles: np.ndarray
    chains: np.ndarray
    platforms: np.ndarray
    polygon: np.ndarray
    ground: tuple[np.ndarray, np.ndarray, np.ndarray]


def drawing(robot: Robot, walk: Walk, ground: Ground, rows: np.ndarray, linked: Linked = _SERIAL) -> Drawing:
    """The lines at the walk's instants `rows` [f].

    Args:
        robot: that walked; joints between its hips and feet are drawn where it has `joint_frames`, links where it has `pair_positions`, and
            chains where it has their `frames`.
        walk: simulated.
        ground: that it went over.
        rows: numbers of instants.
        linked: what the links of its linkages join.
    """
    q, base = walk.q[rows], walk.base_pose[rows]
    poses = base[:, None] @ platform_poses(robot, q)
    hosts = carriers(robot)
    legs = [
        _limb(leg, poses[:, host], q, walk.feet[rows, foot], linked.get(leg.name, ()))
        for foot, (leg, host) in enumerate(zip(robot.legs.values(), hosts, strict=True))
    ]
    lines = [(soles(leg, q[:, leg.slice]), host) for leg, host in zip(robot.legs.values(), hosts, strict=True)]
    around = [_moved(poses[:, host], own) for own, host in lines if own is not None]
    chains = [_link(chain, robot, poses, q) for chain in robot.chains.values()]
    outlines = [_outline(robot, poses, q, number) for number in range(len(robot.platforms))]
    return Drawing(
        times=walk.times[rows],
        rows=rows,
        legs=_parted(legs, len(rows)),
        soles=_parted(around, len(rows)),
        chains=_parted(chains, len(rows)),
        platforms=_parted(outlines, len(rows)),
        polygon=np.array([_hull(points[down], len(down) + 1) for points, down in zip(*_stood(walk, rows), strict=True)]),
        ground=_mesh(walk, ground),
    )


def _parted(lines: list[np.ndarray], frames: int) -> np.ndarray:
    """One line [f,p,3] with NaN after each part."""
    gap = np.full((frames, 1, 3), np.nan)
    return np.concatenate([part for line in lines for part in (line, gap)] or [gap], axis=1)


def _joints(limb: Leg | Chain, q: np.ndarray) -> np.ndarray:
    """Origins of the limb's frames [f,p,3] in its platform's frame; none where the robot was built without."""
    name = "joint_frames" if isinstance(limb, Leg) else "frames"
    if name not in limb.functions:
        return np.zeros((len(q), 0, 3))
    found: np.ndarray = limb.functions[name](q[:, limb.slice])[..., :3, 3]
    return found


def _moved(pose: np.ndarray, points: np.ndarray) -> np.ndarray:
    moved: np.ndarray = points @ pose[:, :3, :3].transpose(0, 2, 1) + pose[:, None, :3, 3]
    return moved


def _limb(leg: Leg, pose: np.ndarray, q: np.ndarray, foot: np.ndarray, links: tuple[tuple[int, ...], ...]) -> np.ndarray:
    if links and "pair_positions" in leg.functions:
        return _moved(pose, _parted(_links(leg.functions["pair_positions"](q[:, leg.slice]), links), len(q)))
    return np.concatenate([_moved(pose, _joints(leg, q)), foot[:, None]], axis=1)


def _links(points: np.ndarray, links: tuple[tuple[int, ...], ...]) -> list[np.ndarray]:
    """A line through the pairs of every link, closed where it has more than two."""
    lines = [list(link) + (list(link[:1]) if len(link) > 2 else []) for link in links if len(link) > 1]
    return [points[:, line] for line in lines]


def _link(chain: Chain, robot: Robot, poses: np.ndarray, q: np.ndarray) -> np.ndarray:
    parent, child = (poses[:, robot.platforms.index(name)] for name in (chain.parent, chain.child))
    return np.concatenate([parent[:, None, :3, 3], _moved(parent, _joints(chain, q)), child[:, None, :3, 3]], axis=1)


def _outline(robot: Robot, poses: np.ndarray, q: np.ndarray, number: int) -> np.ndarray:
    """A closed line around the platform's hips; a small square where it has fewer than three."""
    own = [_joints(leg, q[:1]) for leg in robot.legs.values() if leg.platform == robot.platforms[number]]
    hips = [joints[0, 0, :2] for joints in own if joints.size]
    corners = np.array([*hips, *([[0.0, 0.0]] if len(hips) != 1 else [])])
    if len(hips) < 3:
        side = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * _HALF_BODY
        corners = np.concatenate([corner + side for corner in corners])
    flat = np.column_stack([corners, np.zeros(len(corners))])
    ring = _hull(flat, len(flat) + 1)
    return _moved(poses[:, number], np.broadcast_to(ring, (len(q), *ring.shape)))


def _stood(walk: Walk, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What the robot may stand on, and whether it does."""
    return np.nan_to_num(walk.standing.points[rows]), walk.standing.support[rows]


def _hull(points: np.ndarray, size: int) -> np.ndarray:
    """Closed convex outline in the plan [size,3] of points; what is left over repeats the first, NaN where there is none."""
    if not len(points):
        return np.full((size, 3), np.nan)
    order = sorted(range(len(points)), key=lambda i: (points[i, 0], points[i, 1]))
    chain: list[int] = [*_side(points, order), *_side(points, order[::-1])]
    ring = [*dict.fromkeys(chain), *chain[:1]]
    return points[ring + ring[-1:] * (size - len(ring))]


def _side(points: np.ndarray, order: list[int]) -> list[int]:
    """The lower side of the hull, in order (Andrew 1979)."""
    kept: list[int] = []
    for i in order:
        while len(kept) > 1 and _turn(points[kept[-2]], points[kept[-1]], points[i]) <= 0.0:
            kept.pop()
        kept.append(i)
    return kept


def _turn(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _mesh(walk: Walk, ground: Ground) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    feet = walk.targets.reshape(-1, 3)
    low, high = np.nanmin(feet, axis=0) - _AROUND, np.nanmax(feet, axis=0) + _AROUND
    x, y = np.meshgrid(np.linspace(low[0], high[0], _MESH), np.linspace(low[1], high[1], _MESH))
    return x, y, ground.height(x, y)
