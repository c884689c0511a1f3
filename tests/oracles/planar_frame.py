"""A planar linkage with its drives held as a frame of Euler-Bernoulli beams: an own finite-element model, read from a spec's tables.

Every link with a section is a row of straight elements along the line between its two points (of its pairs and the foot) that are farthest
apart, with a node square to every such point and a rigid arm from there; links without are rigid bodies. Pairs are Lagrange's
constraints, so nothing is shared with a calculation by free bodies.
"""

import tomllib
from itertools import combinations, pairwise

import numpy as np

Array = np.ndarray


class PlanarFrame:
    """Of one leg design at the links' poses [links, 4]: origin, cosine and sine, the frame's first; parameters at their defaults."""

    def __init__(self, text: str, poses: Array) -> None:
        self._tables = tomllib.loads(text)
        self._values = {name: each["value"] for name, each in self._tables.get("parameters", {}).items()}
        self._design = next(iter(self._tables["leg_designs"].values()))
        self._links = ["frame", *(name for name in self._design["links"] if name != "frame")]
        self._poses = np.asarray(poses, float)
        self.count = 0
        self._beams: list[tuple[Array, Array]] = []  # rows of unknowns, stiffness
        self._held: list[Array] = []
        self._bodies = {name: self._body(name) for name in self._links[1:]}
        self._constrain()

    def _number(self, entry) -> float:
        return float(self._values[entry] if isinstance(entry, str) else entry)

    def _local(self, text: str) -> tuple[str, Array]:
        link, _, point = text.partition(".")
        return link, np.array([self._number(entry) for entry in self._design["links"][link]["points"][point]])

    def _pose(self, link: str) -> tuple[Array, Array]:
        x, y, c, s = self._poses[self._links.index(link)]
        return np.array([x, y]), np.array([[c, -s], [s, c]])

    def _plane(self, link: str, point: Array) -> Array:
        origin, turn = self._pose(link)
        return origin + turn @ point

    def _used(self, link: str) -> list[Array]:
        """The points of its pairs, then the foot, in the spec's order; of a guide where q is 0."""
        pairs = [pin["joins"] for pin in self._design.get("pins", ())]
        pairs += [each["between"] for each in self._design.get("cylinders", ())]
        found = [self._local(text)[1] for joins in pairs for text in joins if text.startswith(f"{link}.")]
        for slider in self._design.get("sliders", ()):
            found += [self._local(slider["link"])[1]] if slider["link"].startswith(f"{link}.") else []
            guide = slider["guide"]
            found += [np.array([self._number(entry) for entry in guide["point"]])] if guide["link"] == link else []
        foot = self._design["foot"]
        return found + ([self._local(foot)[1]] if foot.startswith(f"{link}.") else [])

    def _attached(self, link: str) -> list[Array]:
        """The points at which it is held now."""
        found = self._used(link)
        for slider in self._design.get("sliders", ()):
            if slider["guide"]["link"] == link:
                found.append(self._here(slider))
        return found

    def _here(self, slider) -> Array:
        """The sliding point in the guide's axes."""
        origin, turn = self._pose(slider["guide"]["link"])
        return turn.T @ (self._plane(*self._local(slider["link"])) - origin)

    def _body(self, link: str) -> dict:
        section = self._design["links"][link].get("section")
        if section is None:
            self.count += 3
            return {"start": self.count - 3}
        points = self._used(link)
        a, b = max(combinations(points, 2), key=lambda two: round(float(np.linalg.norm(two[0] - two[1])), 12))
        way, length = (b - a) / np.linalg.norm(b - a), float(np.linalg.norm(b - a))
        held = [float(np.clip((point - a) @ way, 0.0, length)) for point in self._attached(link)]
        places = sorted({round(place, 12) for place in (0.0, length, *held)})
        start = self.count
        self.count += 3 * len(places)
        numbers = self._tables["sections"][section]
        for number, (near, far) in enumerate(pairwise(places)):
            self._beams.append((np.arange(6) + start + 3 * number, self._element(numbers, far - near, self._pose(link)[1] @ way)))
        return {"start": start, "places": places, "a": a, "way": way, "length": length}

    @staticmethod
    def _element(section, L: float, way: Array) -> Array:
        E, A, I = section["E"], section["A"], section["Iz"]  # noqa: E741 - the textbook's letters
        K = np.zeros((6, 6))
        K[np.ix_([0, 3], [0, 3])] = E * A / L * np.array([[1, -1], [-1, 1]])
        bent = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
        lengths = np.array([1, L, 1, L])
        K[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = E * I / L**3 * bent * np.outer(lengths, lengths)
        T = np.kron(np.eye(2), [[way[0], way[1], 0], [-way[1], way[0], 0], [0, 0, 1]])
        return T.T @ K @ T

    def moved(self, link: str, point: Array) -> Array:
        """[3, count]: how a point of a link moves along X, Y and turns."""
        T = np.zeros((3, self.count))
        if link == "frame":
            return T
        body, turn = self._bodies[link], self._pose(link)[1]
        origin, start = np.zeros(2), body["start"]
        if "places" in body:
            place = np.clip((point - body["a"]) @ body["way"], 0.0, body["length"])
            node = int(np.argmin(np.abs(np.array(body["places"]) - place)))
            start, origin = start + 3 * node, body["a"] + place * body["way"]
        x, y = turn @ (point - origin)
        T[:, start : start + 3] = [[1, 0, -y], [0, 1, x], [0, 0, 1]]
        return T

    def _constrain(self) -> None:
        for pin in self._design.get("pins", ()):
            first, *others = (self.moved(*self._local(text)) for text in pin["joins"])
            for other in others:
                self._held += [*(other - first)[: 3 if pin.get("driven") else 2]]
        for slider in self._design.get("sliders", ()):
            link = slider["guide"]["link"]
            gap = self.moved(*self._local(slider["link"])) - self.moved(link, self._here(slider))
            angle = self._number(slider["guide"]["angle"])
            along = self._pose(link)[1] @ [np.cos(angle), np.sin(angle)]
            self._held += [gap[2], -along[1] * gap[0] + along[0] * gap[1]]
            self._held += [along[0] * gap[0] + along[1] * gap[1]] if slider.get("driven") else []
        for cylinder in self._design.get("cylinders", ()):
            self._cylinder(cylinder)

    def _cylinder(self, cylinder) -> None:
        ends = [self._local(text) for text in cylinder["between"]]
        way = self._plane(*ends[1]) - self._plane(*ends[0])
        length = float(np.linalg.norm(way))
        stretch = (way / length) @ (self.moved(*ends[1]) - self.moved(*ends[0]))[:2]
        if "section" not in cylinder:
            self._held.append(stretch)
            return
        section = self._tables["sections"][cylinder["section"]]
        self._beams.append((np.arange(self.count), section["E"] * section["A"] / length * np.outer(stretch, stretch)))

    def compliance(self) -> Array:
        """[3, 3]: how far the foot moves along X, Y and turns for a unit force along X, along Y and a unit moment on its link."""
        K, C = np.zeros((self.count, self.count)), np.reshape(self._held, (-1, self.count))
        for rows, own in self._beams:
            K[np.ix_(rows, rows)] += own
        size = np.abs(K).max()
        system = np.block([[K / size, C.T], [C, np.zeros((len(C), len(C)))]])
        T = self.moved(*self._local(self._design["foot"]))
        right = np.vstack([T.T / size, np.zeros((len(C), 3))])
        found = np.linalg.solve(system, right)
        found += np.linalg.solve(system, right - system @ found)
        return np.asarray(T @ found[: self.count])
