"""Finds the pantograph that carries a foot: a parallelogram of four links whose middle pin stays in line with a pin and the foot."""

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import permutations, product

from walkgen.spec.assur import Pair, Pantograph

Complex = tuple[Fraction, Fraction]
Places = Mapping[tuple[int, int], Complex]
"""Points by pair and body, in the body's axes, as exact numbers."""


def pantograph(pairs: Sequence[Pair], places: Places, foot_link: int, foot: Complex) -> Pantograph | None:
    """The first that is found; None where there is none.

    With K the pin of the foot's link b and another link a, B on a, E on b, I joining the two links that hang there: the sides KB and EI,
    KE and BI are equal, so I = K + (B - K) + (E - K); with complex ratios (B - K)/(T - K) and (E - K)/(F - K) that add up to 1,
    I is in line with T and the foot F.
    """
    for elbow, arm, top, upper, lower, middle in _loops(pairs, foot_link):
        points = places.get((elbow, arm)), places.get((top, arm)), places.get((upper, arm))
        own = places.get((elbow, foot_link)), places.get((lower, foot_link))
        if None in points or None in own:
            continue
        ratio = _ratio(points, own, foot)  # type: ignore[arg-type]
        if ratio is not None and _is_parallelogram(pairs, places, (arm, foot_link), (elbow, upper, lower, middle)):
            return Pantograph(top, middle, ratio)
    return None


def _loops(pairs: Sequence[Pair], foot_link: int) -> Iterator[tuple[int, int, int, int, int, int]]:
    """Pins K, link a, pins T and B on a, E on the foot's link, I that joins the links at B and E."""
    pins = [index for index, pair in enumerate(pairs) if pair.kind == "R"]
    of_foot = [pin for pin in pins if foot_link in pairs[pin].bodies]
    for elbow, arm in [(pin, body) for pin in of_foot for body in pairs[pin].bodies if body != foot_link]:
        of_arm = [pin for pin in pins if arm in pairs[pin].bodies and pin != elbow]
        for (top, upper), lower, middle in product(permutations(of_arm, 2), of_foot, pins):
            if lower != elbow and _joined(pairs, upper, middle, arm) and _joined(pairs, lower, middle, foot_link):
                yield elbow, arm, top, upper, lower, middle


def _joined(pairs: Sequence[Pair], pin: int, middle: int, link: int) -> bool:
    """Whether one other link of the pin also has the middle pin."""
    return pin != middle and bool((set(pairs[pin].bodies) - {link}) & set(pairs[middle].bodies)) and link not in pairs[middle].bodies


def _ratio(arm: tuple[Complex, Complex, Complex], own: tuple[Complex, Complex], foot: Complex) -> Complex | None:
    """(B - K)/(T - K), if with (E - K)/(F - K) it adds up to 1."""
    elbow, top, upper = arm
    spans = _minus(top, elbow), _minus(foot, own[0])
    if not all(any(span) for span in spans):
        return None
    ratio, other = _over(_minus(upper, elbow), spans[0]), _over(_minus(own[1], own[0]), spans[1])
    return ratio if ratio[0] + other[0] == 1 and ratio[1] + other[1] == 0 else None


def _is_parallelogram(pairs: Sequence[Pair], places: Places, links: tuple[int, int], pins: tuple[int, int, int, int]) -> bool:
    arm, foot_link = links
    elbow, upper, lower, middle = pins
    sides = []
    for link, end in ((arm, upper), (foot_link, lower)):
        bar = next(iter((set(pairs[end].bodies) - {link}) & set(pairs[middle].bodies)))
        sides.append((_length(places, link, elbow, end), _length(places, bar, end, middle)))
    (upper_side, upper_bar), (lower_side, lower_bar) = sides
    return None not in (upper_side, lower_side) and upper_side == lower_bar and lower_side == upper_bar


def _length(places: Places, body: int, first: int, second: int) -> Fraction | None:
    """The square of the distance between two pins of a link."""
    ends = places.get((first, body)), places.get((second, body))
    if ends[0] is None or ends[1] is None:
        return None
    x, y = _minus(ends[1], ends[0])
    return x * x + y * y


def _minus(a: Complex, b: Complex) -> Complex:
    return (a[0] - b[0], a[1] - b[1])


def _over(a: Complex, b: Complex) -> Complex:
    size = b[0] ** 2 + b[1] ** 2
    return ((a[0] * b[0] + a[1] * b[1]) / size, (a[1] * b[0] - a[0] * b[1]) / size)
