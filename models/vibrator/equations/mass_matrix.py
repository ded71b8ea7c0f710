"""The mass matrix of the general machine, symmetric in x, y, alpha, u and chi, and its solver."""

from typing import Any, NamedTuple

from models.numerics.jit import inlined


class Inertia(NamedTuple):
    """The factorised mass matrix of x, y, alpha, u and chi, eliminated from the last; c is chi."""

    c: Any  # reciprocals of the pivots
    u: Any
    a: Any
    y: Any
    x: Any
    cu: Any  # elements of the rows when eliminated
    ca: Any
    cy: Any
    cx: Any
    ua: Any
    uy: Any
    ux: Any
    ay: Any
    ax: Any
    yx: Any


@inlined
def factorised(m, pose, v_1, v_2, riding):
    """Return the `Inertia` of a machine.

    Parameters
    ----------
    m : System
    pose : Pose
    v_1, v_2 : Vibrator
    riding : bool
        Whether the feed lies on the deck.
    """
    o_x, o_y, to_x, to_y = pose.set_x, pose.set_y, pose.slide_x, pose.slide_y
    # Inertia of both masses on the shafts about O, then about C.
    cx_1, cy_1 = v_1.xy * v_1.arm_x - v_1.xx * v_1.arm_y, v_1.yy * v_1.arm_x - v_1.xy * v_1.arm_y
    cx_2, cy_2 = v_2.xy * v_2.arm_x - v_2.xx * v_2.arm_y, v_2.yy * v_2.arm_x - v_2.xy * v_2.arm_y
    cx, cy = cx_1 + cx_2, cy_1 + cy_2
    cc = m.mount_inertia + v_1.arm_x * cy_1 - v_1.arm_y * cx_1 + v_2.arm_x * cy_2 - v_2.arm_y * cx_2
    xx, xy, yy = m.mount_mass + v_1.xx + v_2.xx, v_1.xy + v_2.xy, m.mount_mass + v_1.yy + v_2.yy
    ax, ay = cx + xy * o_x - xx * o_y, cy + yy * o_x - xy * o_y
    ca = cc + o_x * cy - o_y * cx
    aa = ca + o_x * ay - o_y * ax + m.body_inertia
    ux, uy, ua = xx * to_x + xy * to_y, xy * to_x + yy * to_y, ax * to_x + ay * to_y
    uu = ux * to_x + uy * to_y + 1 - m.slides
    xx += m.body_mass
    yy += m.body_mass
    if riding:
        reach = pose.cos * m.feed_position
        yy += m.feed_mass
        ay += m.feed_mass * reach
        aa += m.feed_mass * reach * reach
    cx, cy, ca, cc = m.rocks * cx, m.rocks * cy, m.rocks * ca, m.rocks * cc + 1 - m.rocks
    cu = cx * to_x + cy * to_y

    c = 1 / cc
    f_u, f_a, f_y, f_x = c * cu, c * ca, c * cy, c * cx
    uu, ua, uy, ux = uu - f_u * cu, ua - f_u * ca, uy - f_u * cy, ux - f_u * cx
    u = 1 / uu
    g_a, g_y, g_x = u * ua, u * uy, u * ux
    a = 1 / (aa - f_a * ca - g_a * ua)
    ay, ax = ay - f_a * cy - g_a * uy, ax - f_a * cx - g_a * ux
    h_y, h_x = a * ay, a * ax
    y = 1 / (yy - f_y * cy - g_y * uy - h_y * ay)
    yx = xy - f_y * cx - g_y * ux - h_y * ax
    x = 1 / (xx - f_x * cx - g_x * ux - h_x * ax - y * yx * yx)
    return Inertia(c, u, a, y, x, cu, ca, cy, cx, ua, uy, ux, ay, ax, yx)


@inlined
def solve(inertia, x, y, a, u, c):
    """Return the accelerations x'', y'', alpha'', u'', chi'' due to generalised forces."""
    c = inertia.c * c
    u = inertia.u * (u - inertia.cu * c)
    a = inertia.a * (a - inertia.ca * c - inertia.ua * u)
    y = inertia.y * (y - inertia.cy * c - inertia.uy * u - inertia.ay * a)
    x = inertia.x * (x - inertia.cx * c - inertia.ux * u - inertia.ax * a - inertia.yx * y)
    y -= inertia.y * inertia.yx * x
    a -= inertia.a * (inertia.ax * x + inertia.ay * y)
    u -= inertia.u * (inertia.ux * x + inertia.uy * y + inertia.ua * a)
    c -= inertia.c * (inertia.cx * x + inertia.cy * y + inertia.ca * a + inertia.cu * u)
    return x, y, a, u, c
