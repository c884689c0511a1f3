"""Functions of static stability: margins of a stance, the region of centres of mass, disturbances, and how a robot tips (theory 3.1, 5)."""

from collections.abc import Callable, Sequence

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.contact import FEWEST_FEET, routine_solve
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Angle, Derivation, Function, Same, Select, Solve, Step
from walkgen.symbolic.ports import signature
from walkgen.symbolic.rows import parameters_of
from walkgen.symbolic.tape import Tape, Vec, cross, dot, minus, scaled, symbols_of, times

DIRECTIONS = 64
"""Room for the corners of a region: WALKGEN_MAX_DIRECTIONS."""

_POINTS = Port("points", ("k", 3), "m")
_COM = Port("centre_of_mass", (3,), "m")
_DIRECTION = Port("direction", (3,))
_NORMALS = Port("normals", ("k", 3), default=(0.0,))
_GRAVITY = Port("gravity", (3,), "m/s^2", default=(0.0, 0.0, 0.0))
_MASS = Port("mass", (), "kg", default=(0.0,))
_OWN = Port("own", (4,), "m/s^2, kg")
_STATUS = Port("status", kind="integer")
_KAPPA, _TILT, _RATE, _TURN = (
    Port("kappa", (), "1/s^2"),
    Port("tilt", (), "rad"),
    Port("rate", (), "rad/s", default=(0.0,)),
    Port("turn", (), "rad"),
)
_FRAME = "Everything in one frame; gravity and mass are the robot's where they are left out or 0, normals are up where they are"


class StabilityFunctions:
    """Those of a robot with feet to share a load; `mass` is its own, an expression in the runtime parameters."""

    def __init__(self, mechanism: Mechanism, mass: Callable[[Tape], sympy.Expr]) -> None:
        self._mechanism, self._mass = mechanism, mass

    def functions(self) -> dict[str, Callable[[], Derivation]]:
        """By name."""
        if self._mechanism.contacts < FEWEST_FEET:
            return {}
        found = (
            *(self.stability_margins, self.stability_margins_d_com, self.feasible_region, self.disturbance_margin),
            *(self.tipping_acceleration, self.tipping_time, self.tipping_tilt, self.tipping_speed_limit),
        )
        return {function.__name__: function for function in found}

    def stability_margins(self) -> Solve:
        """Static, longitudinal, energy and friction margins."""
        outputs = (
            Port("static_margin", (), "m"),
            _STATUS,
            Port("longitudinal_margin", (2,), "m"),
            Port("energy_margin", (), "J"),
            Port("energy_height", (), "m"),
            Port("friction_margin", (), "m"),
            Port("polygon", ("k",), kind="integer"),
            Port("vertices", kind="integer"),
            Port("tipping_edge", (2,), kind="integer"),
            Port("edge_heights", ("k",), "m"),
        )
        doc = (
            f"Margins of a centre of mass over feet at any heights. {_FRAME}. static: signed distance of its projection along gravity "
            "from the border of the support polygon, negative outside; longitudinal: the distances to it along direction and back; "
            "energy: to tip over the easiest edge, and energy_height the same over the weight; friction: signed distance from the "
            "border of the region where friction carries the weight, the static one while mu is infinite. polygon: numbers of feet "
            "counterclockwise from above, -1 beyond its vertices; tipping_edge: from foot to foot; edge_heights: infinite beyond. "
            "SINGULAR with NaN but for static for feet on a line or fewer than three; with NaN for friction's alone INFEASIBLE, "
            "SINGULAR or NO_CONVERGENCE of its region."
        )
        source = "theory 5; McGhee and Frank 1968; Messuri and Klein 1985; Hirose, Tsukagoshi and Yoneda 1998"
        return self._margins("stability_margins", outputs, doc, source)

    def stability_margins_d_com(self) -> Solve:
        """Their gradients."""
        outputs = (
            Port("static_margin_d_com", (3,)),
            _STATUS,
            Port("longitudinal_margin_d_com", (2, 3)),
            Port("energy_margin_d_com", (3,), "N"),
            Port("energy_height_d_com", (3,)),
            Port("friction_margin_d_com", (3,)),
        )
        doc = (
            "Gradients of stability_margins by the centre of mass: those of the edge, foot or direction that limits a margin, of the "
            "first where several do. Statuses and NaN as there."
        )
        return self._margins("stability_margins_d_com", outputs, doc, "theory 5, differentiated")

    def feasible_region(self) -> Solve:
        """Where the centre of mass may be."""
        inputs = (_POINTS, _mu(), _NORMALS, _GRAVITY, Port("tolerance", (), "m", default=(1e-3,)))
        outputs = (Port("polygon", (DIRECTIONS, 3), "m"), _STATUS, Port("vertices", kind="integer"), Port("error", (), "m"))
        doc = (
            f"Where the centre of mass may be for the feet to carry the weight within their friction cones, at any height. {_FRAME}. "
            "polygon: corners inside the region, counterclockwise from above, at the height of the feet's centre; what is left over "
            "repeats the last. error: how far the region reaches beyond it at most, infinite where feet that press against each other "
            "leave it unbounded. NO_CONVERGENCE where that is more than tolerance; INFEASIBLE where it is empty, SINGULAR where it has "
            "no area."
        )
        words = signature(self._mechanism, "", "feasible_region", inputs, outputs, doc, "theory 5 and 4.2, P1; Bretl and Lall 2008")
        arguments = ("k", "points", "mu", "normals", "gravity", "own", "tolerance", "polygon", "vertices", "error", "status")
        return self._with_own(words, "wg_feasible_region", arguments)

    def disturbance_margin(self) -> Solve:
        """What push the stance withstands."""
        inputs = (_POINTS, _COM, _mu(), Port("point", (3,), "m"), _NORMALS, _GRAVITY, _MASS)
        outputs = (Port("force", (), "N"), _STATUS, Port("weakest_direction", (3,)))
        doc = (
            "The greatest level force at a point, such as wind at the centre of mass, that feet within their friction cones withstand "
            "together with the weight, whatever its direction, before one slips or lifts off; and the direction in which they "
            f"withstand no more. {_FRAME}. Where feet would slip in any direction alike it may be up to 2e-3 too great. INFEASIBLE "
            "where they do not carry the weight."
        )
        words = signature(self._mechanism, "", "disturbance_margin", inputs, outputs, doc, "theory 4.2, P1; Bretl and Lall 2008")
        given = ("k", "points", "centre_of_mass", "mu", "point", "normals", "gravity", "mass", "own")
        return self._with_own(words, "wg_disturbance_margin", (*given, "force", "weakest_direction", "status"))

    def tipping_acceleration(self) -> Function:
        """alpha'' of (10) to (13), corrected; axes of any slope."""
        inputs = (Port("axis", (2, 3), "m"), _COM, Port("inertia", (3, 3), "kg m^2"), _GRAVITY, _MASS)
        outputs = (Port("acceleration", (), "rad/s^2"), Port("tilt", (), "rad"), _KAPPA)
        doc = (
            "The angular acceleration of a stiff robot about the line between two points, level or not, away from the feet on its left "
            "as seen from the first towards the second: kappa sin(tilt). tilt: of the centre of mass from upright about the line, "
            "positive when it falls; kappa = m g cos(psi) r / (e . I e + m r^2) with r the distance from the line, which is inclined "
            "by psi. inertia: about the centre of mass, as centroidal_inertia gives it. NaN where the points coincide."
        )
        words = signature(self._mechanism, "", "tipping_acceleration", inputs, outputs, doc, "theory 5, eqs. (10)-(13) with errata 23-25")
        return self._tipping(words)

    def tipping_time(self) -> Solve:
        """How long a fall takes."""
        doc = (
            "The time in which a stiff robot, at this tilt and rate about a line, turns on by an angle, to less than pi from upright; "
            "kappa as tipping_acceleration gives it. INFEASIBLE and infinite where it never does."
        )
        return self._pendulum("tipping_time", (_KAPPA, _TILT, _TURN, _RATE), (Port("time", (), "s"), _STATUS), doc)

    def tipping_tilt(self) -> Solve:
        """How far it has fallen."""
        outputs = (_TURN, _STATUS, Port("rate_then", (), "rad/s"))
        doc = (
            "By how much a stiff robot, at this tilt and rate about a line, has turned on after a time, less than a whole turn from "
            "upright, and its rate then; kappa as tipping_acceleration gives it."
        )
        return self._pendulum("tipping_tilt", (_KAPPA, _TILT, Port("time", (), "s"), _RATE), outputs, doc)

    def tipping_speed_limit(self) -> Solve:
        """How fast it must walk."""
        inputs = (Port("length", (), "m"), _KAPPA, _TILT, _TURN, _RATE)
        doc = (
            "The least forward speed at which a step of a length ends before a stiff robot has turned on by an angle: length over "
            "tipping_time; 0 where it never turns so far."
        )
        return self._pendulum("tipping_speed_limit", inputs, (Port("speed", (), "m/s"), _STATUS), doc)

    def _margins(self, name: str, outputs: Sequence[Port], doc: str, source: str) -> Solve:
        inputs = (_POINTS, _COM, _DIRECTION, _mu(default=(float("inf"),)), _NORMALS, _GRAVITY, _MASS)
        words = signature(self._mechanism, "", name, inputs, outputs, doc, source)
        given = ("k", "points", "centre_of_mass", "direction", "mu", "normals", "gravity", "mass", "own")
        found = tuple(port.name for port in outputs if port is not _STATUS)
        return self._with_own(words, f"wg_{name}", (*given, *found, "status"))

    def _with_own(self, words: Signature, routine: str, arguments: tuple[str, ...]) -> Solve:
        """A routine that takes the robot's own gravity and mass."""
        tape = Tape()
        kernel = signature(self._mechanism, "", "own", [], [_OWN], "The robot's gravity and mass.", "")
        own = Step(tape.function(kernel, [*self._gravity, self._mass(tape)]), (*parameters_of(self._mechanism), "own"))
        return Solve(words, (_OWN,), (own, Step(routine, arguments)))

    @property
    def _gravity(self) -> Vec:
        x, y, z = (expression(component, parameter_symbols(self._mechanism)) for component in self._mechanism.gravity)
        return (x, y, z)

    def _tipping(self, words: Signature) -> Function:
        tape = Tape()
        axis, com, inertia, given, (mass,) = (symbols_of(port) for port in words.inputs[:5])
        none = tape.let("any_gravity", abs(given[0]) + abs(given[1]) + abs(given[2]))
        pull = [Select(Same(none, 0), own, x) for own, x in zip(self._gravity, given, strict=True)]
        gravity = tape.vector("pull", pull)
        carried = tape.let("carried", Select(Same(mass, 0), self._mass(tape), mass))
        way = tape.vector("way", minus(_triple(axis, 3), _triple(axis, 0)))
        e = tape.vector("e", scaled(tape.let("per_length", 1 / sympy.sqrt(dot(way, way))), way))
        start = tape.vector("from", minus(com, _triple(axis, 0)))
        arm = tape.vector("arm", minus(start, scaled(dot(e, start), e)))
        up = tape.vector("up", minus(scaled(dot(e, gravity), e), gravity))
        out = tape.vector("out", cross(e, up))
        square = tape.let("square", dot(arm, arm))
        moment = (_triple(inertia, 0), _triple(inertia, 3), _triple(inertia, 6))
        about = tape.let("about", dot(e, times(moment, e)) + carried * square)
        acceleration = carried * dot(arm, out) / about
        kappa = carried * sympy.sqrt(dot(up, up)) * sympy.sqrt(square) / about
        return tape.function(words, [acceleration, Angle(tape.let("aside", dot(arm, out)), tape.let("high", dot(arm, up))), kappa])

    def _pendulum(self, name: str, inputs: Sequence[Port], outputs: Sequence[Port], doc: str) -> Solve:
        """A routine of numbers alone: `rate` comes last for users, who may leave it out, before the angle or time inside."""
        words = signature(self._mechanism, "", name, inputs, outputs, doc, "theory 5: phi'' = kappa sin(phi); Carlson 1979")
        given = [port.name for port in inputs]
        found = [port.name for port in outputs if port is not _STATUS]
        return routine_solve(words, f"wg_{name}", (*given[:-2], given[-1], given[-2], *found, "status"))


def _mu(default: tuple[float, ...] = ()) -> Port:
    return Port("mu", ("k",), default=default)


def _triple(values: Sequence[sympy.Expr], start: int) -> Vec:
    return (values[start], values[start + 1], values[start + 2])
