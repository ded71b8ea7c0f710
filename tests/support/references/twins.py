"""Slow, obvious twins of the beam's propagators, in physical coordinates and SI units.

They share nothing with `models.beam` but the parameters: the element matrices come from Gauss
quadrature of the Hermite cubics, and the unknowns are nodal deflections and rotations.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import eigh


class Assembled(NamedTuple):
    """M X'' + C X' + K X = e (F cos(Omega t) - contact force); contact springs not in K."""

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray

    @property
    def tip(self):
        """Index of the tip's deflection."""
        return len(self.mass) - 2

    def first_mode(self):
        """Return the lowest mode, 1 at the tip, and its angular frequency [rad s-1]."""
        square, shape = eigh(self.stiffness, self.mass, subset_by_index=(0, 0))
        return shape[:, 0] / shape[self.tip, 0], np.sqrt(square[0])


class Motion(NamedTuple):
    """Tip at the end of each period [X0, X0 s-1], work per site [k_c X0^2] and deepest [X0]."""

    displacement: np.ndarray
    velocity: np.ndarray
    work: np.ndarray
    peak: np.ndarray


def assemble(p, elements):
    h = p.length / elements
    points, weights = np.polynomial.legendre.leggauss(5)
    s, weights = (points + 1) / 2, weights * h / 2
    shape = np.array(
        [
            1 - 3 * s**2 + 2 * s**3,
            h * (s - 2 * s**2 + s**3),
            3 * s**2 - 2 * s**3,
            h * (s**3 - s**2),
        ]
    )
    bend = np.array([12 * s - 6, h * (6 * s - 4), 6 - 12 * s, h * (6 * s - 2)]) / h**2
    size = 2 * elements + 2
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    for e in range(elements):
        at = slice(2 * e, 2 * e + 4)
        mass[at, at] += p.mass_per_length * (shape * weights) @ shape.T
        stiffness[at, at] += p.flexural_rigidity * (bend * weights) @ bend.T
    stiffness[0, 0] += p.lateral_support_stiffness
    stiffness[1, 1] += p.rotational_support_stiffness
    damping = p.mass_damping * mass + p.stiffness_damping * stiffness
    return Assembled(mass, damping, stiffness)


def initial_state(p, beam):
    """Return deflections and velocities in the shape of the first mode."""
    shape, _ = beam.first_mode()
    return np.concatenate([p.initial_displacement * shape, p.initial_velocity * shape])


def first_order(p, beam, gap=0.0, contact=False):
    """Return A, b and f of Y' = A Y + b + f cos(Omega t); in contact at X = gap if `contact`."""
    size, tip = len(beam.mass), beam.tip
    stiffness = beam.stiffness.copy()
    inverse = np.linalg.inv(beam.mass)
    constant, harmonic = np.zeros(2 * size), np.zeros(2 * size)
    if contact:
        stiffness[tip, tip] += p.contact_stiffness
        constant[size:] = inverse[:, tip] * p.contact_stiffness * gap
    harmonic[size:] = inverse[:, tip] * p.force_amplitude
    matrix = np.block(
        [[np.zeros((size, size)), np.eye(size)], [-inverse @ stiffness, -inverse @ beam.damping]]
    )
    return matrix, constant, harmonic


def by_dop853(p, elements, periods, rtol=1e-12):
    """Integrate phase by phase with scipy's DOP853; contacts begin and end at terminal events."""
    beam = assemble(p, elements)
    size, tip, scale = len(beam.mass), beam.tip, p.initial_gap
    omega = 2 * np.pi * p.forcing_frequency
    gaps = scale * (1 + 0.5 * p.gap_asymmetry), scale * (1 - 0.5 * p.gap_asymmetry)
    systems = {
        0: first_order(p, beam),
        1: first_order(p, beam, gaps[0], contact=True),
        -1: first_order(p, beam, -gaps[1], contact=True),
    }
    absolute = np.concatenate([np.full(size, scale), np.full(size, scale * omega)]) * rtol
    y = initial_state(p, beam)
    side = int(y[tip] > gaps[0]) - int(y[tip] < -gaps[1])
    motion = Motion(*np.zeros((2, periods)), np.zeros((periods, 2)), np.zeros(2))

    def turning(t, y, *_):
        return y[size + tip]

    def right(t, y, *_):
        return y[tip] - gaps[0]

    def left(t, y, *_):
        return y[tip] + gaps[1]

    for event in (right, left):
        event.terminal = True

    for period in range(periods):
        t, end = 2 * np.pi * period / omega, 2 * np.pi * (period + 1) / omega
        while t < end:
            matrix, constant, harmonic = systems[side]
            right.direction = 1 if side == 0 else -1
            left.direction = -1 if side == 0 else 1
            events = {0: (right, left, turning), 1: (right, turning), -1: (left, turning)}[side]
            solution = solve_ivp(
                lambda t, y, a, b, f: a @ y + b + f * np.cos(omega * t),
                (t, end),
                y,
                "DOP853",
                events=events,
                args=(matrix, constant, harmonic),
                rtol=rtol,
                atol=absolute,
            )
            assert solution.success
            if side:
                site, gap = (0, gaps[0]) if side > 0 else (1, gaps[1])
                turns = [state[tip] for state in solution.y_events[1]]
                depths = side * np.array([y[tip], *turns, solution.y[tip, -1]]) - gap
                depths = np.maximum(depths / scale, 0)
                motion.work[period, site] += 0.5 * np.abs(np.diff(depths**2)).sum()
                motion.peak[site] = max(motion.peak[site], depths.max())
            t, y = solution.t[-1], solution.y[:, -1]
            if solution.status == 1:
                met = {0: (1, -1)}.get(side, (0,))
                side = next(
                    s for s, times in zip(met, solution.t_events, strict=False) if len(times)
                )
        motion.displacement[period], motion.velocity[period] = y[tip] / scale, y[size + tip] / scale
    return motion


def by_newmark(p, elements, periods, steps):
    """Average acceleration with fixed steps; contact at the end of each step is solved exactly."""
    beam = assemble(p, elements)
    size, tip, scale = len(beam.mass), beam.tip, p.initial_gap
    omega = 2 * np.pi * p.forcing_frequency
    h = 2 * np.pi / omega / steps
    gaps = scale * (1 + 0.5 * p.gap_asymmetry), scale * (1 - 0.5 * p.gap_asymmetry)
    flexibility = np.linalg.inv(beam.mass + h / 2 * beam.damping + h**2 / 4 * beam.stiffness)
    # Tip displacement at the end of a step per unit of contact force there.
    yielding = h**2 / 4 * flexibility[tip, tip]

    def penetration(x):
        return max(x - gaps[0], 0.0) - max(-x - gaps[1], 0.0)

    y = initial_state(p, beam)
    x, v = y[:size], y[size:]
    load = np.zeros(size)
    load[tip] = p.force_amplitude - p.contact_stiffness * penetration(x[tip])
    a = np.linalg.solve(beam.mass, load - beam.damping @ v - beam.stiffness @ x)
    motion = Motion(*np.zeros((2, periods)), np.zeros((periods, 2)), np.zeros(2))
    for period in range(periods):
        for step in range(1, steps + 1):
            before = x[tip]
            x = x + h * v + h**2 / 4 * a
            v = v + h / 2 * a
            load = -beam.damping @ v - beam.stiffness @ x
            load[tip] += p.force_amplitude * np.cos(2 * np.pi * step / steps)
            a = flexibility @ load
            free = x[tip] + h**2 / 4 * a[tip]
            force = p.contact_stiffness * penetration(free) / (1 + p.contact_stiffness * yielding)
            a = a - flexibility[:, tip] * force
            x, v = x + h**2 / 4 * a, v + h / 2 * a
            for site, side in enumerate((1, -1)):
                depths = np.maximum(side * np.array([before, x[tip]]) - gaps[site], 0) / scale
                motion.work[period, site] += 0.5 * abs(depths[1] ** 2 - depths[0] ** 2)
                motion.peak[site] = max(motion.peak[site], depths.max())
        motion.displacement[period], motion.velocity[period] = x[tip] / scale, v[tip] / scale
    return motion
