"""Lifetimes the long way: the gaps grow by small increments, the beam settles at each.

This is the paper's procedure (eqs 9 to 12 of Knudsen & Massih 2002): with work-rates u_i at the
gaps x_i, dx_i/dT = (k_i/k_1) u_i. Lengths are in initial gaps, rates in k_c X0^2 w0, and T in
S/(k_1 k_c X0 w0). Slow, but free of any acceleration of wear.
"""

from typing import NamedTuple

import numpy as np

from models.beam import exact
from models.beam.structure.modal import beams

LONGEST_PERIOD = 8
BLOCK = 64  # periods


class Rates(NamedTuple):
    """Settled work-rates, shape (2,), and their standard errors, 0 if periodic."""

    mean: np.ndarray
    error: np.ndarray


class IncrementalLives(NamedTuple):
    """Lives of the right site, the left site and the earlier of both, axis 0; growths, axis 1.

    Attributes
    ----------
    time, error : ndarray, shape (3, D)
        T and its error; inf if wear stops before, NaN if given up.
    unit : float
        [s] of T = 1.
    gaps, rates, rate_errors : ndarray, shape (N, 2)
        The path: gaps, the work-rates there and their standard errors, 0 where periodic.
    """

    time: np.ndarray
    error: np.ndarray
    unit: float
    gaps: np.ndarray
    rates: np.ndarray
    rate_errors: np.ndarray


def settled_rates(propagator, system, state, gaps, omega, tolerance=1e-7, blocks=150):
    """Settle one beam at constant gaps and average its work-rates; `state` moves on.

    A response is periodic when the work of each of its last periods repeats to `tolerance`.
    Otherwise the mean is over the last three quarters of `blocks`, which are also its batches.
    """
    means = []
    scale = 2 * np.pi / omega
    for _ in range(blocks):
        work = propagator.advance(system, state, gaps[None].copy(), np.zeros((1, 2)), BLOCK).work[0]
        if not np.isfinite(work).all():
            raise ArithmeticError("the propagator gave up")
        means.append(work.mean(axis=0))
        for period in range(1, LONGEST_PERIOD + 1):
            change = np.abs(work[period:] - work[:-period])[-2 * LONGEST_PERIOD :].max()
            if change <= tolerance * work.max():
                return Rates(work[-period:].mean(axis=0) / scale, np.zeros(2))
    kept = np.array(means[blocks // 4 :]) / scale
    return Rates(kept.mean(axis=0), kept.std(axis=0, ddof=1) / np.sqrt(len(kept)))


def _path(propagator, system, p, omega, share, growth, increment, most, **settling):
    """Follow the gaps by Heun's rule, the faster one in equal steps, until both have grown."""
    displacement, velocity = (
        p.initial_displacement / p.initial_gap,
        p.initial_velocity / p.initial_gap,
    )
    state = propagator.start(system, displacement, velocity)
    start = np.array([1 + 0.5 * p.gap_asymmetry, 1 - 0.5 * p.gap_asymmetry])
    at = start
    here = settled_rates(propagator, system, state, at, omega, **settling)
    gaps, times, rates, variance = [at], [0.0], [here], [0.0]
    while (at - start < growth).any() and (at - start < most).all() and here.mean.any():
        speed = here.mean * share
        dt = increment / speed.max()
        there = settled_rates(propagator, system, state, at + dt * speed, omega, **settling)
        middle = 0.5 * (speed + there.mean * share)
        fast = middle.argmax()
        dt = increment / middle[fast]
        at = at + dt * middle
        gaps.append(at)
        times.append(times[-1] + dt)
        variance.append(variance[-1] + (dt * there.error[fast] * share[fast] / middle[fast]) ** 2)
        rates.append(there)
        here = there
    return np.array(gaps), np.array(times), rates, np.sqrt(variance)


def _crossings(gaps, times, noise, growths, stopped):
    """Return when each site, and the earlier one, reaches each growth, and the noise then."""
    time, error = np.empty((3, len(growths))), np.zeros((3, len(growths)))
    for site in range(2):
        grown = gaps[:, site] - gaps[0, site]
        beyond = np.inf if stopped else np.nan
        time[site] = np.interp(growths, grown, times, right=beyond)
        error[site] = np.interp(growths, grown, noise)
    first = np.nanargmin(np.where(np.isnan(time[:2]), np.inf, time[:2]), axis=0)
    columns = np.arange(len(growths))
    time[2], error[2] = time[first, columns], error[first, columns]
    return time, error


def follow(params, settings, growths, increments=100, most=3.0, propagator=exact, **settling):
    """Follow the gaps of one beam once.

    Parameters are those of `incremental_lives`.

    Returns
    -------
    time, error : ndarray, shape (3, D)
        Lives, and the statistical error of the time means in them.
    unit : float
        [s] of T = 1.
    gaps, rates, rate_errors : ndarray, shape (N, 2)
        The path.
    """
    growths = np.asarray(growths, float)
    row = type(params)(*(np.array([value], float) for value in params))
    modal = beams(row, settings)
    ((_, system),) = propagator.groups(modal, settings)
    w0, forcing = modal.frequency[0, 0], modal.forcing[0]
    share = np.array([1.0, params.wear_coefficient_ratio])
    gaps, times, rates, noise = _path(
        propagator,
        system,
        params,
        forcing / w0,
        share,
        growths[-1],
        growths[-1] / increments,
        most * growths[-1],
        **settling,
    )
    time, error = _crossings(gaps, times, noise, growths, not rates[-1].mean.any())
    wear = params.wear_coefficient / params.contact_area
    unit = 1 / (wear * params.contact_stiffness * params.initial_gap * w0)
    return time, error, unit, gaps, *np.stack(rates, axis=1)


def incremental_lives(
    params, settings, growths, increments=100, most=3.0, propagator=exact, **settling
):
    """Return the lives of one beam.

    Parameters
    ----------
    params : Params
        Of one beam, floats.
    settings : Settings
    growths : sequence of float
        Gap growths [X0], increasing.
    increments : int
        In which the faster gap reaches the last growth. The path is also followed with half as
        many; the difference, with the statistical error of the time means, is the error.
    most : float
        Give up on the slower site when the faster has grown this many times the last growth.
    propagator : module
        `models.beam.exact` or `models.beam.lanes`.
    **settling
        `tolerance` and `blocks` of `settled_rates`.

    Returns
    -------
    IncrementalLives
    """
    how = {"most": most, "propagator": propagator, **settling}
    coarse, *_ = follow(params, settings, growths, increments // 2, **how)
    time, statistical, *path = follow(params, settings, growths, increments, **how)
    with np.errstate(invalid="ignore"):
        error = np.hypot(time - coarse, statistical)
    return IncrementalLives(time, error, *path)
