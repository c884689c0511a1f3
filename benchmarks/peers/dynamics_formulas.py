"""Dynamics of a tree of revolute joints over any symbolic algebra, so that every peer is given exactly the same recursions."""

from collections.abc import Sequence
from functools import reduce
from typing import Any

from multibody import Body, Robot, Text
from peers.dynamics_vectors import Matrix, Vector, cross, dot, minus, outer, plus, product, scaled, times, transposed, turned
from peers.formulas import Algebra

FORMS = ("centres", "origins")
"""`centres`: forces and moments about the centres of mass (Luh, Walker, Paul); `origins`: first moments and inertia about the joints."""


class Recursion:
    """One robot at joint angles q: rotations once, then efforts, mass matrix or accelerations as often as needed."""

    def __init__(self, algebra: Algebra, robot: Robot, q: Sequence[Any], form: str) -> None:
        self.algebra, self.robot, self.form = algebra, robot, form
        turns = [turned(body.axis, algebra.cos(angle), algebra.sin(angle)) for body, angle in zip(robot.bodies, q, strict=True)]
        self.rotations = [product(self._numbers(body.rotation), turn) for body, turn in zip(robot.bodies, turns, strict=True)]
        self.places = [self._vector(body.place) for body in robot.bodies]
        self.axes = [[int(row == body.axis) for row in range(3)] for body in robot.bodies]

    def _number(self, text: Text) -> Any:
        """Exact 0 and 1 stay whole numbers, which every algebra simplifies away."""
        return text if isinstance(text, int) else self.algebra.number(text)

    def _vector(self, texts: Sequence[Text]) -> Vector:
        return [self._number(text) for text in texts]

    def _numbers(self, texts: Sequence[Sequence[Text]]) -> Matrix:
        return [self._vector(row) for row in texts]

    # ---- efforts

    def efforts(
        self, base: tuple[Vector, Vector, Vector], qd: Vector, qdd: Vector, forces: Sequence[Vector] = ()
    ) -> tuple[Vector, Vector, Vector]:
        """Base force and moment, joint efforts; `base` is spin, its rate and acceleration less gravity, `forces` in the base's axes."""
        motions = self._motions(base, qd, qdd)
        wrenches = [self._inertial(body, motion) for body, motion in zip(self.robot.bodies, motions, strict=True)]
        root = self._inertial(self.robot.base, base)
        for foot, force in zip(self.robot.feet, forces, strict=False):
            local = self._down(foot.body, force)
            moment = cross(self._vector(foot.place), local)
            wrenches[foot.body] = (minus(wrenches[foot.body][0], local), minus(wrenches[foot.body][1], moment))
        for index in reversed(range(len(wrenches))):
            parent = self.robot.bodies[index].parent
            handed = self._handed(index, wrenches[index])
            if parent < 0:
                root = _both(root, handed)
            else:
                wrenches[parent] = _both(wrenches[parent], handed)
        return *root, [wrench[1][body.axis] for body, wrench in zip(self.robot.bodies, wrenches, strict=True)]

    # ---- the first foot, in the base's axes

    def bias_acceleration(self, qd: Vector) -> Vector:
        """Linear and angular acceleration at constant rates."""
        still, foot = [0, 0, 0], self.robot.feet[0]
        spin, rate, origin = self._motions((still, still, still), qd, [0] * len(qd))[foot.body]
        linear = plus(origin, _field(spin, rate, self._vector(foot.place)))
        return [*self._up(foot.body, linear), *self._up(foot.body, rate)]

    def jacobian_columns(self) -> Matrix:
        """Velocity of the foot for each joint's unit rate."""
        foot = self.robot.feet[0]
        columns = []
        for index, axis in enumerate(self.axes):
            way, body = self._vector(foot.place), foot.body
            while body != index:
                way, body = plus(self.places[body], times(self.rotations[body], way)), self.robot.bodies[body].parent
            columns.append(self._up(index, cross(axis, way)))
        return columns

    def _up(self, index: int, vector: Vector) -> Vector:
        """A vector of a body's axes in the base's."""
        lifted, parent = times(self.rotations[index], vector), self.robot.bodies[index].parent
        return lifted if parent < 0 else self._up(parent, lifted)

    def _motions(self, base: tuple[Vector, Vector, Vector], qd: Vector, qdd: Vector) -> list[tuple[Vector, Vector, Vector]]:
        """Spin, its rate and the origin's acceleration of every body, in its own axes."""
        found: list[tuple[Vector, Vector, Vector]] = []
        for index, body in enumerate(self.robot.bodies):
            spin, rate, origin = base if body.parent < 0 else found[body.parent]
            inwards = transposed(self.rotations[index])
            carried, own = times(inwards, spin), scaled(qd[index], self.axes[index])
            change = plus(times(inwards, rate), plus(scaled(qdd[index], self.axes[index]), cross(carried, own)))
            found.append((plus(carried, own), change, times(inwards, plus(origin, _field(spin, rate, self.places[index])))))
        return found

    def _inertial(self, body: Body, motion: tuple[Vector, Vector, Vector]) -> tuple[Vector, Vector]:
        """Force and moment about the body's origin that its motion needs."""
        spin, rate, origin = motion
        if self.form == "centres":
            centre, inertia = self._vector(body.centre), self._numbers(body.inertia)
            force = scaled(self._number(body.mass), plus(origin, _field(spin, rate, centre)))
            return force, plus(cross(centre, force), self._gyration(inertia, spin, rate))
        moment, inertia = self._vector(body.moment), self._numbers(body.about_origin)
        force = plus(scaled(self._number(body.mass), origin), _field(spin, rate, moment))
        return force, plus(cross(moment, origin), self._gyration(inertia, spin, rate))

    @staticmethod
    def _gyration(inertia: Matrix, spin: Vector, rate: Vector) -> Vector:
        return plus(times(inertia, rate), cross(spin, times(inertia, spin)))

    def _handed(self, index: int, wrench: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
        """A wrench of a body in its parent's axes, about the parent's origin."""
        force, moment = (times(self.rotations[index], part) for part in wrench)
        return force, plus(moment, cross(self.places[index], force))

    def _down(self, index: int, vector: Vector) -> Vector:
        """A vector of the base's axes in a body's."""
        parent = self.robot.bodies[index].parent
        return times(transposed(self.rotations[index]), vector if parent < 0 else self._down(parent, vector))

    # ---- mass matrix

    def mass_matrix(self) -> Matrix:
        """Of base (where the robot has a free one) and joints, by composite bodies."""
        composites = self._composites()
        first = 6 if self.robot.free else 0
        size = first + len(self.robot.bodies)
        found: Matrix = [[0] * size for _ in range(size)]
        for index, axis in enumerate(self.axes):
            _, moment, inertia = composites[index]
            wrench, holder = (cross(axis, moment), times(inertia, axis)), index
            while holder >= 0:
                found[first + index][first + holder] = found[first + holder][first + index] = wrench[1][self.robot.bodies[holder].axis]
                wrench, holder = self._handed(holder, wrench), self.robot.bodies[holder].parent
            for row, entry in enumerate([*wrench[0], *wrench[1]][:first]):
                found[row][first + index] = found[first + index][row] = entry
        if first:
            _fill_base(found, composites[-1])
        return found

    def _composites(self) -> list[tuple[Any, Vector, Matrix]]:
        """Mass, first moment and inertia about the origin of what each joint carries, and of the whole last."""
        found = [
            (self._number(body.mass), self._vector(body.moment), self._numbers(body.about_origin))
            for body in (*self.robot.bodies, self.robot.base)
        ]
        for index in reversed(range(len(self.robot.bodies))):
            parent = self.robot.bodies[index].parent
            found[parent] = _joined(found[parent], self._moved(index, found[index]))
        return found

    def _moved(self, index: int, composite: tuple[Any, Vector, Matrix]) -> tuple[Any, Vector, Matrix]:
        mass, moment, inertia = composite
        rotation, place = self.rotations[index], self.places[index]
        first, tensor = times(rotation, moment), product(product(rotation, inertia), transposed(rotation))
        middle = plus(first, scaled(mass, place))
        steiner = [
            minus(a, plus(b, c))
            for a, b, c in zip(_diagonal(dot(place, plus(first, middle))), outer(place, first), outer(middle, place), strict=True)
        ]
        return mass, middle, [plus(a, b) for a, b in zip(tensor, steiner, strict=True)]


def accelerations(matrix: Matrix, right: Vector) -> Vector:
    """Solves matrix x = right by L' D L (Featherstone), the last joint eliminated first."""
    size, rows, answer = len(right), [list(row) for row in matrix], list(right)
    for last in reversed(range(size)):
        for row in range(last):
            ratio = rows[last][row] / rows[last][last]
            for column in range(row + 1):
                rows[row][column] -= ratio * rows[last][column]
            rows[last][row], answer[row] = ratio, answer[row] - ratio * answer[last]
    for row in range(size):
        answer[row] = answer[row] / rows[row][row] - reduce(lambda total, k, row=row: total + rows[row][k] * answer[k], range(row), 0)
    return answer


def solved(columns: Matrix, right: Vector) -> Vector:
    """x of columns x = right, three of each, by Cramer's rule."""
    faces = [cross(columns[1], columns[2]), cross(columns[2], columns[0]), cross(columns[0], columns[1])]
    scale = 1 / dot(columns[0], faces[0])
    return [scale * dot(face, right) for face in faces]


def _field(spin: Vector, rate: Vector, way: Vector) -> Vector:
    return plus(cross(rate, way), cross(spin, cross(spin, way)))


def _both(left: tuple[Vector, Vector], right: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
    return plus(left[0], right[0]), plus(left[1], right[1])


def _joined(left: tuple[Any, Vector, Matrix], right: tuple[Any, Vector, Matrix]) -> tuple[Any, Vector, Matrix]:
    return left[0] + right[0], plus(left[1], right[1]), [plus(a, b) for a, b in zip(left[2], right[2], strict=True)]


def _diagonal(value: Any) -> Matrix:
    return [[value if row == column else 0 for column in range(3)] for row in range(3)]


def _fill_base(found: Matrix, whole: tuple[Any, Vector, Matrix]) -> None:
    mass, (x, y, z), inertia = whole
    skew = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    for row in range(3):
        found[row][row] = mass
        for column in range(3):
            found[3 + row][3 + column] = inertia[row][column]
            found[3 + row][column] = found[column][3 + row] = skew[row][column]
