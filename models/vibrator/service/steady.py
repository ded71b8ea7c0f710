"""Synchronous running of machines in service: by the averaged theory, and as a periodic orbit."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.vibrator.exact.budgeted import prepare
from models.vibrator.exact.orbit import find_orbit, proposal
from models.vibrator.lanes.machines import prepared
from models.vibrator.parameters import Params, Rows, Settings
from models.vibrator.service.slow_states import Array, rows_of
from models.vibrator.start.exact import BUDGET, is_at_work
from models.vibrator.start.regimes import CAPTURED_BELOW, wrapped
from models.vibrator.start.synchronous import search
from models.vibrator.theory import averaged

_ERROR, _ERROR_OF_FEED = 1e-7, 1e-6
"""Of the angle of an orbit of the exact propagator, with smooth motion and with a feed that lands
[rad]."""


class Running(NamedTuple):
    """Synchronous running of n machines; NaN where there is none that is stable.

    Attributes
    ----------
    angle : ndarray, shape (n,)
        Disphasing angle in (-pi, pi] [rad].
    speed : ndarray, shape (n,)
        [rad s-1]
    error : ndarray, shape (n,)
        Estimated error of the angle [rad].
    """

    angle: Array
    speed: Array
    error: Array


def in_theory(p: Rows) -> tuple[Array, Array]:
    """Return angles and speeds by the averaged theory; NaN of none stable at working speed."""
    guess = averaged.disphasing(p)
    slowest = CAPTURED_BELOW * np.maximum(p.synchronous_speed_1, p.synchronous_speed_2)
    with np.errstate(invalid="ignore"):
        works = guess.stable & (guess.speed >= slowest)
    return np.where(works, guess.angle, np.nan), np.where(works, guess.speed, np.nan)


def find(
    p: Rows, quick: NDArray[np.bool_], angle: Array, speed: Array, settings: Settings
) -> Running:
    """Find the stable synchronous orbits of n machines at working speed.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    quick : ndarray of bool, shape (n,)
        Which machines lanes can follow.
    angle, speed : ndarray, shape (n,)
        Guess, used where the averaged theory finds no orbit [rad, rad s-1]; may be NaN.
    settings : Settings

    Returns
    -------
    Running
    """
    out = Running(*np.full((3, len(quick)), np.nan))
    with np.errstate(all="ignore"):
        _find(p, np.flatnonzero(quick), *in_theory(p), out, settings)
        left = np.flatnonzero(quick & np.isnan(out.angle))
        _find(p, left, angle, speed, out, settings)
        for i in np.flatnonzero(~quick).tolist():
            _find_exactly(Params._make(float(field[i]) for field in p), i, out, settings)
    return out


def _find(
    p: Rows, rows: NDArray[np.intp], angle: Array, speed: Array, out: Running, settings: Settings
) -> None:
    """Set the running of some machines that lanes can follow, from a guess of all."""
    rows = rows[np.isfinite(angle[rows]) & np.isfinite(speed[rows])]
    if not len(rows):
        return
    wanted = np.ones(len(rows), bool)
    machines = prepared(rows_of(p, rows))
    result = search(machines, speed[rows], angle[rows], wanted, settings.steps_per_turn)
    some = rows[result.exists]
    out.angle[some] = result.disphasing[result.exists]
    out.speed[some] = 2 * np.pi / result.orbits.period[result.exists]
    out.error[some] = result.orbits.error[result.exists]


def _find_exactly(params: Params, i: int, out: Running, settings: Settings) -> None:
    machine = prepare(params, settings.kinematics, BUDGET)
    guess = proposal(machine)
    orbit = None if guess is None else find_orbit(machine, guess, settings.tolerance)
    if orbit is not None and is_at_work(machine.system, orbit):
        out.angle[i] = wrapped(orbit.measures.disphasing)
        out.speed[i] = 2 * np.pi / orbit.period
        out.error[i] = _ERROR_OF_FEED if machine.system.feed_mass else _ERROR
