"""Parameters of a spec that a search may move: as variables between their bounds, and as arguments of all that is derived."""

from collections.abc import Mapping, Sequence
from fractions import Fraction

from walkgen.design.problem import Variable
from walkgen.model.values import Values
from walkgen.spec.scalar import exact
from walkgen.spec.schema import RobotSpec


def with_values(spec: RobotSpec, settings: Mapping[str, float]) -> RobotSpec:
    """With other values of parameters."""
    found = {name: spec.parameters[name].model_copy(update={"value": exact(Fraction(value))}) for name, value in settings.items()}
    return spec.model_copy(update={"parameters": {**spec.parameters, **found}})


def freed(spec: RobotSpec, names: Sequence[str]) -> RobotSpec:
    """With parameters that may move: arguments of all that is derived."""
    values = Values.of(spec.parameters)
    found = {
        name: spec.parameters[name].model_copy(
            update={"runtime": True, "value": exact(Fraction(values.number(spec.parameters[name].value)))}
        )
        for name in names
    }
    return spec.model_copy(update={"parameters": {**spec.parameters, **found}})


def varied(spec: RobotSpec, vary: Sequence[str] | None) -> tuple[str, ...]:
    """Names of the parameters that may move: those that are listed, else all with bounds that are not runtime parameters."""
    bounded = (key for key, entry in spec.parameters.items() if entry.bounds and not entry.runtime)
    return tuple(vary or bounded)


def variables_of(spec: RobotSpec, names: Sequence[str]) -> tuple[Variable, ...]:
    """With the spec's values."""
    values = Values.of(spec.parameters)
    found = []
    for name in names:
        entry = spec.parameters[name]
        low, high = (values.number(bound) for bound in entry.bounds or ())
        found.append(Variable(name, low, high, values.number(entry.value), entry.unit))
    return tuple(found)
