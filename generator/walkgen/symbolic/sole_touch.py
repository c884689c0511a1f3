"""Where a curved sole touches the ground, in its foot's axes, for any posture: what kinematics and dynamics take for the foot point.

It is an unknown of the functions that rest on it, found before them: on the toe's or the heel's curve by Newton's method, at the end of a
curve where the foot is turned further, below the ankle where the sole lies flat.
"""

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.choices import at_most, both, less
from walkgen.symbolic.first_root import FirstRoot
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Function, Residue, Same, Select
from walkgen.symbolic.ground_plane import FLAT, foot_rotor
from walkgen.symbolic.path import Kinematics, path_of, touch_port
from walkgen.symbolic.ports import signature
from walkgen.symbolic.rolling_leg import Planar
from walkgen.symbolic.rolling_stance import RollingStance
from walkgen.symbolic.sole_ports import SoleLeg
from walkgen.symbolic.tangents import tangents_along
from walkgen.symbolic.tape import Tape, symbols_of


class SoleTouch:
    """Of one leg."""

    def __init__(self, mechanism: Mechanism, leg: Limb) -> None:
        self._own = SoleLeg.of(mechanism, leg)
        self._mechanism, self._leg, self._rolling = mechanism, leg, RollingStance(self._own)

    @property
    def up(self) -> Port:
        """The ground's normal in the sole's plane, as a rotor: forward and towards the ankle's far side."""
        return Port(f"{self._leg.name}_up", (2,))

    def upright(self, q: Port, first: int) -> Function:
        """q -> the ground's normal, `first` the place of the leg's first joint in q."""
        tape = Tape()
        words = signature(self._mechanism, self._leg.name, f"up_in_{q.name}_{q.size}", [q], [self.up], "", "")
        return tape.function(words, self._rotor(tape, q, first))

    def _rotor(self, tape: Tape, q: Port, first: int) -> Planar:
        values = symbols_of(q)[first : first + len(self._leg.joints)]
        rotation = Kinematics(path_of((self._leg,), values, parameter_symbols(self._mechanism)), tape).rotation
        return foot_rotor(self._mechanism, self._leg, rotation)

    def given(self, root: FirstRoot) -> Function:
        """What a curve's root takes, out of the ground's normal."""
        return self._own.function(Tape(), f"{root.name}_upright", [self.up], [root.given], symbols_of(self.up))

    def roots(self) -> list[FirstRoot]:
        """Of the curves that the sole has."""
        return [self._rolling.along(which, f"{self._leg.name}_{which}") for which in self._own.leg.sole.curves()]

    def place(self) -> Function:
        """Normal and roots -> the foot point."""
        tape, (ahead, _) = Tape(), symbols_of(self.up)
        inputs = [self.up, *(port for root in self.roots() for port in (root.root, root.status))]
        return self._own.function(tape, "touched", inputs, [touch_port(self._leg)], self._place(tape, ahead))

    def slopes(self, q: Port, first: int) -> Function:
        """q, roots -> how the foot point moves in the foot with the runtime parameters: a root by -(df/dp) / (df/droot)."""
        tape, roots = Tape(), self.roots()
        rotor = self._rotor(tape, q, first)
        placed = self._place(tape, rotor[0])
        residuals = [root.residual(tape, symbols_of(root.root)[0], rotor)[:2] for root in roots]
        columns = []
        for name, symbol in parameter_symbols(self._mechanism).items():
            moving: dict[sympy.Symbol, sympy.Expr] = {symbol: sympy.S.One}
            for root, (value, slope) in zip(roots, residuals, strict=True):
                (moved,) = tangents_along(tape, [value], name, {symbol: sympy.S.One})
                found = Same(symbols_of(root.status)[0], 0)
                moving[symbols_of(root.root)[0]] = tape.let("root_moves", Select(found, -moved / slope, 0))
            columns.append(tangents_along(tape, placed, name, moving))
        inputs = [q, *(port for root in roots for port in (root.root, root.status))]
        port = Port(f"{touch_port(self._leg).name}_d_param", (2, len(columns)))
        words = signature(self._mechanism, self._leg.name, f"touch_moves_in_{q.name}_{q.size}", inputs, [port], "", "")
        return tape.function(words, [entry for row in zip(*columns, strict=True) for entry in row])

    def _place(self, tape: Tape, ahead: sympy.Expr) -> list[sympy.Expr]:
        sole, parameters = self._own.leg.sole, parameter_symbols(self._mechanism)
        depth, rear, front = (expression(entry, parameters) for entry in (sole.depth, sole.rear, sole.front))
        below = -self._own.leg.foot[1]
        below = Select(less(below, rear), rear, Select(less(front, below), front, below))
        sides = {"toe": (depth, front), "heel": (depth, rear)}
        for which, root in zip(sole.curves(), self.roots(), strict=True):
            sides[which] = self._on(tape, which, root)
        toe = less(ahead, 0)
        flat = at_most(abs(ahead), FLAT)
        x, y = (
            Select(flat, level, Select(toe, *pair)) for level, pair in zip((depth, below), zip(*sides.values(), strict=True), strict=True)
        )
        taint = Residue(ahead)
        return [x + taint, sole.side * y + taint]

    def _on(self, tape: Tape, which: str, root: FirstRoot) -> Planar:
        """The point of a curve, its end where the foot is turned beyond it, from the foot frame's origin."""
        (at,), (status,) = symbols_of(root.root), symbols_of(root.status)
        end = self._rolling.curve(which, at, tape).bounds[1]
        held = tape.let(f"{which}_at", Select(both(Same(status, 0), at_most(at, end)), at, end))
        x, y = self._rolling.curve(which, held, tape).point
        return x - self._own.leg.foot[0], y - self._own.leg.foot[1]
