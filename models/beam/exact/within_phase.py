"""Motion within one phase: its terms at the start, their sum later, and tangents."""

import math

from models.numerics.jit import kernel


@kernel
def exponentials(phase, terms, s, power):
    """Set `power` (3, T) to the parts of exp(rate s) - 1 and the modulus of exp(rate s).

    Ten terms of the Taylor series at s/2^n, then the doubling (1 + e)^2 - 1 = e (2 + e): accurate
    to the rounding of the argument, and free of calls that would not vectorise.
    """
    fastest = 0.0
    for k in range(terms):
        fastest = max(fastest, phase.speed[k])
    doublings = 0
    while fastest * s > 0.125:
        s *= 0.5
        doublings += 1
    for k in range(terms):
        x, y = phase.rate[0, k] * s, phase.rate[1, k] * s
        u, v = 0.1 * x, 0.1 * y
        for n in (9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0):
            u += 1
            u, v = (x * u - y * v) * (1 / n), (x * v + y * u) * (1 / n)
        power[0, k], power[1, k] = u, v
    for _ in range(doublings):
        for k in range(terms):
            u, v = power[0, k], power[1, k]
            power[0, k], power[1, k] = u * (2 + u) - v * v, 2 * v * (1 + u)
    for k in range(terms):
        u, v = 1 + power[0, k], power[1, k]
        power[2, k] = math.sqrt(u * u + v * v)


@kernel
def split(phase, y, gap, theta, coefficient):
    """Set `coefficient` (2, T) to the terms of a phase that begins with y at force phase theta."""
    coefficient[:] = 0.0
    for j in range(phase.phasor.shape[1]):
        angle = theta * phase.speed[2 + j]
        c, e = math.cos(angle), math.sin(angle)
        u, v = phase.phasor[0, j], phase.phasor[1, j]
        coefficient[0, 2 + j], coefficient[1, 2 + j] = c * u - e * v, c * v + e * u
    c, e = math.cos(theta), math.sin(theta)
    for i in range(len(y)):
        rest = y[i] - phase.shape[0, 0, i] * gap
        rest -= phase.shape[1, 0, i] * c - phase.shape[1, 1, i] * e
        for k in range(2, 2 + phase.phasor.shape[1]):
            rest -= phase.shape[k, 0, i] * coefficient[0, k]
            rest += phase.shape[k, 1, i] * coefficient[1, k]
        for k in range(2 + phase.phasor.shape[1], len(phase.speed)):
            coefficient[0, k] += phase.dual[i, 0, k] * rest
            coefficient[1, k] += phase.dual[i, 1, k] * rest
    coefficient[0, 0], coefficient[0, 1], coefficient[1, 1] = gap, c, e


@kernel
def join(phase, coefficient, s, power, y):
    """Set y to the sum of the terms after the time s."""
    exponentials(phase, len(phase.speed), s, power)
    y[:] = 0.0
    for k in range(len(phase.speed)):
        c, e = coefficient[0, k], coefficient[1, k]
        u, v = 1 + power[0, k], power[1, k]
        a, b = c * u - e * v, c * v + e * u
        for i in range(len(y)):
            y[i] += phase.shape[k, 0, i] * a - phase.shape[k, 1, i] * b


@kernel
def carry(phase, power, tangents, modal):
    """Take tangents (2 m, C) through the time of `power`: y -> Re(shape exp(rate s) dual y).

    `modal` (2, T, C) is room for their coefficients.
    """
    size, columns = tangents.shape
    terms = len(phase.speed)
    modal[:] = 0.0
    for i in range(size):
        for k in range(2, terms):
            a, b = phase.dual[i, 0, k], phase.dual[i, 1, k]
            if a == 0 and b == 0:  # modes are not coupled in free flight
                continue
            for j in range(columns):
                modal[0, k, j] += a * tangents[i, j]
                modal[1, k, j] += b * tangents[i, j]
    tangents[:] = 0.0
    for k in range(2, terms):
        u, v = 1 + power[0, k], power[1, k]
        for j in range(columns):
            a, b = modal[0, k, j], modal[1, k, j]
            modal[0, k, j], modal[1, k, j] = a * u - b * v, a * v + b * u
        for i in range(size):
            a, b = phase.shape[k, 0, i], phase.shape[k, 1, i]
            if a == 0 and b == 0:
                continue
            for j in range(columns):
                tangents[i, j] += a * modal[0, k, j] - b * modal[1, k, j]
