"""Equations of motion of every link of a linkage, with an unknown for whatever its pairs may carry, solved as one dense system."""

import numpy as np

from linkages.closure import Closure

STEPS = (-2, -1, 0, 1, 2)
FIRST = np.array([1, -8, 0, 8, -1]) / 12
SECOND = np.array([-1, 16, -30, 16, -1]) / 12


class Motion:
    """Poses of one set while its drives move as q + t qd + t^2 qdd / 2, from a pose that closes."""

    def __init__(self, text, parameters, drives, x, rates=0.0, seconds=0.0, step=2e-3):
        path = np.array([drives + k * step * rates + (k * step) ** 2 * seconds / 2 for k in STEPS])
        self.closure, self.step = Closure(text, np.tile(parameters, (len(STEPS), 1)), path), step
        self.x = np.tile(x, (len(STEPS), 1))
        for _ in range(5):
            value, slope = self.closure.equations(self.x)
            self.x = self.x - np.linalg.solve(slope, value[..., None])[..., 0]

    def point(self, link, own):
        """Where a link's point is, and its acceleration."""
        places = self.seen(link, own)
        return places[2], self.second(places)

    def angle(self, link):
        return self.closure.angle(self.x, link)[0][2]

    def seen(self, link, own):
        """Where a link's point is at the five times."""
        return self.closure.seen(self.x, link, np.broadcast_to(own, (len(STEPS), 2)))[0]

    def rate(self, values):
        """Time derivative of what is known at the five times."""
        return FIRST @ values / self.step

    def second(self, values):
        """Second time derivative of what is known at the five times."""
        return SECOND @ (values - values[2]) / self.step**2

    def turning(self, link):
        """A link's angular acceleration."""
        angles = self.closure.angle(self.x, link)[0]
        return self.second(angles)


class Bodies:
    """The dense system of a motion; `loads` are further ones on the links (force, moment about the origin)."""

    def __init__(self, motion, gravity, load, loads=0.0):
        self.motion, self.closure, self.gravity = motion, motion.closure, np.asarray(gravity)
        self.columns, self.ends, self.drives = [], [], []
        for pin in self.closure.design.get("pins", ()):
            self._pin(pin)
        for cylinder in self.closure.design.get("cylinders", ()):
            self._cylinder(cylinder)
        for slider in self.closure.design.get("sliders", ()):
            self._slider(slider)
        matrix = np.zeros((3 * len(self.closure.links), len(self.columns)))
        for number, column in enumerate(self.columns):
            for end, force, moment in column:
                link, at = self.ends[end]
                matrix[3 * link : 3 * link + 3, number] += [*force, moment + _cross(at, force)]
        self.wanted = self.demand(load) - np.ravel(loads)
        self.unknowns, _, self.rank, _ = np.linalg.lstsq(matrix[3:], self.wanted[3:], rcond=1e-13)
        self.left = np.abs(matrix[3:] @ self.unknowns - self.wanted[3:]).max()

    def demand(self, load):
        """By link, what its pairs must give it: force and moment about the origin."""
        wanted = np.zeros((len(self.closure.links), 3))
        for link, name in enumerate(self.closure.links[1:], 1):
            table = self.closure.design["links"][name]
            wanted[link] += self._carried(table["mass"], link, table["com"])
            wanted[link, 2] += table["inertia"] * self.motion.turning(link)
        for cylinder in self.closure.design.get("cylinders", ()):
            for text, key in zip(cylinder["between"], ("at_first", "at_second"), strict=True):
                link, own = self.closure.coordinates(text)
                wanted[link] += self._carried(cylinder["masses"][key], link, own)
        link, own = self.closure.coordinates(self.closure.design["foot"])
        foot = self.motion.point(link, own)[0]
        wanted[link] -= [*load, _cross(foot, load)]
        return wanted.ravel()

    def _carried(self, mass, link, own):
        at, second = self.motion.point(link, own)
        force = mass * (second - self.gravity)
        return [*force, _cross(at, force)]

    def _end(self, link, at):
        self.ends.append((link, at))
        return len(self.ends) - 1

    def _pin(self, pin):
        """A force on every link but the first, which gets the opposite of all; a moment if it is driven."""
        joined = [self.closure.coordinates(text) for text in pin["joins"]]
        at = self.motion.point(*joined[0])[0]
        first, *others = [self._end(link, at) for link, _ in joined]
        for other in others:
            self.columns += [[(other, e, 0), (first, -e, 0)] for e in np.eye(2)]
        if pin.get("driven"):
            self.drives.append(len(self.columns))
            self.columns.append([(others[0], np.zeros(2), 1), (first, np.zeros(2), -1)])

    def _cylinder(self, cylinder):
        if not cylinder.get("driven"):
            return
        self.drives.append(len(self.columns))
        joined = [self.closure.coordinates(text) for text in cylinder["between"]]
        ends = [self.motion.point(*place)[0] for place in joined]
        along = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
        first, second = (self._end(link, at) for (link, _), at in zip(joined, ends, strict=True))
        self.columns.append([(second, along, 0), (first, -along, 0)])

    def _slider(self, slider):
        """Normal force and moment, thrust if it is driven."""
        self.drives += [len(self.columns) + 1] * bool(slider.get("driven"))
        link, own = self.closure.coordinates(slider["link"])
        guide, at = self.closure.links.index(slider["guide"]["link"]), self.motion.point(link, own)[0]
        runner, bearer = self._end(link, at), self._end(guide, at)
        turn = self.motion.angle(guide) + self.closure.direction(slider)[0]
        forces = [np.array([-np.sin(turn), np.cos(turn)])] + [np.array([np.cos(turn), np.sin(turn)])] * bool(slider.get("driven"))
        self.columns += [[(runner, e, 0), (bearer, -e, 0)] for e in forces]
        self.columns.append([(runner, np.zeros(2), 1), (bearer, np.zeros(2), -1)])

    @property
    def reactions(self):
        """Force and moment about the pair's point on every end, pair by pair [ends, 3]."""
        found = np.zeros((len(self.ends), 3))
        for value, column in zip(self.unknowns, self.columns, strict=True):
            for end, force, moment in column:
                found[end] += value * np.array([*force, moment])
        return found

    def sums(self, reactions):
        """By link, forces and moments about the origin of all that the pairs give it, less the demand."""
        total = -self.wanted.reshape(-1, 3).copy()
        for (link, at), (x, y, moment) in zip(self.ends, reactions, strict=True):
            total[link] += [x, y, moment + _cross(at, (x, y))]
        return total[1:]


def _cross(a, b):
    return a[0] * b[1] - a[1] * b[0]
