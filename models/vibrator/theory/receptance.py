"""The machine at one speed: its linear response to two rotating unbalances of equal frequency.

Coordinates are the displacement of C along the working axes xi, eta and the rotation alpha of the
body, after the slide s and the turn theta of the motor set on its mounts have been eliminated.
Shafts at xi = R, eta = w_C +- r, + for vibrator 1. With psi_i = w t + const, unbalance i pushes
with m e_i w^2 Re(H_i e^(j psi_i)),

    H_i = (1, -+j, -(w_C +- r) -+ j R)    in xi, eta, alpha,
    e^(-+j psi), -+r                      in s (along the mount's angle psi from xi) and theta,

upper signs for vibrator 1. The motor set is its own mass m_0, J_0 and the two unbalanced masses.
Its centre is the midpoint of the shafts, about which its rotational mount turns, so slide and turn
are not coupled. Otherwise it moves with the body.
"""

import math
from typing import NamedTuple

from models.numerics.jit import kernel


class Response(NamedTuple):
    """Displacements per unit of exciting force m e_i w^2.

    Attributes
    ----------
    xi_1, eta_1, alpha_1, xi_2, eta_2, alpha_2 : complex
        Of the body, by vibrator 1 and by vibrator 2 [m N-1, rad N-1].
    slide_1, turn_1, slide_2, turn_2 : complex
        Of the motor set on its mounts.
    q_11, q_12, q_21, q_22 : complex
        q_ij = H_i^* . (displacement by vibrator j) [m N-1]: the response of i's axis to j.
    """

    xi_1: complex
    eta_1: complex
    alpha_1: complex
    xi_2: complex
    eta_2: complex
    alpha_2: complex
    slide_1: complex
    turn_1: complex
    slide_2: complex
    turn_2: complex
    q_11: complex
    q_12: complex
    q_21: complex
    q_22: complex


@kernel
def reciprocal(z):
    """Return 1/z; infinite or NaN at 0, where complex division would raise."""
    square = z.real * z.real + z.imag * z.imag
    return complex(z.real / square, -z.imag / square)


@kernel
def _compliance(stiffness, damping, inertia, w):
    """Return the receptance of the set on one mount, with the body fixed."""
    if not stiffness < math.inf:
        return 0j
    return reciprocal(complex(stiffness - w * w * inertia, w * damping))


@kernel
def respond(a, w):
    """Return the `Response` of machine `a` at speed `w` [rad s-1] (compiled)."""
    c, s, R = a.c, a.s, a.along
    w2 = w * w
    # dynamic stiffness K - w^2 M + j w B, the motor set moving with the body
    x = complex(a.stiffness_x, w * a.damping_x)
    y = complex(a.stiffness_y, w * a.damping_y)
    inert = -w2 * a.mass
    xx = x * (c * c) + y * (s * s) + inert
    xy = (y - x) * (s * c)
    yy = x * (s * s) + y * (c * c) + inert
    xa = x * (a.offset * c) + w2 * a.set_mass * a.across
    ya = x * (-a.offset * s) - w2 * a.set_mass * R
    xa += y * (a.lever * s)
    ya += y * (a.lever * c)
    aa = x * (a.offset * a.offset) + y * (a.spacing * a.spacing) - w2 * a.inertia
    feed, lever = -w2 * complex(a.feed, a.feed_loss), a.feed_position
    xx += feed * (s * s)
    xy += feed * (s * c)
    yy += feed * (c * c)
    xa += feed * (s * lever)
    ya += feed * (c * lever)
    aa += feed * (lever * lever)

    # exciting forces H_i, and their conjugates, which weight the displacements
    arm_1, arm_2 = -(a.across + a.half), -(a.across - a.half)
    x1, y1, a1 = 1 + 0j, -1j, complex(arm_1, -R)
    x2, y2, a2 = 1 + 0j, 1j, complex(arm_2, R)
    X1, Y1, A1 = 1 + 0j, 1j, complex(arm_1, R)
    X2, Y2, A2 = 1 + 0j, -1j, complex(arm_2, -R)

    slide = _compliance(a.slide_stiffness, a.slide_damping, a.set_mass, w)
    turn = _compliance(a.turn_stiffness, a.turn_damping, a.set_inertia, w)
    flexible = slide != 0j or turn != 0j
    # the slide couples to the body by -w^2 times the set's mass along u, the turn by its inertia
    ux, uy = a.slide_xi, a.slide_eta
    ua = R * uy - a.across * ux
    back, forth = complex(ux, -uy), complex(ux, uy)
    if flexible:
        pull, twist = w2 * a.set_mass * slide, w2 * a.set_inertia * turn
        stiffening = -w2 * a.set_mass * pull
        xx += stiffening * (ux * ux)
        xy += stiffening * (ux * uy)
        yy += stiffening * (uy * uy)
        xa += stiffening * (ux * ua)
        ya += stiffening * (uy * ua)
        aa += stiffening * (ua * ua) - w2 * a.set_inertia * twist
        x1, y1, a1 = (
            x1 + pull * back * ux,
            y1 + pull * back * uy,
            a1 + pull * back * ua - twist * a.half,
        )
        x2, y2, a2 = (
            x2 + pull * forth * ux,
            y2 + pull * forth * uy,
            a2 + pull * forth * ua + twist * a.half,
        )
        X1, Y1, A1 = (
            X1 + pull * forth * ux,
            Y1 + pull * forth * uy,
            A1 + pull * forth * ua - twist * a.half,
        )
        X2, Y2, A2 = (
            X2 + pull * back * ux,
            Y2 + pull * back * uy,
            A2 + pull * back * ua + twist * a.half,
        )

    # symmetric 3 x 3 system by cofactors
    c_xx = yy * aa - ya * ya
    c_xy = xa * ya - xy * aa
    c_xa = xy * ya - xa * yy
    c_yy = xx * aa - xa * xa
    c_ya = xy * xa - xx * ya
    c_aa = xx * yy - xy * xy
    scale = reciprocal(xx * c_xx + xy * c_xy + xa * c_xa)
    xi_1 = scale * (c_xx * x1 + c_xy * y1 + c_xa * a1)
    eta_1 = scale * (c_xy * x1 + c_yy * y1 + c_ya * a1)
    alpha_1 = scale * (c_xa * x1 + c_ya * y1 + c_aa * a1)
    xi_2 = scale * (c_xx * x2 + c_xy * y2 + c_xa * a2)
    eta_2 = scale * (c_xy * x2 + c_yy * y2 + c_ya * a2)
    alpha_2 = scale * (c_xa * x2 + c_ya * y2 + c_aa * a2)

    q_11 = X1 * xi_1 + Y1 * eta_1 + A1 * alpha_1
    q_12 = X1 * xi_2 + Y1 * eta_2 + A1 * alpha_2
    q_21 = X2 * xi_1 + Y2 * eta_1 + A2 * alpha_1
    q_22 = X2 * xi_2 + Y2 * eta_2 + A2 * alpha_2
    slide_1 = slide_2 = turn_1 = turn_2 = 0j
    if flexible:
        rotation = turn * (a.half * a.half)
        q_11 += slide + rotation
        q_12 += slide * forth * forth - rotation
        q_21 += slide * back * back - rotation
        q_22 += slide + rotation
        slide_1 = slide * back + pull * (ux * xi_1 + uy * eta_1 + ua * alpha_1)
        slide_2 = slide * forth + pull * (ux * xi_2 + uy * eta_2 + ua * alpha_2)
        turn_1 = -turn * a.half + twist * alpha_1
        turn_2 = turn * a.half + twist * alpha_2
    return Response(
        xi_1, eta_1, alpha_1, xi_2, eta_2, alpha_2,
        slide_1, turn_1, slide_2, turn_2,
        q_11, q_12, q_21, q_22,
    )  # fmt: skip
