"""The robot as platforms, connecting chains and legs: SI, exact numbers, no file format and no algebra system."""

from dataclasses import dataclass, replace
from typing import Literal

from walkgen.model.curved_sole import CurvedSole
from walkgen.model.gait import Gait, Schedule
from walkgen.model.linkage import Linkage
from walkgen.model.springs import Coil, Spring
from walkgen.model.terrain import Terrain
from walkgen.spec.scalar import ZERO, Scalar, Vector


@dataclass(frozen=True)
class Motion:
    """A rotation about (rad) or translation along (m) one coordinate axis (0 x, 1 y, 2 z)."""

    kind: Literal["rotate", "translate"]
    axis: int
    amount: Scalar


Transform = tuple[Motion, ...]
"""Elementary motions from left to right, as in a DH row; empty is the identity."""

CORNERS = ((1, 1), (-1, 1), (-1, -1), (1, -1))
"""A sole's corners in half lengths and half widths along its x and y: their order, once round."""


@dataclass(frozen=True)
class Body:
    """Mass (kg), centre of mass (m) and inertia about it (kg m^2: xx yy zz xy xz yz), in the body's own frame."""

    mass: Scalar
    com: Vector
    inertia: tuple[Scalar, Scalar, Scalar, Scalar, Scalar, Scalar]


@dataclass(frozen=True)
class Section:
    """Constant cross-section of a link: moduli (Pa), area (m^2), second moments (m^4), torsion constant (m^4)."""

    name: str
    E: Scalar
    G: Scalar
    A: Scalar
    Iy: Scalar
    Iz: Scalar
    J: Scalar


@dataclass(frozen=True)
class Joint:
    """One pair: parent frame -> `before` -> motion about or along z by sign*q + zero -> `after` -> the joint's frame.

    Limits, speed and effort are those of q (rad or m, per second, N m or N). `viscous` (N m s/rad or N s/m) and `coulomb`
    (N m or N) are friction in the joint, `rotor` (kg m^2 or kg) the motor's inertia as q feels it.
    """

    name: str
    kind: Literal["revolute", "prismatic"]
    before: Transform
    sign: Literal[1, -1]
    zero: Scalar
    after: Transform
    limits: tuple[Scalar, Scalar] | None = None
    max_speed: Scalar | None = None
    max_effort: Scalar | None = None
    body: Body | None = None
    section: str = ""
    source_name: str = ""
    viscous: Scalar = ZERO
    coulomb: Scalar = ZERO
    rotor: Scalar = ZERO

    @property
    def unit(self) -> str:
        """Of its q: rad or m."""
        return "rad" if self.kind == "revolute" else "m"


@dataclass(frozen=True)
class Sole:
    """A rectangle about the foot point that stands on its four corners.

    Attributes:
        length: along its x (m).
        width: along its y (m).
        turn: the rotation from the foot frame to the sole's, whose z points away from the ground.
        kn: stiffness of the pad at each corner along z (N/m), None where it is rigid.
        kt: that across z.
    """

    length: Scalar
    width: Scalar
    turn: Transform
    kn: Scalar | None
    kt: Scalar | None


@dataclass(frozen=True)
class Cam:
    """What balances one joint of a leg: a roller on a follower, pressed by a spring on a cam `on` the joint's link or on the frame.

    Attributes:
        name: of the balance.
        on: what bears the cam; the follower slides on a vertical guide of the frame, or along the link.
        joint: index in the leg's joints; its q is the link's angle from the horizontal.
        span: least and largest q (rad).
        held: where the leg's other joints are, one entry a joint.
        spring: from the link to the follower, or from the follower to the frame.
        load: what the foot carries (kg).
        start: from the hip to the roller's centre at the least q (m).
        roller: its radius (m).
        lever: from the hip to the spring's end on the link, along it, or up to its end on the frame (m).
        reach: from the roller's centre to the spring's end on the follower, down the guide or outwards along the link (m).
        centre: from the roller's centre outwards to the follower's centre of mass (m).
        masses: of the spring's end at the link and at the follower, of follower and roller (kg).
    """

    name: str
    on: Literal["link", "frame"]
    joint: int
    span: tuple[Scalar, Scalar]
    held: tuple[Scalar, ...]
    spring: Coil
    load: Scalar
    start: Scalar
    roller: Scalar
    lever: Scalar
    reach: Scalar
    centre: Scalar
    masses: tuple[Scalar, Scalar, Scalar, Scalar]


@dataclass(frozen=True)
class Limb:
    """A serial chain of joints: a leg (tip is the foot frame) or a connecting chain (tip is the child platform).

    `platform` and `child` index `Mechanism.platforms`; a leg has no child.
    `damping` is (epsilon, lambda_max) of the damped inverse, in the units of the foot's Jacobian; a leg with a linkage may have none.
    `senses`, one a joint (empty: all 1), say whether q runs with the design's own angle, so that the branches of the inverse keep
    their order under a user's signs; a reflection turns the first round, and with it the side that counts as in front.
    `branches` are the spec's names of them, empty where it gives none. A leg without `sole` stands on its foot point,
    one with `curved_sole` where that touches level ground.
    A leg with a planar linkage has it in `linkage`: `tip` is then the linkage's plane, X and Y its first two axes, and after the joints
    in series come the linkage's drives. `beyond` joints may hang on its end, and `foot` is the foot frame in the last one's. `springs`
    pull at its links; what they weigh is part of these, at the mount of the platform.
    What moves with `cams` is part of no link.
    """

    name: str
    platform: int
    mount: Transform
    joints: tuple[Joint, ...]
    tip: Transform
    child: int | None = None
    damping: tuple[Scalar, Scalar] | None = None
    senses: tuple[Literal[1, -1], ...] = ()
    branches: tuple[str, ...] = ()
    linkage: Linkage | None = None
    sole: Sole | None = None
    springs: tuple[Spring, ...] = ()
    cams: tuple[Cam, ...] = ()
    curved_sole: CurvedSole | None = None
    beyond: int = 0
    foot: Transform = ()

    @property
    def serial(self) -> tuple[Joint, ...]:
        """The joints in series: all, or those before the linkage."""
        return self.joints if self.linkage is None else self.joints[: len(self.joints) - self.beyond - self.linkage.drive_count]

    @property
    def drives(self) -> tuple[Joint, ...]:
        """Those of the linkage; none where there is none."""
        return self.joints[len(self.serial) : len(self.joints) - self.beyond]

    @property
    def distal(self) -> tuple[Joint, ...]:
        """The joints beyond the linkage, at the foot's end."""
        return self.joints[len(self.joints) - self.beyond :]

    @property
    def inner(self) -> "Limb":
        """The joints before the linkage as a limb, whose tip is the linkage's plane."""
        return replace(self, joints=self.serial, linkage=None, beyond=0, foot=())

    @property
    def outer(self) -> "Limb":
        """The joints beyond the linkage as a limb on the frame at its end."""
        return replace(self, mount=(), joints=self.distal, tip=self.foot, linkage=None, beyond=0, foot=())

    @property
    def contacts(self) -> int:
        """On how many points a leg stands."""
        if self.curved_sole:
            return len(CORNERS) if self.curved_sole.width is not None else len(CORNERS) // 2
        return len(CORNERS) if self.sole else 1


@dataclass(frozen=True)
class Platform:
    """A rigid platform; `chain` indexes `Mechanism.chains`, None for the root."""

    name: str
    chain: int | None
    body: Body | None


@dataclass(frozen=True)
class Parameter:
    """A runtime parameter: stays an argument of the generated code, `default` otherwise."""

    name: str
    default: Scalar
    unit: str
    bounds: tuple[Scalar, Scalar] | None


@dataclass(frozen=True)
class Mechanism:
    """The robot. Order of q: chains, then legs, joints from base to foot; every remaining Name is a runtime parameter.

    `terrain` is the ground that the spec describes, if it does, `gaits` are those that it names.
    `adapt_weights` are those of limits, normal (1) and clearance (1/m^2), and the clearance (m).
    """

    name: str
    description: str
    gravity: Vector
    platforms: tuple[Platform, ...]
    chains: tuple[Limb, ...]
    legs: tuple[Limb, ...]
    parameters: tuple[Parameter, ...]
    sections: tuple[Section, ...]
    adapt_weights: tuple[Scalar, Scalar, Scalar, Scalar] = (ZERO, ZERO, ZERO, ZERO)
    terrain: Terrain | None = None
    gaits: tuple[Gait | Schedule, ...] = ()

    @property
    def limbs(self) -> tuple[Limb, ...]:
        """Chains, then legs: the order of q."""
        return self.chains + self.legs

    @property
    def contacts(self) -> int:
        """On how many points all legs stand."""
        return sum(leg.contacts for leg in self.legs)

    def offset(self, limb: Limb) -> int:
        """Index in the robot's q of the limb's first joint."""
        before = self.limbs[: self.limbs.index(limb)]
        return sum(len(other.joints) for other in before)

    def ancestors(self, platform: int) -> tuple[Limb, ...]:
        """The connecting chains from the root platform to this one, root first."""
        chain = self.platforms[platform].chain
        if chain is None:
            return ()
        return (*self.ancestors(self.chains[chain].platform), self.chains[chain])
