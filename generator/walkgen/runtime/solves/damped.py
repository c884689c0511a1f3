"""Joint rates of a three-joint leg, damped near singular poses: the reference of walkgen_damped.h."""

from numpy.typing import ArrayLike

from walkgen.runtime.solves.damped_general import Integers, Reals, damped_inverse


def damped_inverse_3(J: ArrayLike, v: ArrayLike, epsilon: ArrayLike, lambda_max: ArrayLike) -> tuple[Reals, Integers]:
    """Joint rates qd with J qd = v where the least singular value s of J is at least epsilon, else the damped ones.

    Below epsilon, qd = J^T (J J^T + lambda^2 1)^-1 v with lambda^2 = (1 - (s/epsilon)^2) lambda_max^2, so that
    |qd| <= |v| / (2 lambda). Nakamura and Hanafusa 1986; Maciejewski and Klein 1988.

    Args:
        J: the foot's Jacobian [..., 3, 3].
        v: the foot's velocity [..., 3], m/s.
        epsilon: bound on the singular values [...], in J's unit.
        lambda_max: damping where J is singular [...], in J's unit.

    Returns:
        qd [..., 3] and status [...]: OK, SINGULAR where damping is active or J has rank below 3, or BAD_INPUT with NaN where an input
        is not finite, epsilon or lambda_max is negative, or qd exceeds the range of numbers.
    """
    return damped_inverse(J, v, 3, epsilon, lambda_max)
