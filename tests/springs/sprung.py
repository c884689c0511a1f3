"""Springs from a spec's own tables: DH rows and the plane walked with complex numbers, so that slopes come from complex steps."""

import tomllib

import numpy as np

STEP = 1e-30


def _turn(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(4, dtype=complex)
    R[first, first], R[first, second], R[second, first], R[second, second] = c, -s, s, c
    return R


def _shift(x, y, z):
    T = np.eye(4, dtype=complex)
    T[:3, 3] = x, y, z
    return T


def _pose(table):
    roll, pitch, yaw = np.deg2rad(table.get("rpy_deg", (0, 0, 0)))
    return _shift(*table.get("xyz", (0, 0, 0))) @ _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll)


class Sprung:
    """The springs of a spec's first leg design with classic DH rows, also after its linkage; `links` [n, 3] are x, y and angle of the
    linkage's links.
    """

    def __init__(self, text):
        tables = tomllib.loads(text)
        self.gravity = np.array(tables["robot"]["gravity"])
        self.design = next(iter(tables["leg_designs"].values()))
        self.mount = _pose(tables["legs"][0].get("mount", {}))
        self.names = ["frame", *(name for name in self.design.get("links", ()) if name != "frame")]

    def frames(self, q):
        """The mount, then the frame that moves with each joint."""
        return self._series(self.mount, self.design.get("joints", ()), q)

    def _series(self, start, rows, q):
        found = [start]
        for row, value in zip(rows, q, strict=False):
            theta, d = np.deg2rad(row.get("theta_deg", 0)), row["d"]
            theta, d = (theta + value, d) if row["type"] == "revolute" else (theta, d + value)
            own = _turn(2, theta) @ _shift(0, 0, d) @ _shift(row["a"], 0, 0) @ _turn(0, np.deg2rad(row["alpha_deg"]))
            found.append(found[-1] @ own)
        return found

    def _after(self, frames, q, links):
        """What moves with each joint after the linkage."""
        rows = self.design.get("joints_after", ())
        if not rows:
            return []
        end = self.design["linkage_end"]
        link, _, point = end["point"].partition(".")
        x, y, angle = links[self.names.index(link) - 1]
        at = _shift(x, y, 0) @ _turn(2, angle) @ _shift(*self.design["links"][link]["points"][point], 0)
        return self._series(frames[-1] @ self.plane @ at @ _pose(end), rows, q[len(q) - len(rows) :])[1:]

    @property
    def plane(self):
        """Of the linkage, in the frame of the last joint before it."""
        return _pose(self.design.get("plane", {}))

    def ends(self, q, links=()):
        """Where every spring's ends are [springs, 2, 3]."""
        frames = self.frames(q)
        after = self._after(frames, q, links)
        return np.array([[self._end(end, frames, after, links) for end in spring["between"]] for spring in self.design["springs"]])

    def _end(self, end, frames, after, links):
        if not isinstance(end, str):
            names = ["mount", *(row["name"] for key in ("joints", "joints_after") for row in self.design.get(key, ()))]
            return ([*frames, *after][names.index(end["link"])] @ [*end["xyz"], 1])[:3]
        link, _, point = end.partition(".")
        x, y = self.design["links"][link]["points"][point]
        if link != "frame":
            at_x, at_y, angle = links[self.names.index(link) - 1]
            x, y = at_x + x * np.cos(angle) - y * np.sin(angle), at_y + x * np.sin(angle) + y * np.cos(angle)
        return (frames[-1] @ self.plane @ [x, y, 0, 1])[:3]

    def lengths(self, q, links=()):
        ends = self.ends(q, links)
        return np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(-1))

    def _each(self, key, default=0.0):
        return np.array([spring.get(key, default) for spring in self.design["springs"]])

    def tensions(self, q, links=()):
        return self._each("initial_tension") + self._each("stiffness") * (self.lengths(q, links) - self._each("free_length"))

    def energies(self, q, links=()):
        more = self.lengths(q, links) - self._each("free_length")
        return self._each("initial_tension") * more + self._each("stiffness") * more**2 / 2

    def masses(self):
        """Of every spring's ends [springs, 2]."""
        tables = [spring.get("masses", {}) for spring in self.design["springs"]]
        return np.array([[table.get("at_first", 0.0), table.get("at_second", 0.0)] for table in tables])

    def moments(self, q):
        """What every spring does to every joint [springs, n], of a leg in series."""
        return -np.stack([self.energies(self._moved(q, joint)).imag / STEP for joint in range(len(q))], -1)

    def moving(self, q, qd):
        """Kinetic energy of what the springs weigh."""
        speeds = self.ends(np.asarray(q, dtype=complex) + 1j * STEP * np.asarray(qd)).imag / STEP
        return (self.masses()[..., None] * speeds**2).sum() / 2

    def hanging(self, q):
        """Potential energy of what the springs weigh at what moves."""
        moving = np.array([[end["link"] != "mount" for end in spring["between"]] for spring in self.design["springs"]])
        return -((self.masses() * moving)[..., None] * self.ends(q).real * self.gravity).sum()

    def _moved(self, q, joint):
        moved = np.array(q, dtype=complex)
        moved[joint] += 1j * STEP
        return moved
