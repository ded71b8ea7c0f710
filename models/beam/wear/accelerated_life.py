"""An accelerated life: the gaps grow while the beam rattles, but many times faster than in reality.

By Archard's law with impact work (eqs 5, 9 to 12 of Knudsen & Massih 2002) a gap grows by a
constant times the work done on its site. A life lasts about 1e9 forcing periods; with the wear
coefficient multiplied by an acceleration K it takes N periods, and the life is K times as long as
the time simulated. K follows the running work-rate, so that the faster-growing gap grows by the
same amount in every period: N is known beforehand, whatever the work-rate.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.response.settling import TURNS
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, System
from models.beam.wear.growth import Life, note_growth, note_look, pace
from models.beam.wear.lost_stability import push_off_unstable_orbits
from models.beam.wear.regimes import History

LOOKS = 32  # changes of the acceleration in N periods
OVERTIME = 4  # a run may last this many times N periods
_SILENCE = 64  # periods without contact, at least, after which a beam that can avoid contact will


class Run(NamedTuple):
    """One accelerated life of n beams.

    Attributes
    ----------
    time : ndarray, shape (n, 2, D)
        Life of each site to each growth, in forcing periods over the wear per work of the right
        site [X0 per dimensionless work]; inf if never, the time simulated if not reached.
    reached : ndarray of bool, shape (n, 2, D)
    ended : ndarray of bool, shape (n,)
        Whether wear has stopped for good: growths not reached never will be.
    ratio : ndarray, shape (n, D)
        Gap of the other site over that of the first to reach the growth, at that time; NaN if
        never.
    lost : ndarray of bool, shape (n,)
        Whether an orbit lost its stability.
    history : History
        NaN after the end of a life.
    """

    time: Array
    reached: NDArray[np.bool_]
    ended: NDArray[np.bool_]
    ratio: Array
    lost: NDArray[np.bool_]
    history: History


def run_life(
    propagator: Propagator,
    system: System,
    state: Array,
    gaps: Array,
    work: Array,
    share: Array,
    growths: Array,
    periods: int,
    looks: int = LOOKS,
) -> Run:
    """Let the gaps of n beams grow in about `periods` forcing periods.

    Parameters
    ----------
    propagator : Propagator
    system : System
        Prepared by it.
    state : ndarray, shape (n, k)
        Settled at the initial gaps; not changed.
    gaps : ndarray, shape (n, 2)
        Initial, in X0; not changed.
    work : ndarray, shape (n, 2)
        Mean dimensionless work per period at the initial gaps.
    share : ndarray, shape (n, 2)
        Wear coefficient of each site over that of the right site.
    growths : ndarray, shape (n, D)
        Gap growths to reach, increasing, in X0.
    periods : int
        N, in which the faster site reaches the last growth.
    looks : int
        Number of looks in N periods.

    Returns
    -------
    Run
    """
    n, depths = growths.shape
    out = Run(
        np.zeros((n, 2, depths)),
        np.zeros((n, 2, depths), bool),
        np.zeros(n, bool),
        np.full((n, depths), np.nan),
        np.zeros(n, bool),
        History.nothing(n, looks * OVERTIME),
    )
    rate = work * share
    free_reach = system.free_reach
    clock, grown, silence = np.zeros(n), np.zeros((n, 2)), np.zeros(n, np.int64)
    silent = np.maximum(_SILENCE, TURNS * system.beams.turn)
    life = Life(
        gaps, share, growths, free_reach, rate.max(axis=1), rate, grown, clock, silence, silent
    )
    left, state, here, unstable = np.arange(n), state.copy(), gaps.copy(), np.zeros(n, bool)
    every = 8 if looks < LOOKS else 4  # looks between two checks of stability
    for look in range(looks * OVERTIME):
        acceleration, growth = np.empty(len(left)), np.empty((len(left), 2))
        pace(left, life, out.reached, periods, acceleration, growth)
        record = propagator.advance(system, state, here, growth, periods // looks)
        note_growth(left, life, out, record.work, acceleration, growth)
        note_look(left, life, out, look, record.strobe, record.work)
        alive = ~(out.ended[left] | out.reached[left, :, -1].all(axis=1))
        if not alive.all():
            kept = np.flatnonzero(alive)
            left, state, here, system = left[kept], state[kept], here[kept], system.take(kept)
            unstable = unstable[kept]
        if not len(left):
            break
        if look % every == every - 1:
            regime = out.history.regime[left, look]
            push_off_unstable_orbits(propagator, system, state, here, regime, unstable)
            out.lost[left] |= unstable
    missing = ~out.reached
    never = out.ended[:, None, None]
    out.time[missing] = np.where(never, np.inf, clock[:, None, None] + 0 * out.time)[missing]
    return out
