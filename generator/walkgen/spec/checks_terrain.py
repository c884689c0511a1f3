"""Rules of the ground: keys of each kind of surface, domains, names that are its own, expressions with a value, height maps."""

from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path as Folder

from walkgen.spec.evaluate import Numbers, Uncomputable
from walkgen.spec.heightmap import HeightGrid, HeightMapError, read_heights
from walkgen.spec.problems import Finding, shown
from walkgen.spec.scalar import Scalar, names
from walkgen.spec.schema import RobotSpec
from walkgen.spec.table import Path
from walkgen.spec.terrain import COORDINATES, TerrainPatch

VARIABLES: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "explicit": {"height": ("x", "y")},
    "implicit": {"f": ("x", "y", "z")},
    "parametric": {"x": ("u", "v"), "y": ("u", "v"), "z": ("u", "v")},
    "plane": {"point": (), "normal": ()},
    "heightmap": {"file": (), "spacing": ()},
}
"""The keys that each kind of surface needs, and the coordinates that their expressions may use."""

_OPTIONAL = {"heightmap": ("interpolation",)}
_SURFACE_KEYS = ("height", "f", "x", "y", "z", "point", "normal", "file", "spacing", "interpolation")
_SAMPLES = (0.5, 0.25, 0.8125, 0.0625, 0.9375)
_SLACK = 1e-9
OWNER = "terrain"
"""Whose functions those of the ground are."""


def check_terrain(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Keys, domains and expressions of every patch, and names that the ground takes."""
    for index, patch in enumerate(spec.terrain):
        yield from _keys(index, patch)
        yield from _domain(index, patch, numbers)
        yield from _undefined(index, patch, numbers)
    yield from _coordinates(spec)
    yield from _owner(spec)


def _keys(index: int, patch: TerrainPatch) -> Iterator[Finding]:
    needed = VARIABLES[patch.surface]
    for key in _SURFACE_KEYS:
        given = getattr(patch, key) is not None
        if key in needed and not given:
            yield Finding("WG111", ("terrain", index, key), f'missing key "{key}" of a surface "{patch.surface}"', f"write {key} = ...")
        elif given and key not in needed and key not in _OPTIONAL.get(patch.surface, ()):
            cure = f"a {patch.surface} surface has: {', '.join(needed)}"
            yield Finding("WG124", ("terrain", index, key), f'{key} does not belong to a surface "{patch.surface}"', cure)


def _domain(index: int, patch: TerrainPatch, numbers: Numbers) -> Iterator[Finding]:
    """Parametric surfaces have a bounded domain in u and v, the others one in x and y or none."""
    own = ("u", "v") if patch.surface == "parametric" else ("x", "y")
    for key in ("x", "y", "u", "v"):
        pair = getattr(patch.domain, key, None)
        place: Path = ("terrain", index, "domain", key)
        if pair and key not in own:
            cure = f"its domain has {' and '.join(own)}"
            yield Finding("WG124", place, f'a domain in {key} does not belong to a surface "{patch.surface}"', cure)
        elif not pair and key in own and patch.surface == "parametric":
            message = f'missing key "{key}" of the domain of a parametric surface'
            yield Finding("WG111", place if patch.domain else place[:3], message, "write domain = { u = [0, 1], v = [0, 1] }")
        low, high = (numbers.number(bound) for bound in pair) if pair else (None, None)
        if low is not None and low == high:
            yield Finding("WG160", place, f"{key} is empty: both ends are {float(low):g}", f"write {key} = [least, largest]")


def _undefined(index: int, patch: TerrainPatch, numbers: Numbers) -> Iterator[Finding]:
    """An expression has a value somewhere in its domain."""
    for key, variables in VARIABLES[patch.surface].items():
        scalar = getattr(patch, key)
        used = tuple(name for name in variables if isinstance(scalar, Scalar) and name in names(scalar))
        if used:
            try:
                _tried(scalar, used, patch, numbers)
            except Uncomputable as error:
                message = f"no value anywhere that was tried in its domain: {error}"
                yield Finding("WG164", ("terrain", index, key), message, "mend the expression, the domain, or the parameters that it uses")


def _tried(scalar: Scalar, used: tuple[str, ...], patch: TerrainPatch, numbers: Numbers) -> None:
    """Raise the last reason if no sample has a value."""
    spans = {name: _span(getattr(patch.domain, name, None), numbers) for name in used}
    failure: Uncomputable | None = None
    for shares in product(_SAMPLES, repeat=len(used)):
        point = {name: spans[name][0] + share * (spans[name][1] - spans[name][0]) for name, share in zip(used, shares, strict=True)}
        at = Numbers(numbers.constants, {**numbers.values, **point}, numbers.terms)
        try:
            at.value(scalar)
        except Uncomputable as error:
            failure = error
        else:
            return
    if failure:
        raise failure


def _span(pair: tuple[Scalar, Scalar] | None, numbers: Numbers) -> tuple[float, float]:
    low, high = (numbers.number(bound) for bound in pair) if pair else (None, None)
    return (-1.0, 1.0) if low is None or high is None else (float(low), float(high))


def _coordinates(spec: RobotSpec) -> Iterator[Finding]:
    """A parameter called like a coordinate would mean two things in an expression."""
    used = {name for patch in spec.terrain for variables in VARIABLES[patch.surface].values() for name in variables}
    for name in COORDINATES:
        if name in spec.parameters and name in used:
            message = f'"{name}" is a coordinate in the expressions of the terrain'
            yield Finding("WG135", ("parameters", name), message, "give the parameter another name")


def _owner(spec: RobotSpec) -> Iterator[Finding]:
    """The ground's functions are called terrain_..., so nothing else may be."""
    places: list[tuple[Path, str]] = [(("legs", index, "name"), leg.name) for index, leg in enumerate(spec.legs)]
    places += [(("platforms", index, "name"), platform.name) for index, platform in enumerate(spec.platforms)]
    for path, name in places:
        if spec.terrain and name == OWNER:
            yield Finding("WG133", path, f"the functions of the ground are called {shown(spec.robot.name)}_{OWNER}_...", "rename it")


def check_height_maps(spec: RobotSpec, numbers: Numbers, folder: Folder) -> Iterator[Finding]:
    """Every height map can be read and covers its domain."""
    for index, patch in enumerate(spec.terrain):
        if patch.surface == "heightmap" and patch.file is not None:
            try:
                grid = read_heights(folder, patch.file)
            except HeightMapError as error:
                message = f'"{shown(patch.file)}" is no height map: {shown(str(error), 200)}'
                cure = "give lines of numbers (m), each with as many; y grows from line to line, x from column to column"
                yield Finding("WG168", ("terrain", index, "file"), message, cure)
            else:
                yield from _covered(index, patch, grid, numbers)


def _covered(index: int, patch: TerrainPatch, grid: HeightGrid, numbers: Numbers) -> Iterator[Finding]:
    spacing = numbers.number(patch.spacing)
    for key, points in (("x", grid.columns), ("y", grid.rows)):
        pair = getattr(patch.domain, key, None)
        low, high = (numbers.number(bound) for bound in pair) if pair else (None, None)
        if None in (low, high, spacing):
            continue
        length, reach = float(high) - float(low), float(spacing) * (points - 1)  # type: ignore[arg-type]
        if length > reach * (1 + _SLACK):
            message = f"the domain is {length:g} m long in {key}; the map's {points} points reach {reach:g} m from its lower end"
            end = float(low) + reach  # type: ignore[arg-type]
            yield Finding("WG169", ("terrain", index, "domain", key), message, f"end it at {end:g}, or change the spacing")
