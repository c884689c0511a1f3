"""What was found, as a table for people."""

from collections.abc import Iterator

import numpy as np

from walkgen.design.balance import Residue
from walkgen.design.cam import Profile
from walkgen.design.cam_search import CamDesigned
from walkgen.design.search import Designed

_UNITS = {"rad": ("N m", "J"), "m": ("N", "J")}


def report(found: Designed | CamDesigned) -> str:
    """Of springs values of the parameters and lengths, of a cam its shape; moments before and after, energy of a stride."""
    if isinstance(found, CamDesigned):
        return "\n".join([*_varied(found), "cam:", *_shape(found.profile), "left for the drives:", *_moments(found)])
    return "\n".join(["found:", *_values(found), "springs:", *_springs(found), "left for the drives:", *_moments(found)])


def columns(found: Designed | CamDesigned) -> tuple[tuple[str, tuple[Residue, ...]], ...]:
    """What is compared, with its words: moments without anything, with what the spec says, with what was found."""
    if isinstance(found, CamDesigned):
        return (("no cam", found.before), ("with it", found.after))
    return (("no springs", found.before), ("as in the spec", found.given), ("found", found.after))


def _varied(found: CamDesigned) -> Iterator[str]:
    """What was found, and the cam that it stands for."""
    if found.values:
        yield from ("found:", *_values(found))
    if found.given is not None:
        yield from ("cam of the spec:", *_shape(found.given))


def _shape(cut: Profile) -> Iterator[str]:
    yield f"  {len(cut.phi)} points, {cut.r.min():.4g} to {cut.r.max():.4g} m from the hip to the roller's centre"
    yield f"  pressure angle at most {np.rad2deg(np.abs(cut.pressure).max()):.4g} degrees"
    yield f"  the roller is pressed with {np.abs(cut.force).min():.4g} to {np.abs(cut.force).max():.4g} N"
    side = float(np.sign(cut.force[0]))
    bend = float((side * cut.curvature).max())
    if bend > 0.0:
        yield f"  a roller of less than {1.0 / bend:.4g} m does not cut into it"
    yield f"  its spring is {cut.lengths.min():.4g} to {cut.lengths.max():.4g} m long"


def _values(found: Designed | CamDesigned) -> Iterator[str]:
    for name, value in found.values.items():
        entry = found.balance.spec.parameters[name]
        unit = f" {entry.unit}" if entry.unit != "1" else ""
        yield f"  {name} = {value:.9g}{unit}"


def _springs(found: Designed) -> Iterator[str]:
    for spring, (low, high, free) in zip(found.balance.leg.springs, found.lengths.T, strict=True):
        share = f", {low / free:.4f} to {high / free:.4f} of its free length" if free > 0 else ""
        yield f"  {spring.name} is {low:.4g} to {high:.4g} m long{share}"


def _moments(found: Designed | CamDesigned) -> Iterator[str]:
    compared = columns(found)
    yield f"  {'':22}" + "".join(f"{words:>24}" for words, _ in compared)
    for rows in zip(*(residues for _, residues in compared), strict=True):
        each = rows[0].range
        force, energy = _UNITS[each.unit]
        for words, key, unit in (
            (f"{each.phase} {each.name} rms", "rms", force),
            ("  largest", "largest", force),
            ("  work", "work", energy),
        ):
            yield f"  {words:22}" + "".join(f"{getattr(row, key):>20.5g} {unit:3}" for row in rows)
    strides = (stride(residues) for _, residues in compared)
    yield f"  {'energy of a stride':22}" + "".join(f"{energy:>20.5g} J  " for energy in strides)


def stride(residues: tuple[Residue, ...]) -> float:
    """Of every range once: what drives give and take, nothing regained (J)."""
    return sum(residue.work for residue in residues)
