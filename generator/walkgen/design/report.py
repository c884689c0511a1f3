"""What a search for springs found, as a table for people."""

from collections.abc import Iterator

from walkgen.design.balance import Residue
from walkgen.design.search import Designed

_UNITS = {"rad": ("N m", "J"), "m": ("N", "J")}


def report(found: Designed) -> str:
    """Values of the parameters, lengths of the springs, moments before and after on a dense grid, energy of a stride."""
    return "\n".join(["found:", *_values(found), "springs:", *_springs(found), "left for the drives:", *_moments(found)])


def _values(found: Designed) -> Iterator[str]:
    for name, value in found.values.items():
        entry = found.balance.spec.parameters[name]
        unit = f" {entry.unit}" if entry.unit != "1" else ""
        yield f"  {name} = {value:.9g}{unit}"


def _springs(found: Designed) -> Iterator[str]:
    for spring, (low, high, free) in zip(found.balance.leg.springs, found.lengths.T, strict=True):
        share = f", {low / free:.4f} to {high / free:.4f} of its free length" if free > 0 else ""
        yield f"  {spring.name} is {low:.4g} to {high:.4g} m long{share}"


def _moments(found: Designed) -> Iterator[str]:
    yield f"  {'':22}{'no springs':>24}{'as in the spec':>24}{'found':>24}"
    for rows in zip(found.before, found.given, found.after, strict=True):
        each = rows[0].range
        force, energy = _UNITS[each.unit]
        for words, key, unit in (
            (f"{each.phase} {each.name} rms", "rms", force),
            ("  largest", "largest", force),
            ("  work", "work", energy),
        ):
            yield f"  {words:22}" + "".join(f"{getattr(row, key):>20.5g} {unit:3}" for row in rows)
    strides = (stride(rows) for rows in (found.before, found.given, found.after))
    yield f"  {'energy of a stride':22}" + "".join(f"{energy:>20.5g} J  " for energy in strides)


def stride(residues: tuple[Residue, ...]) -> float:
    """Of every range once: what drives give and take, nothing regained (J)."""
    return sum(residue.work for residue in residues)
