"""The package around a generated robot: `__init__.py`, which loads it, and `__init__.pyi`, which tells editors what it has."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.layout import lay_out
from walkgen.emit.python_text import banner, docstring, port_line, title
from walkgen.model.gait import Gait
from walkgen.signature import Port, Signature
from walkgen.spec.checks_gait import gait_owner


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
    """All legs, chains or routes: their mapping's class, the classes of its values and what these have beside methods."""

    name: str
    base: str
    lookups: tuple[str, ...]
    groups: tuple[Group, ...]
    attributes: tuple[str, ...]


@dataclass(frozen=True)
class Part:
    """What a robot has one of: its class of the stub."""

    name: str
    attributes: tuple[str, ...]
    methods: tuple[Method, ...]


_FUNCTIONS = "functions: Mapping[str, Callable[..., Any]]"
_LIMB = ("joints: tuple[str, ...]", "slice: builtins.slice", "limits: NDArray[np.float64]", _FUNCTIONS)
_ATTRIBUTES = {
    "Leg": ("name: str", "platform: str", *_LIMB, "branch_names: tuple[str, ...]", "inverse_class: str"),
    "Chain": ("name: str", "parent: str", "child: str", *_LIMB),
    "Route": ("name: str", "owner: str", "indices: NDArray[np.intp]", _FUNCTIONS),
}
_TERRAIN = ("name: str", "patches: tuple[str, ...]", _FUNCTIONS)
_STEPPING = (
    *("name: str", "kind: str", "legs: tuple[str, ...]", "stride: float", "lift: float | None"),
    *("stance: tuple[tuple[float, float, float], ...] | None", "static: bool", "body: str", "margin: float | None", _FUNCTIONS),
)
_GAIT = (*_STEPPING, "duty_factor: tuple[float, ...]", "phase: tuple[float, ...]", "period: float", "heel_off: float")
_SCHEDULE = (*_STEPPING, "events: tuple[tuple[float, str, str], ...]", "lifted: tuple[str, ...]")
_ROBOT = (
    "name: str",
    "description: str",
    "folder: Path",
    "platforms: tuple[str, ...]",
    "joint_names: tuple[str, ...]",
    "limits: NDArray[np.float64]",
    "parameters: Mapping[str, float]",
    "legs: _Legs",
    "chains: _Chains",
    "routes: _Routes",
    _FUNCTIONS,
    'backend: Literal["c", "numpy"]',
    "backend_reason: str",
)
"""What walkgen.runtime gives a robot and its parts beside their functions."""

_WORKED = "inverse_dynamics"
_WORK = (
    "",
    "class Work(NamedTuple):",
    *(f"    {name}: NDArray[np.float64]" for name in ("joints", "total", "joints_positive", "positive")),
)
"""What the runtime's `work` of a leg with efforts gives."""
_ARRAYS = {"real": "Reals", "integer": "Integers", "truth": "Truths"}


def package_artifacts(code: RobotCode) -> tuple[Artifact, ...]:
    """`__init__.py` and `__init__.pyi` of the robot's folder."""
    robot = code.mechanism
    common = {"banner": banner(code), "title": title(code, "Python")}
    routed = tuple(leg.name for leg in robot.legs if robot.ancestors(leg.platform))
    terrain = robot.terrain is not None
    parts = (*((Part("_Terrain", _TERRAIN, _methods(code, "terrain")),) if terrain else ()), *_gaits(code))
    attributes = (*_ROBOT, *(("terrain: _Terrain",) if terrain else ()), *_gait_attributes(code))
    families = (
        _family(code, "Leg", {leg.name: leg.name for leg in robot.legs}),
        _family(code, "Chain", {chain.name: chain.name for chain in robot.chains}),
        _family(code, "Route", {name: f"root_to_{name}" for name in routed}),
    )
    real = "np.floating[Any]" if code.float32 else "np.float64"
    worked = any(body.signature.name == _WORKED for body in code.functions)
    own = {
        "records": _WORK if worked else (),
        "families": families,
        "parts": parts,
        "attributes": attributes,
        "methods": _methods(code, ""),
        "functions": _methods(code, "", "    "),
    }
    stub = lay_out("package.pyi.jinja", "__init__.pyi", **common, **own, real=real)
    return lay_out("package.py.jinja", "__init__.py", **common, robot=robot.name), stub


def _family(code: RobotCode, kind: str, owners: Mapping[str, str]) -> Family:
    """The parts of one kind; `owners` are their functions' owners by the parts' names."""
    alike: dict[tuple[Method, ...], list[str]] = {}
    for name, owner in owners.items():
        alike.setdefault(_methods(code, owner), []).append(name)
    groups = tuple(
        Group(f"_{kind}{number if len(alike) > 1 else ''}", _literal(names), methods)
        for number, (methods, names) in enumerate(alike.items(), start=1)
    )
    key, value = _literal(owners), " | ".join(group.name for group in groups) or "Never"
    return Family(f"_{kind}s", f"Mapping[{key}, {value}]", _lookups(groups, key, value), groups, _ATTRIBUTES[kind])


def _gaits(code: RobotCode) -> tuple[Part, ...]:
    """A class for each gait: they differ in what they have."""
    return tuple(
        Part(f"_Gait{number}", _GAIT if isinstance(gait, Gait) else _SCHEDULE, _methods(code, gait_owner(gait.name)))
        for number, gait in enumerate(code.mechanism.gaits, start=1)
    )


def _gait_attributes(code: RobotCode) -> tuple[str, ...]:
    gaits = code.mechanism.gaits
    classes = " | ".join(f"_Gait{number}" for number, _ in enumerate(gaits, start=1))
    return ("gait: _Gait1", f"gaits: Mapping[{_literal(gait.name for gait in gaits)}, {classes}]") if gaits else ()


def _lookups(groups: tuple[Group, ...], key: str, value: str) -> tuple[str, ...]:
    """The mapping's own methods: each name gives its own class, an unknown one of them any."""
    pairs = [*((group.key, group.name) for group in groups if len(groups) > 1), (key, value)]
    overload = ("@overload",) if len(pairs) > 1 else ()
    found = (line for given, gives in pairs for line in (*overload, f"def __getitem__(self, name: {given}, /) -> {gives}: ..."))
    return *found, f"def __iter__(self) -> Iterator[{key}]: ...", "def __len__(self) -> int: ..."


def _literal(names: Iterable[str]) -> str:
    quoted = ", ".join(f'"{name}"' for name in names)
    return f"Literal[{quoted}]" if quoted else "Never"


def _methods(code: RobotCode, owner: str, indent: str = "        ") -> tuple[Method, ...]:
    """The callables of one limb, or of the robot for an empty owner."""
    own = [body.signature for body in code.functions if body.signature.owner == owner]
    found = [_method(signature, indent) for signature in own]
    return (*found, *(_work(signature, indent) for signature in own if signature.name == _WORKED))


def _work(efforts: Signature, indent: str) -> Method:
    """What the runtime adds to a leg that has efforts."""
    parameter = ", param: ArrayLike | None = None" if efforts.inputs[-1].name == "param" else ""
    motion = ", ".join(_argument(port) for port in efforts.inputs if port.name != "param")
    given = f"{motion}, *, period: float, times: ArrayLike | None = None{parameter}"
    doc = "Work over one cycle of a sampled motion, [..., samples, n] each: signed and while power is positive, of every joint and in all."
    return Method(
        "work", given, "Work", docstring(indent, doc, "in: period s, times [samples] s; out: J", "trapezoids of effort times rate")
    )


def _method(signature: Signature, indent: str) -> Method:
    inputs = [_argument(port) for port in signature.inputs if port.name != "param"]
    keywords = [f"{port.name}: ArrayLike | None = None" for port in signature.inputs if port.name == "param"]
    keywords += [] if signature.capacities else ["out: Any = None"]
    return Method(
        signature.name,
        ", ".join([*inputs, *(["*"] if keywords else []), *keywords]),
        _returned(signature.outputs),
        docstring(indent, signature.doc or signature.name, port_line(signature), signature.source),
    )


def _argument(port: Port) -> str:
    return f"{port.name}: ArrayLike | None = None" if port.default else f"{port.name}: ArrayLike"


def _returned(ports: tuple[Port, ...]) -> str:
    kinds = [_ARRAYS[port.kind] for port in ports]
    return kinds[0] if len(kinds) == 1 else f"tuple[{', '.join(kinds)}]"
