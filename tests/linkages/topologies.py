"""Linkages whose every dimension is a runtime parameter, so that one build serves any number of random ones.

A link's points, a slider's guide are written `name x y`; 0 or a parameter's name. Driven pairs end in `*`. `sides` say for every dyad
how it is assembled, and by which points that is seen: of pins the first outer, the second outer and the inner one, for a slider the pin
of its guide, the pin of its runner, and the slider.
"""

import re
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np


@dataclass(frozen=True)
class Topology:
    links: str
    pins: str
    foot: str
    sides: dict[str, tuple[str, ...]] = field(default_factory=dict)
    sliders: str = ""
    cylinders: str = ""
    reach: tuple[float, float] = (0.3, 1.2)
    """Of random cylinder lengths."""

    @property
    def parameters(self):
        """Names of the dimensions, in order."""
        return tuple(dict.fromkeys(re.findall(r"\b[dxyt]\d\b", f"{self.links} {self.sliders}")))

    @property
    def drive_count(self):
        return f"{self.pins}{self.sliders}{self.cylinders}".count("*")

    def draw(self, random, count):
        """Dimensions and drives: lengths d, offsets x and y, angles t."""
        ranges = {"d": (0.3, 1.0), "x": (-0.8, 0.8), "y": (-0.8, 0.8), "t": (-np.pi, np.pi)}
        low, high = np.array([ranges[name[0]] for name in self.parameters]).T
        dimensions = random.uniform(low, high, (count, len(low)))
        turns, ways, lengths = (text.count("*") for text in (self.pins, self.sliders, self.cylinders))
        low = [-np.pi] * turns + [-0.8] * ways + [self.reach[0]] * lengths
        high = [np.pi] * turns + [0.8] * ways + [self.reach[1]] * lengths
        return dimensions, random.uniform(low, high, (count, len(low)))


def _entries(text):
    return [tuple(part.strip() for part in entry.partition(":")[::2]) for entry in text.split(";") if entry.strip()]


def _coordinate(word):
    return word if word == "0" else f'"{word}"'


def _link(index, name, points):
    own = ", ".join(f"{point} = [{_coordinate(x)}, {_coordinate(y)}]" for point, x, y in (entry.split() for entry in points.split(",")))
    mass = (
        f"mass = {1 + 0.3 * index:.1f}\ncom = [{0.1 + 0.02 * index:.2f}, {0.03 * index - 0.1:.2f}]\ninertia = {0.02 + 0.01 * index:.2f}\n"
    )
    return f"[leg_designs.one.links.{name}]\npoints = {{ {own} }}\n{mass if index else ''}"


def _pair(kind, name, text, friction):
    own, driven = name.rstrip("*"), "driven = true\n" if name.endswith("*") else ""
    rubs = f"friction = {{ {friction[own]} }}\n" if own in friction else ""
    return f'[[leg_designs.one.{kind}]]\nname = "{own}"\n{text}\n{driven}{rubs}'


def _quoted(words):
    return ", ".join(f'"{word}"' for word in words.split())


def _slider(text):
    link, guide, x, y, angle = text.split()
    return f'link = "{link}"\nguide = {{ link = "{guide}", point = [{_coordinate(x)}, {_coordinate(y)}], angle = {_coordinate(angle)} }}'


def spec(name, functions, friction=MappingProxyType({}), values=None, start=None):
    """The text of a spec for a topology; `friction` by the names of pairs, `values` are the parameters' defaults, `start` the drives at
    which triads are assembled.
    """
    topology = (TOPOLOGIES | HELD | TRIADS)[name]
    defaults = [0.5] * len(topology.parameters) if values is None else [float(value) for value in values]
    wanted = ", ".join(f'"{function}"' for function in functions)
    lines = [
        f'walkgen = 1\nrobot = {{ name = "{name}", gravity = [0.7, -9.8, 0] }}\nplatforms = [{{ name = "body" }}]',
        f'legs = [{{ name = "leg", design = "one", platform = "body" }}]\ngenerate = {{ functions = [{wanted}], targets = ["numpy"] }}',
        "[parameters]",
        *(
            f'{entry} = {{ value = {value!r}, unit = "{"rad" if entry[0] == "t" else "m"}", runtime = true }}'
            for entry, value in zip(topology.parameters, defaults, strict=True)
        ),
        f'[leg_designs.one]\nfoot = "{topology.foot}"',
        *([] if start is None else [f"start = {{ drives = {[float(drive) for drive in start]} }}"]),
        "assembly = { " + ", ".join(f'{dyad} = "{side[0]}"' for dyad, side in topology.sides.items()) + " }",
        *(_link(index, link, points) for index, (link, points) in enumerate(_entries(topology.links))),
        *(_pair("pins", pin, f"joins = [{_quoted(joins)}]", friction) for pin, joins in _entries(topology.pins)),
        *(_pair("sliders", slider, _slider(text), friction) for slider, text in _entries(topology.sliders)),
        *(
            _pair("cylinders", bar, f"between = [{_quoted(ends)}]\nmasses = {{ at_first = 0.4, at_second = 0.3 }}", friction)
            for bar, ends in _entries(topology.cylinders)
        ),
    ]
    return "\n".join(lines)


_FOUR = "frame: A 0 0, D x1 y1; crank: A 0 0, B d1 0; coupler: B 0 0, C d2 0, P x2 y2; rocker: D 0 0, C d3 0"
_FOUR_PINS = "a*: frame.A crank.A; b: crank.B coupler.B; d: frame.D rocker.D; c: coupler.C rocker.C"

TOPOLOGIES = {
    "four_bar": Topology(_FOUR, _FOUR_PINS, "coupler.P", {"c": ("left", "crank.B", "frame.D", "rocker.C")}),
    "five_bar": Topology(
        "frame: A 0 0, E x1 y1; near: A 0 0, B d1 0; far: E 0 0, D d2 0; rod: B 0 0, C d3 0, P x2 y2; stay: D 0 0, C d4 0",
        "a*: frame.A near.A; e*: frame.E far.E; b: near.B rod.B; d: far.D stay.D; c: rod.C stay.C",
        "rod.P",
        {"c": ("right", "near.B", "far.D", "rod.C")},
    ),
    "slider_crank": Topology(
        "frame: A 0 0; crank: A 0 0, B d1 0; rod: B 0 0, C d2 0, P x2 y2; block: C x3 y3, S x4 y4",
        "a*: frame.A crank.A; b: crank.B rod.B; c: rod.C block.C",
        "rod.P",
        {"slide": ("behind", "crank.B", "rod.C", "slide")},
        sliders="slide: block.S frame x1 y1 t1",
    ),
    "moving_guide": Topology(
        "frame: A 0 0, O x1 y1; crank: A 0 0, B d1 0; rod: B 0 0, C d2 0, P x2 y2; bar: C x3 y3",
        "a*: frame.A crank.A; b: crank.B rod.B; c: rod.C bar.C",
        "rod.P",
        {"slide": ("ahead", "rod.C", "crank.B", "slide")},
        sliders="slide: frame.O bar x4 y4 t1",
    ),
    "inverted_slider_crank": Topology(
        "frame: A 0 0, D x1 y1; crank: A 0 0, B d1 0; block: B x3 y3, S x4 y4; lever: D 0 0, P x2 y2",
        "a*: frame.A crank.A; b: crank.B block.B; d: frame.D lever.D",
        "lever.P",
        {"slide": ("ahead", "frame.D", "crank.B", "slide")},
        sliders="slide: block.S lever x5 y5 t1",
    ),
    "scotch_yoke": Topology(
        "frame: A 0 0; crank: A 0 0, B d1 0; block: B x3 y3, S x4 y4; yoke: O x2 y2, P d2 0",
        "a*: frame.A crank.A; b: crank.B block.B",
        "yoke.P",
        sliders="slot: block.S yoke x5 y5 t1; slide: yoke.O frame x1 y1 t2",
    ),
    "crossed_guides": Topology(
        "frame: A 0 0; crank: A 0 0; block: B x3 y3, S x4 y4; cross: B 0 0, S x2 y2, P d2 0",
        "a*: frame.A crank.A; b: block.B cross.B",
        "cross.P",
        sliders="slide: block.S frame x1 y1 t2; slot: cross.S crank x5 y5 t1",
    ),
    "watt": Topology(
        _FOUR.replace("P x2 y2", "E x2 y2") + ", F x3 y3; rod: E 0 0, G d4 0, P x4 y4; stay: F 0 0, G d5 0",
        _FOUR_PINS + "; e: coupler.E rod.E; f: rocker.F stay.F; g: rod.G stay.G",
        "rod.P",
        {"c": ("left", "crank.B", "frame.D", "rocker.C"), "g": ("right", "coupler.E", "rocker.F", "rod.G")},
    ),
    "pantograph": Topology(
        "frame: O 0 0; lifter: T x1 y1; runner: I x2 y2; thigh: T 0 0, B d1 0, K d2 y3; shank: K 0 0, E d3 0, F x4 y4;"
        "long: E 0 0, I d4 0; short: B 0 0, I d5 0",
        "t: lifter.T thigh.T; b: thigh.B short.B; k: thigh.K shank.K; e: shank.E long.E; m: runner.I short.I long.I",
        "shank.F",
        {"b": ("right", "lifter.T", "runner.I", "thigh.B"), "e": ("left", "thigh.K", "runner.I", "shank.E")},
        sliders="lift*: lifter.T frame x5 y5 t1; reach*: runner.I frame x6 y6 t2",
    ),
    "hydraulic": Topology(
        "frame: E x1 y1, I 0 0; thigh: I 0 0, H d1 0, G x2 y2, J x3 y3; shank: H d2 0, P 0 0, L x4 y4",
        "i: frame.I thigh.I; h: thigh.H shank.H",
        "shank.P",
        {"lift": ("left", "frame.E", "frame.I", "thigh.G"), "knee": ("right", "thigh.J", "thigh.H", "shank.L")},
        cylinders="lift*: frame.E thigh.G; knee*: thigh.J shank.L",
    ),
    "odex": Topology(
        "frame: O 0 0, A x1 y1, W x2 y2, Z x3 y3; thigh: O 0 0, K d1 0, B d2 0; shank: K 0 0, N x4 y4, P d3 0; coupler: R 0 0, N d4 0;"
        "rocker: O 0 0, R d5 0, T x5 y5; bell: W 0 0, S d6 0, B x6 y6; link: S 0 0, T d7 0",
        "o: frame.O thigh.O; hip: frame.O rocker.O; k: thigh.K shank.K; n: shank.N coupler.N; r: rocker.R coupler.R; w: frame.W bell.W;"
        "s: bell.S link.S; u: link.T rocker.T",
        "shank.P",
        {
            "lift": ("right", "frame.A", "frame.O", "thigh.B"),
            "swing": ("left", "frame.Z", "frame.W", "bell.B"),
            "u": ("right", "frame.O", "bell.S", "rocker.T"),
            "n": ("right", "thigh.K", "rocker.R", "shank.N"),
        },
        cylinders="lift*: frame.A thigh.B; swing*: frame.Z bell.B",
    ),
    "inner_drives": Topology(
        "frame: A 0 0, E x1 y1; near: A 0 0, B d1 0; rod: B 0 0, C d2 0, P x2 y2; far: E 0 0, D d3 0; stay: D 0 0, C d4 0",
        "a: frame.A near.A; b*: near.B rod.B; e: frame.E far.E; d*: far.D stay.D; c: rod.C stay.C",
        "rod.P",
        {"c": ("left", "frame.A", "frame.E", "rod.C")},
    ),
    "telescope": Topology(
        "frame: A 0 0, D x1 y1; sleeve: A 0 0; rod: S x2 y2, C x3 y3, P d2 0; rocker: D 0 0, C d3 0",
        "a: frame.A sleeve.A; d: frame.D rocker.D; c: rod.C rocker.C",
        "rod.P",
        {"c": ("left", "frame.A", "frame.D", "rod.C")},
        sliders="stroke*: rod.S sleeve x4 y4 t1",
    ),
    "pin_of_three": Topology(
        "frame: A 0 0, D x1 y1, F x3 y3; crank: A 0 0, B d1 0; coupler: B 0 0, C d2 0; rocker: D 0 0, C d3 0;"
        "strut: C 0 0, G d4 0; arm: F 0 0, G d5 0, P x4 y4",
        "a*: frame.A crank.A; b: crank.B coupler.B; d: frame.D rocker.D; c: coupler.C rocker.C strut.C; f: frame.F arm.F; g: strut.G arm.G",
        "arm.P",
        {"c": ("left", "crank.B", "frame.D", "rocker.C"), "g": ("left", "coupler.C", "frame.F", "arm.G")},
    ),
}

HELD = {
    "coupler_knee": Topology(  # dyads under the drives, a triad once the foot is held
        "frame: A 0 0, D x1 y1; crank: A 0 0, B d1 0; coupler: B 0 0, C d2 0, K x2 y2; rocker: D 0 0, C d3 0; shank: K 0 0, P d4 y3",
        "a*: frame.A crank.A; b: crank.B coupler.B; d: frame.D rocker.D; c: coupler.C rocker.C; k*: coupler.K shank.K",
        "shank.P",
        {"c": ("left", "crank.B", "frame.D", "rocker.C")},
    ),
}
"""Of two drives."""

_PLATE = "plate: Q x6 y6, R x7 y7, S x8 y8, P x9 y9"

TRIADS = {
    "stephenson_2": Topology(
        "frame: A 0 0, D x1 y1; crank: A 0 0, B d1 0, E x2 y2; near: B 0 0, F d2 0; far: E 0 0, G d3 0;"
        "coupler: F 0 0, G x3 y3, C d4 0, P x4 y4; rocker: D 0 0, C d5 0",
        "a*: frame.A crank.A; b: crank.B near.B; e: crank.E far.E; f: near.F coupler.F; g: far.G coupler.G; d: frame.D rocker.D;"
        "c: coupler.C rocker.C",
        "coupler.P",
    ),
    "loop_of_four": Topology(  # class IV: the base is one of the links between the two ternary ones
        "frame: A 0 0, D x1 y1; crank: A 0 0, B d1 0; coupler: B 0 0, C d2 0, E x2 y2, P x3 y3; rocker: D 0 0, F d3 0, G x4 y4;"
        "near: C 0 0, F d4 0; far: E 0 0, G d5 0",
        "a*: frame.A crank.A; b: crank.B coupler.B; c: coupler.C near.C; e: coupler.E far.E; f: near.F rocker.F; g: far.G rocker.G;"
        "d: frame.D rocker.D",
        "coupler.P",
    ),
    "three_cylinders": Topology(
        f"frame: A 0 0, B x1 y1, C x2 y2; {_PLATE}",
        "",
        "plate.P",
        cylinders="one*: frame.A plate.Q; two*: frame.B plate.R; three*: frame.C plate.S",
    ),
    "plate_on_sliders": Topology(  # pins on the frame, guides on the plate; pins on the plate, guides on the frame and on a crank
        f"frame: A 0 0, B x1 y1; crank: A 0 0, D d1 0; block: B x2 y2, T x3 y3; shoe: Q x4 y4, U 0 0; sled: R x5 y5, V 0 0; {_PLATE}",
        "a*: frame.A crank.A; b: frame.B block.B; q: plate.Q shoe.Q; r: plate.R sled.R",
        "plate.P",
        sliders="into: block.T plate x0 y0 t1; on: shoe.U frame d2 d3 t2; along: sled.V crank d4 d5 t3",
    ),
    "cross_slide": Topology(  # one strut of two sliders
        f"frame: A 0 0, B x1 y1; crank: A 0 0, D d1 0; cross: T x2 y2, U x3 y3; rod: D 0 0, Q d2 0; bar: B 0 0, R d3 0; {_PLATE}",
        "a*: frame.A crank.A; d: crank.D rod.D; q: rod.Q plate.Q; b: frame.B bar.B; r: bar.R plate.R",
        "plate.P",
        sliders="down: cross.T frame x4 y4 t1; over: cross.U plate x5 y5 t2",
    ),
    "cross_slide_loop": Topology(  # the base is a strut, another strut has two sliders
        "frame: A 0 0, D x1 y1; crank: A 0 0, B d1 0; coupler: B 0 0, C d2 0, P x3 y3; rocker: D 0 0, F d3 0; cross: T x2 y2, U x4 y4;"
        "near: C 0 0, F d4 0",
        "a*: frame.A crank.A; b: crank.B coupler.B; c: coupler.C near.C; f: near.F rocker.F; d: frame.D rocker.D",
        "coupler.P",
        sliders="down: cross.T coupler x5 y5 t1; over: cross.U rocker x6 y6 t2",
    ),
    "two_cranks": Topology(  # a triad under the drives, dyads once the foot is held
        f"frame: A 0 0, B x1 y1, C x2 y2; near: A 0 0, D d1 0; far: B 0 0, E d2 0; one: D 0 0, Q d3 0; two: E 0 0, R d4 0; "
        f"tie: C 0 0, S d5 0; {_PLATE}",
        "a*: frame.A near.A; b*: frame.B far.B; d: near.D one.D; e: far.E two.E; q: one.Q plate.Q; r: two.R plate.R; c: frame.C tie.C;"
        "s: tie.S plate.S",
        "plate.P",
    ),
    "hung_triad": Topology(  # none of the triad's links is on the frame until a dyad has put them there
        "frame: A 0 0, D x1 y1; arm: A 0 0, B d1 0, C x2 y2; fore: B 0 0, E d2 0; near: C 0 0, F d3 0; far: E 0 0, G d4 0;"
        "hand: F 0 0, G x3 y3, H x4 y4, P x5 y5; tie: B 0 0, H d5 0; leg: D 0 0, J d6 0; foot: J 0 0, K d7 0",
        "a: frame.A arm.A; b*: arm.B fore.B; c: arm.C near.C; e: fore.E far.E; f: near.F hand.F; g: far.G hand.G; t: arm.B tie.B;"
        "h: tie.H hand.H; d*: frame.D leg.D; j: leg.J foot.J; k: foot.K hand.F",
        "hand.P",
        {"k": ("left", "frame.A", "leg.J", "hand.F")},
    ),
}

STEPHENSON_2 = """
[leg_designs.leg.stephenson]
inversion = "II"
ground = 0.3
crank = 0.06
coupler = 0.25
rocker = 0.22
on_crank = [0.02, 0.04]
on_coupler = [0.05, 0.08]
second_coupler = 0.2
second_rocker = 0.22
foot = [0.35, -0.1]
"""
"""Its short form, in a design called leg."""
