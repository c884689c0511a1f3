"""The package around a generated robot: `__init__.py`, which loads it, and `__init__.pyi`, which tells editors what it has."""

from collections.abc import Iterable
from dataclasses import dataclass

from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.layout import lay_out
from walkgen.emit.python_text import banner, port_line, printable, title
from walkgen.model.mechanism import Limb
from walkgen.signature import Port, Signature


@dataclass(frozen=True)
class Method:
    """One callable of the stub."""

    name: str
    parameters: str
    returns: str
    doc: tuple[str, ...]


@dataclass(frozen=True)
class Group:
    """Limbs with the same callables share a class of the stub; `key` is the Literal of their names."""

    name: str
    key: str
    methods: tuple[Method, ...]


@dataclass(frozen=True)
class Family:
    """All legs, or all chains: the classes of their mapping and of its values, and what both say beside their methods."""

    name: str
    base: str
    lookups: tuple[str, ...]
    groups: tuple[Group, ...]
    attributes: tuple[str, ...]


_ROBOT = (
    "name: str",
    "legs: _Legs",
    "chains: _Chains",
    "platforms: tuple[str, ...]",
    "parameters: Mapping[str, float]",
    "joint_names: tuple[str, ...]",
    "limits: NDArray[np.float64]",
    "functions: Mapping[str, Callable[..., Any]]",
    'backend: Literal["c", "numpy"]',
)
_ATTRIBUTES = {
    "Leg": ("name: str", "platform: str", "joint_names: tuple[str, ...]", "slice: builtins.slice", "branch_names: tuple[str, ...]"),
    "Chain": ("name: str", "parent: str", "child: str", "joint_names: tuple[str, ...]", "slice: builtins.slice"),
}


def package_artifacts(code: RobotCode) -> tuple[Artifact, ...]:
    """`__init__.py` and `__init__.pyi` of the robot's folder."""
    robot = code.mechanism
    common = {"banner": banner(code), "title": title(code, "Python")}
    legs, chains = (_family(code, kind, limbs) for kind, limbs in (("Leg", robot.legs), ("Chain", robot.chains)))
    real = "np.floating[Any]" if code.float32 else "np.float64"
    own = {"families": [legs, chains], "attributes": _ROBOT, "methods": _methods(code, "")}
    stub = lay_out("package.pyi.jinja", "__init__.pyi", **common, **own, real=real)
    return lay_out("package.py.jinja", "__init__.py", **common, robot=robot.name), stub


def _family(code: RobotCode, kind: str, limbs: tuple[Limb, ...]) -> Family:
    alike: dict[tuple[Method, ...], list[str]] = {}
    for limb in limbs:
        alike.setdefault(_methods(code, limb.name), []).append(limb.name)
    groups = tuple(
        Group(f"_{kind}{number if len(alike) > 1 else ''}", _literal(names), methods)
        for number, (methods, names) in enumerate(alike.items(), start=1)
    )
    key, value = _literal(limb.name for limb in limbs), " | ".join(group.name for group in groups) or "Never"
    return Family(f"_{kind}s", f"Mapping[{key}, {value}]", _lookups(groups, key, value), groups, _ATTRIBUTES[kind])


def _lookups(groups: tuple[Group, ...], key: str, value: str) -> tuple[str, ...]:
    """The mapping's `[]`: each name gives its own class, an unknown one of them any."""
    if len(groups) < 2:
        return ("...",)
    pairs = [*((group.key, group.name) for group in groups), (key, value)]
    return tuple(line for given, gives in pairs for line in ("@overload", f"def __getitem__(self, name: {given}, /) -> {gives}: ..."))


def _literal(names: Iterable[str]) -> str:
    quoted = ", ".join(f'"{name}"' for name in names)
    return f"Literal[{quoted}]" if quoted else "Never"


def _methods(code: RobotCode, owner: str) -> tuple[Method, ...]:
    """The callables of one limb, or of the robot for an empty owner."""
    return tuple(_method(body.signature) for body in code.functions if body.signature.owner == owner)


def _method(signature: Signature) -> Method:
    inputs = [f"{port.name}: ArrayLike" for port in signature.inputs if port.name != "param"]
    keywords = ["*", *(f"{port.name}: ArrayLike | None = None" for port in signature.inputs if port.name == "param"), "out: Any = None"]
    lines = (signature.doc, port_line(signature), signature.source)
    return Method(
        signature.name,
        ", ".join([*inputs, *keywords]),
        _returned(signature.outputs),
        tuple(printable(line) for line in lines if line),
    )


def _returned(ports: tuple[Port, ...]) -> str:
    kinds = ["Integers" if port.kind == "integer" else "Reals" for port in ports]
    return kinds[0] if len(kinds) == 1 else f"tuple[{', '.join(kinds)}]"
