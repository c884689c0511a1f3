"""Where the self-test looks: fixed joint values that are exact in a double, of linkages those that assemble."""

from collections.abc import Iterator, Mapping
from itertools import islice
from typing import Any

from walkgen.emit.reference import Numbers, Sample
from walkgen.model.closing import KnownStart, closed
from walkgen.model.drive_ranges import drive_ranges, reach
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults
from walkgen.symbolic.rate_damping import rate_damping

SAMPLES = 3
_CONDITION = CONTEXT.mpf("0.05")
_TRIES, _LEAST_SINE, _FAR = 24, CONTEXT.mpf("0.1"), 8
_GRAIN = 1024


def samples_of(robot: Mechanism, path: tuple[Limb, ...], start: KnownStart | None = None) -> list[Sample]:
    """Of limbs end to end, the last with this start if it has triads.

    Fewer than `SAMPLES` where a linkage assembles for few of the values that are tried.
    """
    joints, serial = [joint for limb in path for joint in limb.joints], [joint for limb in path for joint in limb.serial]
    beyond = len(joints) - path[-1].beyond
    drives = islice(_assembled(robot, path[-1], start), SAMPLES)
    samples = []
    for index, driven in enumerate(drives):
        own = (_value(joint, place, index, 0) for place, joint in enumerate(path[-1].distal, beyond))
        q = (*(_value(joint, place, index, 0) for place, joint in enumerate(serial)), *driven, *own)
        qd, qdd = (tuple(_value(joint, place, index, salt) for place, joint in enumerate(joints)) for salt in (1, 2))
        force = tuple(CONTEXT.mpf(value) / 4 for value in (3 - index, 5, index - 7))
        samples.append(Sample(robot, path, q, qd, qdd, force, start))
    return samples


def robot_rows(robot: Mechanism, starts: Mapping[str, KnownStart]) -> list[Numbers]:
    """Joint values of the whole robot; none where a leg's linkage has no sample."""
    found = [samples_of(robot, (limb,), starts.get(limb.name)) for limb in robot.limbs]
    if not all(found):
        return []
    turns = ([(samples, index + place) for place, samples in enumerate(found)] for index in range(SAMPLES))
    return [[value for samples, turn in row for value in samples[turn % len(samples)].q] for row in turns]


def apart(sample: Sample) -> tuple[Any, ...] | None:
    """The sample's q with sliding drives so far out that the linkage does not assemble; None where it still does, or triads run away."""
    leg = sample.limbs[-1]
    assert leg.linkage is not None
    if leg.linkage.forward.triads:
        return None
    first, last = len(leg.serial), len(leg.joints) - leg.beyond
    far = _rounded(_FAR * reach(sample.mechanism, leg.linkage))
    driven = [far if joint.kind == "prismatic" else q for joint, q in zip(leg.drives, sample.q[first:last], strict=True)]
    found = closed(leg.linkage, defaults(sample.mechanism), driven)
    return None if found else (*sample.q[:first], *driven, *sample.q[last:])


def is_regular(sample: Sample) -> bool:
    """Far enough from singularities and from damping that an inverse is well conditioned."""
    leg = sample.limbs[-1]
    least = 0 if leg.child is not None else CONTEXT.mpf(str(rate_damping(sample.mechanism, leg)[0]))
    sizes = _sizes(sample.jacobian)
    scaled = sizes if leg.linkage is None else _sizes([_unit(column) for column in sample.jacobian])
    return bool(min(sizes) > 2 * least and min(scaled) > _CONDITION * max(scaled))


def _sizes(columns: list[Numbers]) -> Any:
    return CONTEXT.svd_r(CONTEXT.matrix(columns), compute_uv=False)


def _unit(column: Numbers) -> Numbers:
    """The column without the units of its drive, which are not those of the others."""
    size = CONTEXT.norm(column) or CONTEXT.one
    return [entry / size for entry in column]


def _assembled(robot: Mechanism, leg: Limb, start: KnownStart | None) -> Iterator[list[Any]]:
    """Values of the drives where the linkage assembles and no dyad is near its dead point."""
    if leg.linkage is None:
        yield from ([] for _ in range(SAMPLES))
        return
    for index in range(_TRIES):
        drives = _drives(robot, leg, leg.linkage, index)
        posture = closed(leg.linkage, defaults(robot), drives, start)
        if posture and all(abs(CONTEXT.sin(angle)) > _LEAST_SINE for angle in posture.angles):
            yield drives


def _drives(robot: Mechanism, leg: Limb, linkage: Linkage, index: int) -> list[Any]:
    shares = ((29 * place + 17 * index + 7 * (place + 1) * (index + 2)) % 15 + 1 for place in range(linkage.drive_count))
    return [_rounded(low + share * (high - low) / 16) for share, (low, high) in zip(shares, drive_ranges(robot, leg, linkage), strict=True)]


def _rounded(value: Any) -> Any:
    return CONTEXT.nint(value * _GRAIN) / _GRAIN


def _value(joint: Joint, place: int, index: int, salt: int) -> Any:
    """A fixed number of sixteenths, scattered over both signs and never 0, so that it is exact in a double."""
    scattered = (29 * place + 17 * index + 11 * salt + 7 * (place + 1) * (index + 2)) % 40 - 20
    return CONTEXT.mpf(scattered if scattered else 9) / (16 if joint.kind == "revolute" else 64)
