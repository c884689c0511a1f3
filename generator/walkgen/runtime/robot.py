"""What `load` gives: a robot, its legs, chains, routes, ground and gaits, with the generated functions as attributes."""

import builtins
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from walkgen.errors import Problem, ToolchainError, UnsupportedMechanism
from walkgen.runtime.absent import absent
from walkgen.runtime.calls import Function
from walkgen.runtime.manifest import FunctionEntry
from walkgen.runtime.modules import execute
from walkgen.runtime.work import Work, cycle_work


class _Owner:
    """What has functions of its own: each is also an attribute, and a missing one says why it is missing."""

    name: str
    functions: Mapping[str, Function]

    def __post_init__(self) -> None:
        self.__dict__.update(self.functions)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        joints = len(vars(self).get("joints", ())) if isinstance(self, Leg) else 0
        raise absent(type(self).__name__.lower(), self.name, name, self.functions, joints=joints)


@dataclass(frozen=True, eq=False, repr=False)
class Leg(_Owner):
    """A leg: `q` is in the order of `joints`, results are in the frame of its `platform`.

    `slice` cuts the leg's part out of the robot's q; `limits` [n,2] are infinite where the spec gives none; `branch_names`
    name the slots of `inverse`, `inverse_class` says how they are found; both are empty where there are more than three joints.
    Every function is also an attribute. An attribute that walkgen knows but this leg does not have raises
    `UnsupportedMechanism` with the reason; that error is an AttributeError too, so `hasattr` answers False.
    """

    name: str
    platform: str
    joints: tuple[str, ...]
    slice: builtins.slice
    limits: np.ndarray
    branch_names: tuple[str, ...]
    inverse_class: str
    functions: Mapping[str, Function]

    def work(
        self,
        q: ArrayLike,
        qd: ArrayLike,
        qdd: ArrayLike,
        f: ArrayLike | None = None,
        *,
        period: float,
        times: ArrayLike | None = None,
        param: ArrayLike | None = None,
    ) -> Work:
        """Work over one cycle of a sampled periodic motion: efforts of `inverse_dynamics` times rates, integrated by `cycle_work`.

        Args:
            q: joint values at the samples [..., samples, n]; the sample after the last is the first again.
            qd: their rates.
            qdd: their accelerations.
            f: the ground's force on the foot [..., samples, 3] (N), 0 where left out.
            period: of the cycle (s).
            times: of the samples [samples] (s), not falling, two alike where the force jumps; even steps where left out.
            param: the runtime parameters.

        Raises:
            UnsupportedMechanism: WG410 the leg was built without `inverse_dynamics`.
            ValueError: too few samples, or times that do not fit them and the period.
        """
        given = {} if param is None else {"param": param}
        efforts = self.inverse_dynamics(q, qd, qdd, f, **given)
        return cycle_work(efforts * np.asarray(qd, dtype=float), period, times)

    def __repr__(self) -> str:
        inverse = f"inverse {self.inverse_class}" if self.inverse_class else "inverse from a seed"
        return f"<leg {self.name!r} on {self.platform!r}: {', '.join(self.joints)}; {inverse}; {len(self.functions)} functions>"


@dataclass(frozen=True, eq=False, repr=False)
class Chain(_Owner):
    """A connecting chain from the platform `parent` to the platform `child`; its functions are also attributes, as a leg's are."""

    name: str
    parent: str
    child: str
    joints: tuple[str, ...]
    slice: builtins.slice
    limits: np.ndarray
    functions: Mapping[str, Function]

    def __repr__(self) -> str:
        return f"<chain {self.name!r} from {self.parent!r} to {self.child!r}: {', '.join(self.joints)}; {len(self.functions)} functions>"


@dataclass(frozen=True, eq=False, repr=False)
class Route(_Owner):
    """The way from the first platform through the chains to one leg's foot: q is `robot_q[..., indices]`."""

    name: str
    owner: str
    indices: np.ndarray
    functions: Mapping[str, Function]

    def __repr__(self) -> str:
        return f"<route to {self.name!r}: joints {self.indices.tolist()}; {len(self.functions)} functions>"


@dataclass(frozen=True, eq=False, repr=False)
class Terrain(_Owner):
    """The ground that the spec describes, in the world frame; its functions take points [3] and are also attributes.

    `patches` are the patches' names: what `patch` gives is an index into them, or -1 off every patch.
    """

    name: str
    patches: tuple[str, ...]
    functions: Mapping[str, Function]

    def __repr__(self) -> str:
        return f"<terrain: {', '.join(self.patches)}; {len(self.functions)} functions>"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Stepping(_Owner):
    """What gaits of both sorts have: numbers, those of legs in the order of `legs`, and functions of time, which are also attributes.

    `lift`, `stance` [k][3] in the first platform's frame and `margin` in m; None is what the spec leaves out.
    """

    name: str
    kind: str
    legs: tuple[str, ...]
    stride: float
    lift: float | None
    stance: tuple[tuple[float, float, float], ...] | None
    static: bool
    body: str
    margin: float | None
    functions: Mapping[str, Function]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Gait(Stepping):
    """A periodic gait of the spec.

    `duty_factor` and `phase` are in periods, `period` in s, `stride` along x in a period, in m; `heel_off` is the share of its support
    after which a foot with a curved sole rolls over its toe.
    `walkgen.gait.pattern.Gait.of` makes a gait of walkgen.gait of it.
    """

    duty_factor: tuple[float, ...]
    phase: tuple[float, ...]
    period: float
    heel_off: float

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<gait{name}: {self.kind}, {self.period:g} s, {len(self.functions)} functions>"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Schedule(Stepping):
    """A gait of the spec that is a list of events: (time in s, leg, "lift" or "place").

    `lifted` are in transfer before the first one; `stride` along x in all, in m.
    `walkgen.gait.schedule.Schedule.of` makes a schedule of walkgen.gait of it.
    """

    events: tuple[tuple[float, str, str], ...]
    lifted: tuple[str, ...]

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<gait{name}: {len(self.events)} events, {len(self.functions)} functions>"


@dataclass(frozen=True, eq=False, repr=False)
class Robot:
    """A loaded robot; functions take array-likes with leading batch dimensions and broadcast as ufuncs do.

    `functions` has every function by its full name; the robot's own (`foot_positions`, ...) are also attributes.
    `backend` is "c" or "numpy" and `backend_reason` says why; `limits` [nq,2] are infinite where the spec gives none;
    `parameters` are the runtime parameters' default values; `terrain` is there where the spec describes the ground,
    `gait`, the first of its `gaits`, where it has any.
    """

    name: str
    description: str
    folder: Path
    platforms: tuple[str, ...]
    joint_names: tuple[str, ...]
    limits: np.ndarray
    parameters: Mapping[str, float]
    legs: Mapping[str, Leg]
    chains: Mapping[str, Chain]
    routes: Mapping[str, Route]
    terrain: Terrain | None
    gaits: Mapping[str, Gait | Schedule]
    functions: Mapping[str, Function]
    backend: str
    backend_reason: str
    entries: tuple[FunctionEntry, ...] = field(default=())

    def __post_init__(self) -> None:
        self.__dict__.update(self._own())
        if self.terrain is None:
            del self.__dict__["terrain"]  # so that asking for it says why there is none
        if self.gaits:
            self.__dict__["gait"] = next(iter(self.gaits.values()))

    def _own(self) -> dict[str, Function]:
        signatures = [entry.signature for entry in self.entries if not entry.signature.owner]
        return {signature.name: self.functions[signature.full_name] for signature in signatures if signature.full_name in self.functions}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        raise absent("robot", self.name, name, self._own())

    def __repr__(self) -> str:
        parts = (f"{len(self.platforms)} platforms", f"{len(self.legs)} legs", f"{len(self.joint_names)} joints")
        return f"<robot {self.name!r}: {', '.join(parts)}, {len(self.functions)} functions in {self.backend} ({self.backend_reason})>"

    def __reduce__(self) -> tuple[Callable[[Path], "Robot"], tuple[Path]]:
        """Pickled and copied by its folder: the functions live in a library that each process loads for itself."""
        return _load_again, (self.folder,)

    def casadi(self, name: str) -> Any:
        """The function as a `casadi.Function`: same argument order, statuses as doubles, `param` last.

        Args:
            name: full name, or without the robot's prefix: `front_left_foot_position`.

        Raises:
            UnsupportedMechanism: WG411 the function has no CasADi form.
            ToolchainError: WG412 casadi is not installed, or the robot was built without the CasADi target.
            AttributeError: there is no such function.
        """
        entries = {entry.signature.full_name: entry for entry in self.entries}
        entry = entries.get(f"{self.name}_{name}") or entries.get(name)
        if entry is None:
            raise absent("robot", self.name, name, (full.removeprefix(f"{self.name}_") for full in entries))
        if not entry.casadi:
            cure = "use the C or NumPy function; `casadi` in manifest.json says which have a form"
            raise UnsupportedMechanism(Problem("WG411", f"{entry.signature.full_name} has no CasADi form", cure))
        return self._casadi_module.function(entry.signature.full_name)

    @cached_property
    def _casadi_module(self) -> Any:
        path = self.folder / f"{self.name}_casadi.py"
        try:
            return execute(path)
        except FileNotFoundError as error:
            problem = Problem("WG412", f"{path} was not built", 'add "casadi" to [generate] targets and build again')
            raise ToolchainError(problem) from error
        except ModuleNotFoundError as error:
            raise ToolchainError(
                Problem("WG412", f"{path.name} needs {error.name}, which is not installed", "pip install casadi")
            ) from error


def _load_again(folder: Path) -> Robot:
    """`load`, found when it is called: its module stands on this one."""
    robot: Robot = import_module("walkgen.runtime").load(folder)
    return robot
