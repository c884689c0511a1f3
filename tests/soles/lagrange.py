"""The leg's equations of motion by Lagrange with sympy: hip x and y and the angles of three links, contact forces as generalised forces."""

from functools import cache

import numpy as np
import sympy
from rolling_robots import CENTRES, GRAVITY, INERTIAS, MASSES, SHANK, THIGH

COUNT = 5


def _symbols(name):
    return sympy.symbols(f"{name}:{COUNT}")


def _turned(angle, vector):
    c, s = sympy.cos(angle), sympy.sin(angle)
    return sympy.Matrix([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


@cache
def equations():
    """(q, qd, qdd, lever, slope) -> d/dt dL/dqd - dL/dq [5], the place of the foot's point at `lever` by q [2, 5], dE/dt, E."""
    q, qd, qdd, lever, slope = _symbols("q"), _symbols("qd"), _symbols("qdd"), sympy.symbols("r:2"), sympy.Symbol("slope")
    hip = sympy.Matrix(q[:2])
    knee = hip + _turned(q[2], (sympy.Rational(str(THIGH)), 0))
    ankle = knee + _turned(q[3], (sympy.Rational(str(SHANK)), 0))
    kinetic, potential = 0, 0
    for start, angle, rate, mass, inertia, centre in zip((hip, knee, ankle), q[2:], qd[2:], MASSES, INERTIAS, CENTRES, strict=True):
        place = start + _turned(angle, [sympy.Rational(str(entry)) for entry in centre])
        velocity = place.jacobian(q) * sympy.Matrix(qd)
        kinetic += mass * velocity.dot(velocity) / 2 + inertia * rate**2 / 2
        potential += mass * GRAVITY * (sympy.cos(slope) * place[1] + sympy.sin(slope) * place[0])
    momenta = sympy.Matrix([kinetic]).jacobian(qd)
    left = momenta.jacobian(q) * sympy.Matrix(qd) + momenta.jacobian(qd) * sympy.Matrix(qdd)
    left -= sympy.Matrix([kinetic - potential]).jacobian(q).T
    point = (ankle + _turned(q[4], lever)).jacobian(q)
    energy = sympy.Matrix([kinetic + potential])
    power = energy.jacobian(q) * sympy.Matrix(qd) + energy.jacobian(qd) * sympy.Matrix(qdd)
    return tuple(sympy.lambdify((q, qd, qdd, lever, slope), part, "numpy") for part in (left, point, power, energy))


def state(hip, angles):
    """q, qd, qdd out of the motions of hip and links."""
    return tuple(np.concatenate([hip[order], angles[order]]) for order in range(3))


def residual(hip, angles, found, slope=0.0):
    """Largest error of the five equations, and the size of what they are sums of."""
    torque, load, _, _, ground, centre, _, _ = found
    left, point, *_ = equations()
    q, qd, qdd = state(hip, angles)
    knee = hip[0] + THIGH * np.array([np.cos(q[2]), np.sin(q[2])])
    ankle = knee + SHANK * np.array([np.cos(q[3]), np.sin(q[3])])
    c, s = np.cos(q[4]), np.sin(q[4])
    away = np.array([centre, -ankle[1]])  # the centre of pressure is on the ground
    lever = np.array([[c, s], [-s, c]]) @ away
    by_torque = np.array([torque[0] - torque[1], torque[1] - torque[2], torque[2]])
    right = np.concatenate([load, by_torque]) + point(q, qd, qdd, lever, slope).T @ ground
    own = left(q, qd, qdd, lever, slope)[:, 0]
    return np.abs(own - right).max(), np.abs(own).max() + np.abs(torque).max() + np.abs(ground).max()


def energy_rate(hip, angles, slope=0.0):
    """d(T + V)/dt."""
    return float(equations()[2](*state(hip, angles), (0.0, 0.0), slope)[0, 0])


def energy(hip, angles, slope=0.0):
    """T + V."""
    return float(equations()[3](*state(hip, angles), (0.0, 0.0), slope)[0, 0])


def input_power(hip, angles, found):
    """Of the body's load on the hip and of the joints."""
    rates = angles[1]
    torque, load = found[0], found[1]
    return load @ hip[1] + torque @ [rates[0], rates[1] - rates[0], rates[2] - rates[1]]
