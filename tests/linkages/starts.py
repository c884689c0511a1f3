"""Triads from random starts: their assemblies by walkgen and by numbers, and where they get to when their drives move slowly."""

from types import MappingProxyType

import numpy as np

from linkages.closure import Closure, apart, newton
from linkages.placed import code_of
from linkages.topologies import TRIADS, spec
from walkgen.model.assemble import assemble
from walkgen.spec.read import read
from walkgen.symbolic.starts import Starts


class Drawn:
    """Dimensions and drives, drawn before anything is known of them, and all assemblies there: unknowns, the furthest from dead first."""

    def __init__(self, name, count, seed, folder):
        self.name, self.topology, random = name, TRIADS[name], np.random.default_rng(seed)
        self.dimensions, drives = self.topology.draw(random, count)
        self.drives = np.tile(drives[0], (count, 1))  # whole turns are taken off about the start's drives, which are in the code
        self._folder = folder
        modes, given = self._modes(None)
        first = next(row for row, z in enumerate(given) if modes.at(z))
        modes, self._z = self._modes(self.dimensions[first])
        self.assemblies = [modes.at(z) for z in self._z]
        self.closes = np.array([bool(found) for found in self.assemblies])

    def _modes(self, values):
        """What finds all assemblies, and what it takes; ways of sliders are in units of what the values make the linkage's size."""
        path = self._folder / "drawn.toml"
        path.write_text(spec(self.name, (), values=values), encoding="utf-8")
        mechanism = assemble(read(path), self._folder)
        found = Starts(mechanism, mechanism.legs[0])
        known = [self.topology.parameters.index(parameter) for parameter in found.names]
        return found.modes, np.concatenate([self.drives, self.dimensions[:, known]], -1)

    def code(self, functions, friction=MappingProxyType({})):
        """Generated from the first set that assembles; `friction` as for `spec`."""
        first = np.flatnonzero(self.closes)[0]
        text = spec(self.name, functions, friction, values=self.dimensions[first], start=self.drives[first])
        return code_of(text, functions, self._folder)

    def started(self, code, rows, which):
        """Let the code start from an assembly of each of some sets."""
        points = [[*self._z[row], *self.assemblies[row][number].unknowns] for row, number in zip(rows, which, strict=True)]
        code["leg_foot_position"].__wrapped__.__globals__[f"{self.name}_leg_start"] = np.array(points)


def by_numbers(text, sides, dimensions, drives, random, starts):
    """All poses that a set closes in, by Newton from many starts [n, size]."""
    closure = Closure(text, np.tile(dimensions, (starts, 1)), np.tile(drives, (starts, 1)))
    x = random.uniform(-1.5, 1.5, (starts, closure.size))
    x[:, 2::3] = random.uniform(-np.pi, np.pi, x[:, 2::3].shape)
    x, closed = newton(closure, x, 10 ** random.uniform(-6, 0, starts))
    kept = []
    for pose in x[closed & closure.as_wanted(x, sides) & (np.abs(x).max(-1) < 1e3)]:
        pose[2::3] = np.angle(np.exp(1j * pose[2::3]))
        if all(apart(pose, other) > 1e-6 for other in kept):
            kept.append(pose)
    return np.array(kept).reshape(-1, closure.size)


def _stride(one, other):
    """The largest turn, or way in sizes of where things are."""
    away = np.abs(one - other)
    away[:, 2::3] = np.abs(np.angle(np.exp(1j * (one - other)[:, 2::3])))
    ways = np.delete(away, np.s_[2::3], 1) / np.maximum(1, np.abs(np.delete(one, np.s_[2::3], 1)).max(-1))[:, None]
    return np.maximum(away[:, 2::3].max(-1), ways.max(-1))


def moved(text, dimensions, x, start, end, parts):
    """Where poses get to while the drives go slowly from start to end, and whether they pass no dead point and nothing runs off to
    infinity: all links' equations at once, the guess from the last two poses.
    """
    alive, slow = np.ones(len(x), bool), np.zeros_like(x)
    begin = Closure(text, dimensions, start)
    sense = np.sign(np.linalg.det(begin.equations(x)[1]))
    for part in np.arange(1, parts + 1) / parts:
        closure, before = begin.at(start + part * (end - start)), x
        x = x + slow
        for _ in range(3 if part < 1 else 6):
            value, slope = closure.equations(x)
            slope[~alive], value[~alive] = np.eye(closure.size), 0
            x = x - np.linalg.solve(slope, value[..., None])[..., 0]
        value, slope = closure.equations(x)
        alive &= (np.abs(value).max(-1) < 1e-6) & (np.sign(np.linalg.det(slope)) == sense) & (_stride(x, before) < 0.3)
        x = np.where(alive[:, None], x, before)
        slow = np.where(alive[:, None], x - before, 0)
    return x, alive
