"""Many beams whose gaps grow until they are worn down."""

import numpy as np
from numpy.typing import NDArray

from models.beam.response.response import APERIODIC, NO_IMPACT
from models.beam.response.settling import TURNS
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, System
from models.beam.wear.depths_in_time import note_later_depths
from models.beam.wear.progress import (
    FIRST_STEP,
    FLOWING,
    OVER,
    STEPPING,
    Progress,
    Worn,
)
from models.beam.wear.regimes import ROUND
from models.beam.wear.rounds import judge, keep, plan
from models.numerics.blocks import LANES
from models.numerics.elementary import log1p

LOOKS = 32  # while the faster gap grows to the last depth
LONGEST_STEP = 0.24  # relative growth of a gap
OVERTIME = 4  # a flow may last this many times its intended periods
_ENOUGH = 8192  # further periods
_SILENCE = 64  # periods without contact, at least, after which a beam that can avoid contact will


def wear_down(
    propagator: Propagator,
    system: System,
    state: Array,
    gaps: Array,
    work: Array,
    regime: NDArray[np.int8],
    share: Array,
    growths: Array,
    periods: int,
    accuracy: float,
    looks: int = LOOKS,
    instants: Array | None = None,
) -> Worn:
    """Let the gaps of n beams grow.

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
    regime : ndarray of int8, shape (n,)
        At the initial gaps; index into `models.beam.parameters.REGIMES`.
    share : ndarray, shape (n, 2)
        Wear coefficient of each site over that of the right site.
    growths : ndarray, shape (n, D)
        Gap growths to reach, increasing, in X0.
    periods : int
        In which the faster site reaches the last growth in a flow.
    accuracy : float
        Relative, of the lives; sets the largest error of a step.
    looks : int
        While the faster site reaches the last growth. No step is longer than from one to the next
        if there are more than `LOOKS`.
    instants : ndarray, shape (n, T), optional
        Times at which the growth of the gaps is recorded, in the unit of `Worn.time`.

    Returns
    -------
    Worn
    """
    n, depths = growths.shape
    instants = np.empty((n, 0)) if instants is None else instants
    out = Worn.nothing(n, depths, instants.shape[1], looks * OVERTIME)
    whole = float(log1p(2 * growths[:1, -1] / growths[:1, 0])[0]) if n else 1.0
    pace, spacing = whole * ROUND / periods, whole / looks
    largest = LONGEST_STEP if looks <= LOOKS else spacing
    settled = (regime != APERIODIC) & (regime != NO_IMPACT)
    life = Progress.beginning(
        gaps,
        share,
        growths,
        instants,
        system.free_reach,
        np.maximum(_SILENCE, TURNS * system.beams.turn),
        work * share,
        regime,
        np.where(settled, STEPPING, FLOWING).astype(np.int8),
        min(FIRST_STEP, largest),
    )
    left, now, here = np.arange(n), state.copy(), gaps.copy()
    clock = propagator.CLOCK % state.shape[1]
    before, kept, kept_gaps = state.copy(), state.copy(), gaps.copy()
    for _ in range((OVERTIME * periods + _ENOUGH) // ROUND):
        growth = np.empty((len(left), 2))
        verdict = np.empty(len(left), np.int8)
        plan(left, life, out, here, now, kept, before, clock, pace, growth)
        record = propagator.advance(system, now, here, growth, ROUND)
        judge(
            left, life, out, here, record.work, record.strobe, accuracy, largest, spacing, verdict
        )
        keep(verdict, now, here, kept, kept_gaps, before)
        going = life.mode[left] != OVER
        if len(left) - going.sum() >= max(1, len(left) // LANES):  # to select beams takes time
            rows = np.flatnonzero(going)
            left, now, here, system = left[rows], now[rows], here[rows], system.take(rows)
            before, kept, kept_gaps = before[rows], kept[rows], kept_gaps[rows]
        if not len(left):
            break
    missing = ~out.reached
    until = np.where(out.ended, np.inf, life.clock)[:, None, None]
    out.time[missing] = (until + 0 * out.time)[missing]
    note_later_depths(life, out)
    return out
