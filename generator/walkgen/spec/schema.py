"""The tables of a spec, one model a table, one field a key: shapes and types, and the source of the JSON Schema for editors."""

import json
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, StrictBool, StrictStr, Tag, model_validator

from walkgen.spec.balance import BalanceSpec
from walkgen.spec.curved_sole import CurvedSoleSpec
from walkgen.spec.gait import TAGS as GAIT_TAGS
from walkgen.spec.gait import Gaits
from walkgen.spec.joint_tables import JointRow, LinkageEnd, Pose
from walkgen.spec.linkage import CylinderSpec, PinSpec, PlanarLinkSpec, SliderSpec, StartSpec
from walkgen.spec.linkage_forms import FiveBar, FourBar, LinkageForm, Parallelogram, Stephenson, Watt
from walkgen.spec.sole_design import SoleDesignSpec
from walkgen.spec.springs import TAGS as SPRING_TAGS
from walkgen.spec.springs import SpringSpec
from walkgen.spec.table import Number, Pair, Sign, Six, Table, Triple
from walkgen.spec.terrain import TerrainPatch

Target = Literal["c", "casadi", "numpy"]

_MOST_NAMES = 1000
_MOST_LIMBS = 100
_MOST_JOINTS = 64
_MOST_LINKS = 100
FORMS = ("four_bar", "five_bar", "watt", "stephenson", "parallelogram")
"""Keys of the short forms of linkages."""


class Damping(Table):
    """Of the inverse velocity near singularities: lambda^2 = (1 - (s/epsilon)^2) lambda_max^2 below s = epsilon."""

    epsilon: Number
    lambda_max: Number


class Design(Table):
    """Joints in series from base to tip."""

    ANGLES: ClassVar[frozenset[str]] = frozenset({"zeros"})

    dh: Literal["classic", "craig"] | None = None
    """DH convention: classic (distal) or craig (modified, proximal); there is no default."""
    joints: tuple[JointRow, ...] = Field(default=(), max_length=_MOST_JOINTS)
    signs: tuple[Sign, ...] | None = None
    """One a joint in series: mechanism angle = sign * q + zero."""
    zeros: tuple[Number, ...] | None = None
    """One a joint (rad or m)."""
    zeros_deg: tuple[Number, ...] | None = None

    @property
    def rows(self) -> tuple[JointRow, ...]:
        """All joints in series, from base to tip."""
        return self.joints


def _foot_kind(value: Any) -> str:
    return "foot:point" if isinstance(value, str) else "foot:pose"


Foot = Annotated[Annotated[StrictStr, Tag("foot:point")] | Annotated[Pose, Tag("foot:pose")], Discriminator(_foot_kind)]


class SoleSpec(Table):
    """A flat rectangle centred at the foot point: length along its x, width along its y, z away from the ground."""

    ANGLES: ClassVar[frozenset[str]] = frozenset({"rpy"})

    length: Number | None = None
    """Along the sole's x (m)."""
    length_mm: Number | None = None
    width: Number | None = None
    """Along the sole's y (m)."""
    width_mm: Number | None = None
    rpy: Triple | None = None
    """Roll, pitch, yaw of the sole in the foot frame (rad); where left out it lies in the foot frame's x-y plane."""
    rpy_deg: Triple | None = None
    """The same in degrees."""
    kn: Number | None = None
    """Stiffness of the pad along z, at each corner (N/m); rigid where left out."""
    kt: Number | None = None
    """Stiffness of the pad across z, at each corner (N/m); rigid where left out."""


class LegDesign(Design):
    """A leg, described once and mounted as often as needed."""

    foot: Foot | None = None
    """Foot frame in the frame after the last joint, its origin is the foot point; where a linkage is last a point, as link.point."""
    sole: SoleSpec | None = None
    """Rectangle on which the leg stands; on the foot point alone where left out."""
    curved_sole: CurvedSoleSpec | None = None
    """Sole that rolls over toe or heel, of a leg that ends in hip, knee and ankle."""
    damping: Damping | None = None
    branches: tuple[StrictStr, ...] | None = Field(default=None, max_length=_MOST_NAMES)
    """Names of the inverse's branches, in their fixed order."""
    springs: tuple[SpringSpec, ...] = Field(default=(), max_length=_MOST_LINKS)
    """Between its links, or a link and the mount."""

    links: dict[StrictStr, PlanarLinkSpec] = Field(default_factory=dict, max_length=_MOST_LINKS)
    """Of a planar linkage that follows the joints; the link "frame" does not move in its plane."""
    pins: tuple[PinSpec, ...] = Field(default=(), max_length=_MOST_LINKS)
    sliders: tuple[SliderSpec, ...] = Field(default=(), max_length=_MOST_LINKS)
    cylinders: tuple[CylinderSpec, ...] = Field(default=(), max_length=_MOST_LINKS)
    plane: Pose | None = None
    """Where the linkage's X (forward) and Y (up) lie in the frame after the joints."""
    joints_after: tuple[JointRow, ...] = Field(default=(), max_length=_MOST_JOINTS)
    """Joints in series at the linkage's end, from it to the foot."""
    linkage_end: LinkageEnd | None = None
    """What they hang on: a point of the linkage, and the first one's frame there."""
    assembly: dict[StrictStr, StrictStr] = Field(default_factory=dict, max_length=_MOST_LINKS)
    """The side on which each dyad is assembled, by its name; `walkgen show` lists them."""
    start: StartSpec | None = None
    """Which of its assemblies a triad has: drive values where it is assembled, and about where its links are there."""
    four_bar: FourBar | None = None
    """Short for the links and pins of a four-bar; `links` then adds masses and points to them."""
    five_bar: FiveBar | None = None
    """Short for those of a five-bar."""
    watt: Watt | None = None
    """Short for those of a Watt six-bar."""
    stephenson: Stephenson | None = None
    """Short for those of a Stephenson six-bar."""
    parallelogram: Parallelogram | None = None
    """Short for those of a parallelogram."""

    @property
    def rows(self) -> tuple[JointRow, ...]:
        """All joints in series: before the linkage, then after it."""
        return (*self.joints, *self.joints_after)

    @property
    def placed(self) -> str:
        """The point that the linkage places: its end, or the foot where no joints follow; every reference is trusted."""
        return str(self.linkage_end.point if self.joints_after and self.linkage_end else self.foot)

    @property
    def planar(self) -> bool:
        """Whether the leg has a linkage."""
        return bool(self.links or self.pins or self.sliders or self.cylinders or self.forms)

    @property
    def forms(self) -> dict[str, LinkageForm]:
        """The short forms that describe the linkage, by their keys; more than one is an error."""
        given = ((key, getattr(self, key)) for key in FORMS)
        return {key: form for key, form in given if form is not None}


class ChainDesign(Design):
    """A chain of joints that connects two platforms."""


class SectionSpec(Table):
    """A constant cross-section along the straight line between a link's two joints."""

    E: Number
    """Young's modulus (Pa)."""
    G: Number
    """Shear modulus (Pa)."""
    A: Number
    """Area (m^2)."""
    Iy: Number
    """Second moment about the link's y (m^4)."""
    Iz: Number
    """Second moment about the link's z (m^4)."""
    J: Number
    """Torsion constant (m^4)."""


class ParameterSpec(Table):
    """A named number; `runtime = true` keeps it an argument of the generated functions."""

    value: Number
    unit: StrictStr = "1"
    runtime: StrictBool = False
    bounds: Pair | None = None

    @model_validator(mode="before")
    @classmethod
    def _bare(cls, value: Any) -> Any:
        return value if isinstance(value, dict | ParameterSpec) else {"value": value}


def _end_kind(value: Any) -> str:
    return "end:word" if isinstance(value, str) else "end:pose"


End = Annotated[Annotated[Literal["level"], Tag("end:word")] | Annotated[Pose, Tag("end:pose")], Discriminator(_end_kind)]


class PlatformSpec(Table):
    """A rigid platform; the first is the root, every other hangs on its parent by a chain."""

    name: StrictStr
    parent: StrictStr | None = None
    chain: StrictStr | None = None
    """Name of the chain design between the parent and this platform."""
    root: Pose | None = None
    """Chain root on the parent."""
    end: End | None = None
    """Chain end to this platform; "level" makes it parallel to the parent at q = 0."""
    end_xyz: Triple | None = None
    """Offset of a level platform from the chain's end (m)."""
    end_xyz_mm: Triple | None = None
    mass: Number | None = None
    """kg"""
    com: Triple | None = None
    """Centre of mass in the platform's frame (m)."""
    com_mm: Triple | None = None
    inertia: Six | None = None
    """ixx, iyy, izz, ixy, ixz, iyz about the centre of mass (kg m^2)."""
    allow_unphysical: StrictBool = False
    """Accept an inertia that no real body has."""
    source_names: tuple[StrictStr, ...] | None = None
    """What the robot's makers call the chain's joints."""


class LegSpec(Table):
    """A design mounted on a platform, or the mirror image of another leg."""

    ANGLES: ClassVar[frozenset[str]] = frozenset({"zeros"})

    name: StrictStr
    design: StrictStr | None = None
    platform: StrictStr | None = None
    mount: Pose | None = None
    """The leg's first frame on the platform."""
    mirror_of: StrictStr | None = None
    """Reflect that leg in its platform's plane y = 0."""
    signs: tuple[Sign, ...] | None = None
    """Instead of the design's."""
    zeros: tuple[Number, ...] | None = None
    """Instead of the design's (rad or m)."""
    zeros_deg: tuple[Number, ...] | None = None
    sole: SoleSpec | None = None
    """Instead of the design's."""
    source_names: tuple[StrictStr, ...] | None = None
    """What the robot's makers call the joints."""


class RobotTable(Table):
    """What the robot is called and where down is."""

    name: StrictStr
    """Prefix of every generated name."""
    description: StrictStr = ""
    gravity: Triple
    """m/s^2, in the world frame for floating functions, in the first platform's for legs."""


def _functions_kind(value: Any) -> str:
    return "functions:word" if isinstance(value, str) else "functions:list"


Functions = Annotated[
    Annotated[Literal["all"], Tag("functions:word")] | Annotated[tuple[StrictStr, ...], Tag("functions:list")],
    Discriminator(_functions_kind),
]
TAGS = frozenset({"end:word", "end:pose", "foot:point", "foot:pose", "functions:word", "functions:list"}) | GAIT_TAGS | SPRING_TAGS
"""Parts of pydantic's error places that are no keys."""


class Generate(Table):
    """What is generated."""

    functions: Functions = "all"
    derivatives: StrictBool = False
    """Derivatives to the runtime parameters: <name>_d_param."""
    targets: tuple[Target, ...] = ("c", "casadi", "numpy")


class AdaptSpec(Table):
    """How `adapt` weighs a posture: joints away from the middle of their limits, platforms off the terrain's normal, clearance missed."""

    limit_weight: Number | None = None
    """Of the squared distances of all joints from the middle of their limits, in half ranges; 1 if left out."""
    normal_weight: Number | None = None
    """Of 1 - cos of the angle between a platform's z axis and the terrain's normal; 4 if left out."""
    clearance_weight: Number | None = None
    """Of the squared error of the platforms' height over their feet (1/m^2); 20 if left out and a clearance is given."""
    clearance: Number | None = None
    """Wanted height of a platform's origin over its feet, along the normal (m); without it no height is asked for."""
    clearance_mm: Number | None = None
    """The same in mm."""


class RobotSpec(Table):
    """A walking robot, as described in TOML."""

    walkgen: Literal[1]
    """Version of the spec language."""
    robot: RobotTable
    generate: Generate = Generate()
    parameters: dict[str, ParameterSpec] = Field(default_factory=dict, max_length=_MOST_NAMES)
    leg_designs: dict[str, LegDesign] = Field(default_factory=dict, max_length=_MOST_LIMBS)
    chain_designs: dict[str, ChainDesign] = Field(default_factory=dict, max_length=_MOST_LIMBS)
    sections: dict[str, SectionSpec] = Field(default_factory=dict, max_length=_MOST_NAMES)
    platforms: tuple[PlatformSpec, ...] = Field(default=(), max_length=_MOST_LIMBS)
    legs: tuple[LegSpec, ...] = Field(default=(), max_length=_MOST_LIMBS)
    terrain: tuple[TerrainPatch, ...] = Field(default=(), max_length=_MOST_LIMBS)
    adapt: AdaptSpec = AdaptSpec()
    gait: Gaits | None = None
    """One gait, or several under names of their own: [gait.tripod], [gait.wave]."""
    balance: dict[str, BalanceSpec] = Field(default_factory=dict, max_length=_MOST_LIMBS)
    """What `walkgen design --balance NAME` searches for."""
    sole_design: dict[str, SoleDesignSpec] = Field(default_factory=dict, max_length=_MOST_LIMBS)
    """What `walkgen design --sole NAME` searches for."""


def schema_json() -> str:
    """The JSON Schema of a spec, for editors: the same text whenever the language is the same."""
    return json.dumps(RobotSpec.model_json_schema(), indent=2, sort_keys=True, ensure_ascii=False) + "\n"
