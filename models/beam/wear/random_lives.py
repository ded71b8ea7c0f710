"""Lifetimes under a random load: the gaps grow by increments, with a time mean of the wear at each.

Under a random load there are no branches to follow and no memory of the path: the mean wear rate of
a site depends only on the gaps, and its life is the integral of dx over it (eqs 10 to 12 of Knudsen
& Massih 2002). An accelerated life would stretch each burst of the load, and each lull, a
hundredfold.
"""

from functools import partial

import numpy as np

from models.beam.response.averages import SHORTEST, time_mean
from models.beam.response.settling import NINE_IN_TEN
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, System
from models.beam.wear.fitted_wear import FittedWear
from models.beam.wear.lives import Lives
from models.numerics.elementary import expm1, log1p

INCREMENTS = 12  # of the faster gap, up to the last depth
_OVERTIME = 3  # times as many for the slower gap
_LONGEST = 82  # over the accuracy: periods at each increment
_ANY = 1e9  # accuracy of a mean of given length
_STRIDE = 1.5  # growth of a worn gap from node to node while the other stop is not met
_MEMORY = 0.3  # weight of the newest node in the sites' shares of wear


def find_random_lives(
    propagator: Propagator,
    system: System,
    state: Array,
    gaps: Array,
    work: Array,
    error: Array,
    share: Array,
    growths: Array,
    instants: Array,
    accuracy: float,
) -> Lives:
    """Integrate the lives of n beams.

    Parameters
    ----------
    propagator, system, state, gaps, work, share, growths, instants
        As in `models.beam.wear.worn_beams.wear_down`.
    error : ndarray, shape (n, 2)
        Standard error of `work`.
    accuracy : float
        Sets the length of the time mean at each increment. The errors show the accuracy of the
        lives.

    Returns
    -------
    Lives
        The errors are half-widths of 90 % intervals.
    """
    n = len(state)
    periods = SHORTEST << max(0, round(np.log2(_LONGEST / accuracy / SHORTEST)))
    periods = min(periods, system.longest)
    nodes = 1 + _OVERTIME * INCREMENTS
    grown = np.zeros((nodes, n, 2))
    rate, doubt = np.full((2, nodes, n, 2), np.nan)
    rate[0], doubt[0] = work * share, error * share
    running = rate[0].copy()
    left, state, last = np.arange(n), state.copy(), np.zeros(n, int)
    for node in range(1, nodes):
        grown[node, left] = _step(grown[node - 1, left], running[left], growths[left])
        left = left[~np.isnan(grown[node, left]).any(axis=1)]
        if not len(left):
            break
        now, here = state[left], gaps[left] + grown[node, left]
        mean = time_mean(propagator, system.take(left), now, here, _ANY, periods)
        state[left], last[left] = now, node
        rate[node, left], doubt[node, left] = mean.work * share[left], mean.error * share[left]
        running[left] += _MEMORY * (rate[node, left] - running[left])
    out = Lives.nothing(n, growths.shape[1], instants.shape[1])
    for i in range(n):
        span = slice(0, last[i] + 1)
        narrow = (gaps[i] + grown[last[i], i]).min()
        silent = not rate[last[i], i].any() and system.free_reach[i] < narrow
        nodes_of = (grown[span, i], rate[span, i], doubt[span, i])
        _note(i, out, gaps[i], *nodes_of, growths[i], instants[i], silent)
        # Under a random load there is one regime until contact ends.
        out.changes[i] = float(silent and bool(rate[0, i].any()))
    out.error[:] *= NINE_IN_TEN
    return out


def _step(grown: Array, rate: Array, growths: Array) -> Array:
    """Return the growth of the gaps of n beams at the next node, NaN where there is none.

    The faster of the unfinished sites advances to its next grid point; the grid is finer at small
    growth. A finished site may be very much faster still: its growth, plus the last depth, at most
    doubles. It advances itself, in strides, where the unfinished one is not touched.
    """
    head_start = growths[:, :1] / 2
    whole = log1p(growths[:, -1:] / head_start)
    unfinished = grown < growths[:, -1:] * (1 - 1e-9)
    control = np.where(unfinished, rate, 0.0)
    waiting = np.asarray(unfinished.any(axis=1) & ~(control > 0).any(axis=1))
    control[waiting] = rate[waiting]
    fast = control.argmax(axis=1)[:, None]
    here, top = (np.take_along_axis(a, fast, axis=1) for a in (grown, control))
    point = log1p(here / head_start) / whole * INCREMENTS
    goal = head_start * expm1((np.floor(point + 1e-6) + 1) / INCREMENTS * whole)
    goal = np.where(waiting[:, None], np.maximum(goal, _STRIDE * here), goal)
    with np.errstate(invalid="ignore", divide="ignore"):
        step = (goal - here) * rate / top
        most = grown.max(axis=1, keepdims=True) + growths[:, -1:]
        step *= np.minimum(1.0, most / step.max(axis=1, keepdims=True))
        return np.where(top > 0, grown + step, np.nan)


def _wear(grown: Array, rate: Array, doubt: Array, site: int, begin: int, end: int) -> FittedWear:
    """Return the wear of a site, fitted to its nodes from the first to the last, included."""
    nodes = slice(begin, end + 1)
    return FittedWear(grown[nodes, site], rate[nodes, site], doubt[nodes, site])


def _waiting(path: FittedWear, before: float, after: float) -> tuple[float, float]:
    """Return the time until a stop is met, and its error, from the wear of the other stop.

    The stop is met at an unknown growth of the other gap between two nodes, `before` and `after`.
    """
    (early, _), (late, noise) = path.life(before), path.life(after)
    return (early + late) / 2, float(np.hypot(noise, (late - early) / np.sqrt(12)))


def _note(
    i: int,
    out: Lives,
    gaps: Array,
    grown: Array,
    rate: Array,
    doubt: Array,
    growths: Array,
    instants: Array,
    silent: bool,
) -> None:
    """Record the lives and depths of beam i from growth and wear rates of its sites at nodes.

    The wear of a site is fitted from its first contact to the last depth: once worn, a gap may be
    followed to many times that depth, where it hardly wears. A stop that is met late has waited
    while the other gap grew.
    """
    if np.isnan(rate).any():
        return

    wear_of = partial(_wear, grown, rate, doubt)
    at = np.full((2, len(growths)), np.nan)
    simulated = 0.0
    for site in range(2):
        x = grown[:, site]
        worn = x >= growths[-1] * (1 - 1e-9)
        later = x[-1] if silent or worn[-1] else np.nan
        out.depth[i, site] = np.where(instants > 0, later, 0.0)
        if x[-1] == 0:
            continue
        met = int((rate[:, site] > 0).argmax())
        end = int(worn.argmax()) if worn[-1] else len(x) - 1
        wear = wear_of(site, met, end)
        other = grown[:, 1 - site]
        wait, doubt_of_wait = (
            _waiting(wear_of(1 - site, 0, met), other[met - 1], other[met]) if met else (0.0, 0.0)
        )
        whole = wait + wear.life(x[end])[0]
        for k in np.flatnonzero((instants > 0) & (instants < whole)).tolist():
            out.depth[i, site, k] = wear.grown(instants[k] - wait)
        if end < len(x) - 1:
            whole = wait + wear_of(site, met, len(x) - 1).life(x[-1])[0]
        simulated = max(simulated, whole if np.isfinite(whole) else 0.0)
        for depth in np.flatnonzero(growths <= x[-1] * (1 + 1e-9)).tolist():
            life, uncertainty = wear.life(growths[depth])
            if not np.isfinite(wait + life):  # a fit of negligible wear
                break
            out.time[i, site, depth] = wait + life
            out.error[i, site, depth] = np.hypot(uncertainty, doubt_of_wait)
            out.reached[i, site, depth] = True
            at[site, depth] = np.interp(growths[depth], x, np.arange(len(x)))
    out.time[i, :2][~out.reached[i, :2]] = np.inf if silent else simulated
    for depth, goal in enumerate(growths):
        times = np.where(out.reached[i, :2, depth], out.time[i, :2, depth], np.inf)
        first = int(times.argmin())
        for field in (out.time, out.error, out.reached):
            field[i, 2, depth] = field[i, first, depth]
        if out.reached[i, 2, depth]:
            other = np.interp(at[first, depth], np.arange(len(grown)), grown[:, 1 - first])
            out.ratio[i, depth] = (gaps[1 - first] + other) / (gaps[first] + goal)
