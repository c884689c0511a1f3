"""Friction in the pairs of a linkage from its spec's tables: rates by differences, loads from the dense system without friction."""

import numpy as np

from linkages.newton_euler import Bodies


class Rubbed:
    """Every friction of a motion, pair by pair: pins, each further link against the first, sliders, cylinders without a drive.

    `steady` is the motion without acceleration of its drives, `pulls` are what springs do to the links then. `efforts` are what each pair
    takes, `rates` how fast it moves, `drives` whether it is driven. `loads` [links, 3] are what undriven ones do to the links, about the
    origin; `given` the same by the ends of pins, driven cylinders, sliders, then cylinders without a drive, about each end.
    """

    def __init__(self, motion, steady, gravity, load, pulls=0.0):
        self.motion, self.closure = motion, motion.closure
        self._carried = Bodies(steady, gravity, load, pulls).reactions
        free = [cylinder for cylinder in self._tables("cylinders") if not cylinder.get("driven")]
        self.given = np.zeros((len(self._carried) + 2 * len(free), 3))
        self.loads = np.zeros((len(self.closure.links), 3))
        self.rates, self.efforts, self.drives, place = [], [], [], 0
        for pin in self._tables("pins"):
            place = self._pin(pin, place)
        place += 2 * (len(self._tables("cylinders")) - len(free))
        for slider in self._tables("sliders"):
            place = self._slider(slider, place)
        for cylinder in free:
            place = self._cylinder(cylinder, place)

    def _tables(self, kind):
        return self.closure.design.get(kind, ())

    @property
    def power(self):
        """What becomes heat (W)."""
        return np.dot(self.efforts, self.rates)

    def _add(self, table, rate, carried, ends):
        """`ends` are two, each with its place among all, its link, where it is, and what a unit of effort does to it."""
        own, driven = table.get("friction", {}), bool(table.get("driven"))
        dry = own.get("coulomb", 0) + own.get("mu", 0) * own.get("radius", 1) * carried
        effort = own.get("viscous", 0) * rate + dry * np.sign(rate)
        self.rates.append(rate)
        self.efforts.append(effort)
        self.drives.append(driven)
        for place, link, at, unit in () if driven else ends:
            x, y, moment = effort * np.asarray(unit)
            self.given[place] += [x, y, moment]
            self.loads[link] += [x, y, moment + at[0] * y - at[1] * x]

    def _pin(self, pin, place):
        joined = [self.closure.coordinates(text) for text in pin["joins"]]
        links, at = [link for link, _ in joined], self.motion.point(*joined[0])[0]
        turns = [self.closure.angle(self.motion.x, link)[0] for link in links]
        for other in range(1, len(links)):
            ends = [(place, links[0], at, (0, 0, 1)), (place + other, links[other], at, (0, 0, -1))]
            self._add(pin, self.motion.rate(turns[other] - turns[0]), np.hypot(*self._carried[place + other, :2]), ends)
        return place + len(links)

    def _slider(self, slider, place):
        (way, _), _, (runner, guide) = self.closure.along(self.motion.x, slider)
        turn = self.motion.angle(guide) + self.closure.direction(slider)[0]
        along, force = np.array([np.cos(turn), np.sin(turn)]), self._carried[place, :2]
        at = self.motion.point(*self.closure.coordinates(slider["link"]))[0]
        ends = [(place, runner, at, (*-along, 0)), (place + 1, guide, at, (*along, 0))]
        self._add(slider, self.motion.rate(way), abs(along[0] * force[1] - along[1] * force[0]), ends)
        return place + 2

    def _cylinder(self, cylinder, place):
        joined = [self.closure.coordinates(text) for text in cylinder["between"]]
        first, second = (self.motion.seen(*end) for end in joined)
        length = np.hypot(*(second - first).T)
        along = (second - first)[2] / length[2]
        ends = [(place, joined[0][0], first[2], (*along, 0)), (place + 1, joined[1][0], second[2], (*-along, 0))]
        self._add(cylinder, self.motion.rate(length), 0.0, ends)
        return place + 2
