"""Sine and cosine without branches, so that loops over lanes that call them vectorise."""

from models.numerics.fma import fma
from models.numerics.jit import inlined

_TWO_OVER_PI = 0.6366197723675814
# Pi/2 in three parts; the first two have spare bits, so that their products with integers are
# exact.
_PART_1 = 1.5707963267341256
_PART_2 = 6.077100506303966e-11
_PART_3 = 2.0222662487959506e-21
# Adding and subtracting 1.5 * 2^52 rounds to the nearest integer.
_ROUNDER = 6755399441055744.0


@inlined
def nearest(x):
    """Return the integer nearest to x, for abs(x) < 2^51."""
    return (x + _ROUNDER) - _ROUNDER


@inlined
def cosine_sine(x):
    """Return cos x and sin x.

    The argument is reduced to a quarter turn about 0, where two polynomials (as in Cephes) are
    accurate to the last bit or two; the measured error is at most 3e-16 for abs(x) < 1e5.

    Parameters
    ----------
    x : float
        [rad]

    Returns
    -------
    cosine, sine : float
    """
    quarters = nearest(x * _TWO_OVER_PI)
    r = fma(-quarters, _PART_3, fma(-quarters, _PART_2, fma(-quarters, _PART_1, x)))
    z = r * r
    s = fma(z, 1.58969099521155010e-10, -2.50507602534068634e-8)
    s = fma(z, fma(z, s, 2.75573137070700677e-6), -1.98412698298579493e-4)
    s = fma(z, fma(z, s, 8.3333333333224895e-3), -1.6666666666666632e-1)
    s = fma(r * z, s, r)
    c = fma(z, -1.13596475577881948e-11, 2.08757232129817483e-9)
    c = fma(z, fma(z, c, -2.75573143513906633e-7), 2.48015872894767294e-5)
    c = fma(z, fma(z, c, -1.38888888888741096e-3), 4.16666666666666019e-2)
    c = fma(z * z, c, fma(-0.5, z, 1.0))
    turn = quarters * 0.25
    turn = turn - nearest(turn - 0.375)  # 0, 1/4, 1/2 or 3/4
    odd = (turn == 0.25) | (turn == 0.75)
    sine = c if odd else s
    cosine = s if odd else c
    sine = -sine if turn >= 0.5 else sine
    cosine = -cosine if (turn == 0.25) | (turn == 0.5) else cosine
    return cosine, sine
