"""Loop closure by numbers: every pair of a spec's tables as equations in the poses of all links, solved by Newton from many starts."""

import tomllib
from copy import copy
from functools import cache

import numpy as np

DAMPED, PLAIN, AT_ONCE = 25, 6, 1000
NEAR, CLOSED = 1e-2, 1e-9


class Closure:
    """The equations of a spec's leg design for n sets of runtime parameters [n, np] and drives [n, nq].

    Unknowns are x, y and angle of every link but the frame. Drives are in walkgen's order: pins, sliders, cylinders.
    """

    def __init__(self, text, parameters, drives):
        self._tables = _tables(text)
        self.design = next(iter(self._tables["leg_designs"].values()))
        self.links = ["frame", *(name for name in self.design["links"] if name != "frame")]
        self.drives, self.count, self.size = np.asarray(drives), len(drives), 3 * (len(self.links) - 1)
        self._values = dict(zip(self._tables.get("parameters", ()), np.asarray(parameters).T, strict=True))
        self._chosen, self._known = self._drive_numbers(), {}

    def at(self, drives):
        """The same dimensions with other drives."""
        other = copy(self)
        other.drives = np.asarray(drives)
        return other

    def _drive_numbers(self):
        pairs = [(kind, index) for kind in ("pins", "sliders", "cylinders") for index, _ in enumerate(self.design.get(kind, ()))]
        driven = [(kind, index) for kind, index in pairs if self.design[kind][index].get("driven")]
        return {place: number for number, place in enumerate(driven)}

    def number(self, entry):
        value = self._values[entry] if isinstance(entry, str) else entry
        return np.broadcast_to(np.asarray(value, dtype=float), (self.count,))

    def coordinates(self, text):
        """The link's index and the point [n, 2] of `link.point`."""
        if text not in self._known:
            link, _, name = text.partition(".")
            self._known[text] = self.links.index(link), self.pair(self.design["links"][link]["points"][name])
        return self._known[text]

    def pair(self, entries):
        return np.stack([self.number(entry) for entry in entries], -1)

    def seen(self, x, link, point):
        """A point in the frame's axes [n, 2], and its slopes [n, 2, size]."""
        slope = np.zeros((self.count, 2, self.size))
        if link == 0:
            return point, slope
        place = 3 * (link - 1)
        turned = _turned(x[:, place + 2], point)
        slope[:, 0, place] = slope[:, 1, place + 1] = 1
        slope[:, 0, place + 2], slope[:, 1, place + 2] = -turned[:, 1], turned[:, 0]
        return x[:, place : place + 2] + turned, slope

    def angle(self, x, link):
        slope = np.zeros((self.count, self.size))
        if link == 0:
            return np.zeros(self.count), slope
        slope[:, 3 * link - 1] = 1
        return x[:, 3 * link - 1], slope

    def equations(self, x):
        """Residuals [n, size] and slopes [n, size, size]."""
        rows = [*self._pins(x), *self._sliders(x), *self._cylinders(x)]
        return np.stack([row for row, _ in rows], -1), np.stack([slope for _, slope in rows], 1)

    def _turn(self, x, first, second, wanted):
        (a, from_a), (b, from_b) = self.angle(x, first), self.angle(x, second)
        return 2 * np.sin((b - a - wanted) / 2), np.cos((b - a - wanted) / 2)[:, None] * (from_b - from_a)

    def _pins(self, x):
        for index, pin in enumerate(self.design.get("pins", ())):
            ends = [self.coordinates(text) for text in pin["joins"]]
            first, slope = self.seen(x, *ends[0])
            for end in ends[1:]:
                other, own = self.seen(x, *end)
                yield from ((other[:, axis] - first[:, axis], own[:, axis] - slope[:, axis]) for axis in (0, 1))
            if ("pins", index) in self._chosen:
                yield self._turn(x, ends[0][0], ends[1][0], self.drives[:, self._chosen["pins", index]])

    def _sliders(self, x):
        for index, slider in enumerate(self.design.get("sliders", ())):
            (way, way_slope), (off, off_slope), (runner, guide) = self.along(x, slider)
            yield off, off_slope
            yield self._turn(x, guide, runner, 0)
            if ("sliders", index) in self._chosen:
                yield way - self.drives[:, self._chosen["sliders", index]], way_slope

    def direction(self, slider):
        """Of a guide, in its link's axes."""
        guide = slider["guide"]
        return self.number(guide["angle"]) if "angle" in guide else np.deg2rad(self.number(guide["angle_deg"]))

    def along(self, x, slider):
        """Of a slider's point: the way along its guide and off it, with slopes; its link and the guide's."""
        runner, point = self.coordinates(slider["link"])
        guide = self.links.index(slider["guide"]["link"])
        (at, slope), (start, own) = self.seen(x, runner, point), self.seen(x, guide, self.pair(slider["guide"]["point"]))
        turn, turn_slope = self.angle(x, guide)
        turn = turn + self.direction(slider)
        along = np.stack([np.cos(turn), np.sin(turn)], -1)
        across = np.stack([-along[:, 1], along[:, 0]], -1)
        parts = [(np.einsum("ni,ni->n", e, at - start), np.einsum("ni,nij->nj", e, slope - own)) for e in (along, across)]
        (way, way_slope), (off, off_slope) = parts
        return (way, way_slope + off[:, None] * turn_slope), (off, off_slope - way[:, None] * turn_slope), (runner, guide)

    def _cylinders(self, x):
        for index, cylinder in enumerate(self.design.get("cylinders", ())):
            if ("cylinders", index) in self._chosen:
                (a, from_a), (b, from_b) = (self.seen(x, *self.coordinates(text)) for text in cylinder["between"])
                length = self.drives[:, self._chosen["cylinders", index]]
                yield np.sum((b - a) ** 2, -1) - length**2, 2 * np.einsum("ni,nij->nj", b - a, from_b - from_a)

    def side(self, x, side):
        """Signed: positive where a dyad of a topology is on its first side."""
        if side[0] in ("left", "right"):
            p, q, pin = (self.seen(x, *self.coordinates(text))[0] for text in side[1:])
            return _outer(q - p, pin - p)
        of_guide, of_runner = (self.seen(x, *self.coordinates(text))[0] for text in side[1:3])
        slider = next(slider for slider in self.design["sliders"] if slider["name"] == side[3])
        turn = self.angle(x, self.links.index(slider["guide"]["link"]))[0] + self.direction(slider)
        return np.cos(turn) * (of_runner - of_guide)[:, 0] + np.sin(turn) * (of_runner - of_guide)[:, 1]

    def as_wanted(self, x, sides):
        """Whether every dyad is on the side that the spec says."""
        signs = [self.side(x, side) * (1 if side[0] in ("left", "ahead") else -1) for side in sides.values()]
        return np.all([sign > 0 for sign in signs], axis=0) if signs else np.ones(self.count, bool)


@cache
def _tables(text):
    return tomllib.loads(text)


def _turned(angle, point):
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([cosine * point[:, 0] - sine * point[:, 1], sine * point[:, 0] + cosine * point[:, 1]], -1)


def _outer(a, b):
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def apart(one, other):
    """The largest difference, turns taken off."""
    away = one - other
    away[..., 2::3] = np.angle(np.exp(1j * away[..., 2::3]))
    return np.abs(away).max(-1)


def newton(closure, x, strength):
    """From one start a set: least squares damped by the residual, then Newton; poses and whether they close."""
    for _ in range(DAMPED):
        value, slope = closure.equations(x)
        normal = np.swapaxes(slope, 1, 2)
        damping = strength * np.minimum(np.sum(value**2, -1), 1) + 1e-13 * np.sum(slope**2, (1, 2))
        x = x - np.linalg.solve(normal @ slope + damping[:, None, None] * np.eye(closure.size), normal @ value[..., None])[..., 0]
    near = np.abs(closure.equations(x)[0]).max(-1) < NEAR  # as far as it is damped, it creeps to poses far away
    for _ in range(PLAIN):
        value, slope = closure.equations(x)
        near &= np.abs(value).max(-1) < 1
        slope[~near] = np.eye(closure.size)
        x = x - np.linalg.solve(slope + 1e-14 * np.eye(closure.size), value[..., None])[..., 0]  # a start may end in a singular pose
    return x, near & (np.abs(closure.equations(x)[0]).max(-1) < CLOSED)


def assembled(text, sides, parameters, drives, random, rounds):
    """Poses [n, size] on the wanted sides; NaN where no start led there in a set's `rounds` [n], each of four times the starts."""
    found = np.full((len(drives), Closure(text, parameters, drives).size), np.nan)
    for number in range(max(rounds)):
        many = np.repeat(np.flatnonzero(np.isnan(found[:, 0]) & (rounds > number)), 8 * 4**number)
        for part in np.array_split(many, len(many) // AT_ONCE + 1):
            closure = Closure(text, parameters[part], drives[part])
            x, closed = newton(closure, _start(closure, random), 10 ** random.uniform(-6, 0, closure.count))
            good = closed & closure.as_wanted(x, sides)
            found[part[good]] = x[good]
    return found


def _start(closure, random):
    """Angles at random, places of all sizes."""
    x = random.uniform(-1, 1, (closure.count, closure.size)) * 10 ** (3 * random.uniform(0, 1, (closure.count, 1)) ** 4)
    x[:, 2::3] = random.uniform(-np.pi, np.pi, x[:, 2::3].shape)
    return x
