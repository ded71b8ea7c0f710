"""One mode over one step, exact for a force that is linear within it."""

import numpy as np

from models.numerics.jit import kernel

RESOLVED = 2.0  # slower pole of a mode, times the step, above which it follows statically


@kernel
def mode_step(w, d, h):
    """Propagate z'' + 2 d z' + w^2 z = g over h, with g linear from g0 to g1.

    Return P11, P12, P21, P22, A1, A2, B1, B2 of s1 = P s0 + A g0 + B g1 for s = (z, z'/w): a Taylor
    series over a small fraction of h, then repeated doubling, accurate for any damping.
    """
    small = h
    doublings = 0
    while (w + 2 * d) * small > 0.25:
        small *= 0.5
        doublings += 1
    a, b = w * small, 2 * d * small
    # phi1 and phi2 of [[0, a], [-a, -b]] applied to (0, 1)
    v1, v2 = 0.0, 1.0
    f11, f12, f21, f22 = 0.0, 1.0, 0.0, 0.5
    weight = 1.0
    for k in range(1, 14):
        v1, v2 = a * v2, -a * v1 - b * v2
        weight /= k + 1
        f11 += weight * v1
        f12 += weight * v2
        f21 += weight / (k + 2) * v1
        f22 += weight / (k + 2) * v2
    p11, p21 = 1 - a * f11, -a * f12
    p12, p22 = a * f12, 1 - a * f11 - b * f12
    scale = small / w
    b1, b2 = scale * f21, scale * f22
    a1, a2 = scale * f11 - b1, scale * f12 - b2
    for _ in range(doublings):
        c1, c2 = a1 + 0.5 * b1, a2 + 0.5 * b2
        e1, e2 = 0.5 * b1, 0.5 * b2
        a1, a2, b1, b2 = (
            p11 * c1 + p12 * c2 + 0.5 * a1,
            p21 * c1 + p22 * c2 + 0.5 * a2,
            p11 * e1 + p12 * e2 + 0.5 * a1 + b1,
            p21 * e1 + p22 * e2 + 0.5 * a2 + b2,
        )
        p11, p12, p21, p22 = (
            p11 * p11 + p12 * p21,
            p11 * p12 + p12 * p22,
            p21 * p11 + p22 * p21,
            p21 * p12 + p22 * p22,
        )
    return p11, p12, p21, p22, a1, a2, b1, b2


@kernel
def is_static(w, d, h):
    """Return whether a mode is so fast that in steps of h it follows the contact statically.

    What is then neglected is its share of the flexibility, like 1/w^2, times its lag behind the
    force, the inverse of its slower pole. As the frequencies of a beam grow like the squares of
    their numbers, the sum over the modes falls like h^2.5: no slower than the error of the step.
    """
    pole = w if d < w else w * (w / (d + np.sqrt(d * d - w * w)))
    return pole * h > RESOLVED
