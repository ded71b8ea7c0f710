"""The vibrator's equations of motion from its Lagrangian, by computer algebra.

Shares nothing with `models.vibrator` but the parameters. Coordinates: x, y, alpha, psi_1, psi_2,
u, chi; the feed, if it rides, is part of the body.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
import sympy as sp

NAMES = (
    "body_mass body_inertia unbalance_1 unbalance_2 unbalanced_mass rotor_inertia "
    "support_half_spacing working_angle shaft_half_angle shaft_distance axis_offset "
    "stiffness_x stiffness_y damping_ratio support_offset mount_stiffness mount_angle mount_mass "
    "mount_damping_ratio mount_rotational_stiffness mount_inertia feed_mass feed_position gravity "
    "support_imbalance"
).split()


class Mechanics(NamedTuple):
    """Functions of (parameters, riding, weight, q, v), all compiled by sympy.

    Mass matrix M and force Q of M q'' = Q + torques, energy, and momenta dT/dv.
    """

    mass: object
    force: object
    energy: object
    momenta: object


@cache
def mechanics(exact):
    p = dict(zip(NAMES, sp.symbols(NAMES), strict=True))
    riding, weight = sp.symbols("riding weight")
    q, v = sp.symbols("q:7"), sp.symbols("v:7")
    x, y, alpha, psi_1, psi_2, u, chi = q

    def turn(angle, vector):
        if exact:
            c, s = sp.cos(angle), sp.sin(angle)
            return sp.Matrix([[c, -s], [s, c]]) * vector
        return vector + angle * sp.Matrix([-vector[1], vector[0]])

    def unit(angle):
        return sp.Matrix([sp.cos(angle), sp.sin(angle)])

    def rate(expression):
        return sp.Matrix([expression]).jacobian(q).dot(v)

    def velocity(point):
        return point.jacobian(q) * sp.Matrix(v)

    centre, beta = sp.Matrix([x, y]), p["working_angle"]
    along, across = unit(beta), unit(beta + sp.pi / 2)
    shafts = [
        p["shaft_distance"] * unit(beta + sense * p["shaft_half_angle"]) + p["axis_offset"] * across
        for sense in (1, -1)
    ]
    middle = p["shaft_distance"] * sp.cos(p["shaft_half_angle"]) * along + p["axis_offset"] * across
    slide = u * unit(beta + p["mount_angle"])
    e = [p[f"unbalance_{i}"] / p["unbalanced_mass"] for i in (1, 2)]
    unbalances = [e[0] * unit(beta + psi_1), e[1] * unit(beta - psi_2)]
    if exact:
        held = [centre + turn(alpha, middle + slide + turn(chi, s - middle)) for s in shafts]
        set_centre = centre + turn(alpha, middle + slide)
    else:
        # To first order: alpha, u and chi add up, and do not multiply.
        held = [
            centre + turn(alpha, s) + slide + turn(chi, s - middle) - (s - middle) for s in shafts
        ]
        set_centre = centre + turn(alpha, middle) + slide
    masses = [h + n for h, n in zip(held, unbalances, strict=True)]
    deck = (centre + turn(alpha, sp.Matrix([p["feed_position"], 0])))[1]

    def kinetic(mass, point):
        w = velocity(point)
        return mass * w.dot(w) / 2

    energy = kinetic(p["body_mass"], centre) + p["body_inertia"] * v[2] ** 2 / 2
    energy += kinetic(p["mount_mass"], set_centre) + p["mount_inertia"] * (v[2] + v[6]) ** 2 / 2
    energy += sum(kinetic(p["unbalanced_mass"], r) for r in masses)
    energy += p["rotor_inertia"] * (v[3] ** 2 + v[4] ** 2) / 2
    energy += riding * p["feed_mass"] * rate(deck) ** 2 / 2

    m, half = p["unbalanced_mass"], p["shaft_distance"] * sp.sin(p["shaft_half_angle"])
    set_mass, set_inertia = p["mount_mass"] + 2 * m, p["mount_inertia"] + 2 * m * half**2
    # The supports carry all weights where they act in equilibrium; the unbalances swing.
    potential, loss = -weight * (1 - riding) * deck, 0
    potential += p["gravity"] * m * sum(n[1] for n in unbalances)
    sprung = p["body_mass"] + 2 * m
    for side in (1, -1):
        place = sp.Matrix([side * p["support_half_spacing"], -p["support_offset"]])
        shift = centre + turn(alpha, place) - place
        share = (1 + side * p["support_imbalance"]) / 2
        for axis, k in enumerate((p["stiffness_x"], p["stiffness_y"])):
            potential += share * k * shift[axis] ** 2 / 2
            loss += share * p["damping_ratio"] * sp.sqrt(sprung * k) * rate(shift[axis]) ** 2
    for at, k, inertia in (
        (5, p["mount_stiffness"], set_mass),
        (6, p["mount_rotational_stiffness"], set_inertia),
    ):
        potential += k * q[at] ** 2 / 2
        loss += p["mount_damping_ratio"] * sp.sqrt(k * inertia) * v[at] ** 2

    momenta = sp.Matrix([sp.diff(energy, w) for w in v])
    mass = momenta.jacobian(v)
    force = sp.Matrix([sp.diff(energy - potential, at) for at in q])
    force -= momenta.jacobian(q) * sp.Matrix(v) + sp.Matrix([sp.diff(loss, w) for w in v])
    arguments = [list(p.values()), riding, weight, q, v]
    return Mechanics(
        *(
            sp.lambdify(arguments, part, cse=True)
            for part in (mass, force, energy + potential, momenta)
        )
    )


def values(p):
    """Return the parameters in the order the functions of `Mechanics` want them."""
    finite = {"mount_stiffness": 0.0, "mount_rotational_stiffness": 0.0}
    return [
        finite[name] if name in finite and np.isinf(getattr(p, name)) else getattr(p, name)
        for name in NAMES
    ]


def free(p):
    """Return which of the seven coordinates are free."""
    mounts = [np.isfinite(p.mount_stiffness), np.isfinite(p.mount_rotational_stiffness)]
    return np.array([True] * 5 + mounts)


def torques(p, v):
    """Return what the motors and the bearings do to the seven coordinates, (22) and (23)."""
    out = np.zeros(7)
    for i, sense in ((1, 1), (2, -1)):
        speed = v[2 + i]
        w_s, w_u = getattr(p, f"synchronous_speed_{i}"), getattr(p, f"breakdown_speed_{i}")
        rated, rho = getattr(p, f"rated_torque_{i}"), getattr(p, f"bearing_constant_{i}")
        kloss = (w_s - w_u) * (w_s - speed) / ((w_s - w_u) ** 2 + (w_s - speed) ** 2)
        relative = speed - sense * (v[2] + v[6])
        loss = rho * getattr(p, f"unbalance_{i}") * speed**2 * np.sign(relative)
        out[2 + i] = 2 * p.overload_capacity * p.voltage_factor**2 * rated * kloss - loss
    return out


def acceleration(p, exact, riding, gravity, q, v):
    """Return q'', shape (7,), 0 for coordinates that are not free."""
    functions, weight, at = mechanics(exact), p.feed_mass * gravity, free(p)
    arguments = values(p), float(riding), weight, q, v
    force = np.ravel(functions.force(*arguments)) + torques(p, v)
    out = np.zeros(7)
    out[at] = np.linalg.solve(functions.mass(*arguments)[np.ix_(at, at)], force[at])
    return out
