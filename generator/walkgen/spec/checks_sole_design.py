"""Rules of a sole's design: a leg that has the curve, parameters that may move, ranges that are not crossed."""

from collections.abc import Iterator

from walkgen.spec.evaluate import Numbers
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.schema import RobotSpec
from walkgen.spec.sole_design import SoleDesignSpec
from walkgen.spec.table import Path
from walkgen.spec.tree import design_of

_RANGES = ("flat", "used", "curvature")


def check_sole_designs(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Every [sole_design.NAME]."""
    for name, table in spec.sole_design.items():
        path: Path = ("sole_design", name)
        leg = next((leg for leg in spec.legs if leg.name == table.leg), None)
        if leg is None:
            cure = did_you_mean(table.leg, (leg.name for leg in spec.legs), "legs")
            yield Finding("WG210", (*path, "leg"), f'there is no leg "{shown(table.leg)}"', cure)
        elif (design := design_of(spec, leg)) is not None and (design.curved_sole is None or design.curved_sole.toe is None):
            message = f"the leg {shown(table.leg)} has no curved sole with a toe"
            yield Finding("WG236", (*path, "leg"), message, "describe it: [leg_designs.NAME.curved_sole]")
        yield from _numbers(path, table, numbers)
        yield from _parameters(path, table, spec)


def _numbers(path: Path, table: SoleDesignSpec, numbers: Numbers) -> Iterator[Finding]:
    if table.si("thigh") is None:
        yield Finding("WG111", (*path, "thigh"), 'missing key "thigh"', "write thigh_deg = -80: its angle as the roll ends")
    for key in _RANGES:
        low, high = (numbers.number(entry) for entry in getattr(table, key) or (None, None))
        if low is not None and high is not None and low >= high:
            message = f"{key} is crossed or empty: {float(low):g} to {float(high):g}"
            yield Finding("WG160", (*path, key), message, "give the least value first")


def _parameters(path: Path, table: SoleDesignSpec, spec: RobotSpec) -> Iterator[Finding]:
    for index, name in enumerate(table.vary or ()):
        here = (*path, "vary", index)
        if name not in spec.parameters:
            yield Finding("WG141", here, f'there is no parameter "{shown(name)}"', did_you_mean(name, spec.parameters, "known parameters"))
        elif spec.parameters[name].bounds is None:
            cure = f"write {name} = {{ value = ..., bounds = [low, high] }}"
            yield Finding("WG214", here, f"the parameter {name} has no bounds to vary between", cure)
    if table.vary is None and not any(entry.bounds for entry in spec.parameters.values()):
        cure = "write depth = { value = 0.09, bounds = [0.06, 0.12] }"
        yield Finding("WG214", (*path, "vary"), "no parameter has bounds to vary between", cure)
