"""The largest Lyapunov exponent of a response: how fast neighbouring ones diverge."""

import numpy as np

from models.beam import lanes
from models.beam.lanes.systems import System
from models.beam.lanes.tangents import carry
from models.beam.parameters import Params, Rows, Settings
from models.beam.response.settling import settle
from models.beam.start import initial_gaps, initial_state, one_system
from models.beam.structure.modal import Array, beams
from models.numerics.batch_means import mean_and_error
from models.numerics.exponents import grown

BATCHES = 32
_TURN = 64  # periods in which a tangent turns into the direction of fastest growth
_STRETCH = 4  # periods between two rescalings of a tangent


def lyapunov_exponent(
    params: Params, settings: Settings, periods: int = 1024
) -> tuple[float, float]:
    """Return the largest Lyapunov exponent of one beam's settled response at its initial gaps.

    Parameters
    ----------
    params : Params
        Each field a float.
    settings : Settings
        With the fast propagator.
    periods : int
        As in `exponents`.

    Returns
    -------
    exponent, error : float
        [s-1], and the standard error of the time mean.

    Raises
    ------
    ValueError
        If the load is random, the propagator exact, or contact too stiff for the fast one.
    """
    if params.random_force_level > 0:
        raise ValueError("a response to a random load has no Lyapunov exponent")
    p: Rows = Params._make(np.full(1, float(value)) for value in params)
    _, system = one_system(beams(p, settings), settings)
    if not isinstance(system, System):
        raise ValueError("this requires the fast propagator, and contact that its steps can follow")
    state = initial_state(lanes, system, p)
    gaps = initial_gaps(p)
    settle(lanes, system, state, gaps)
    exponent, error = exponents(system, state, gaps, periods)
    return float(exponent[0]), float(error[0])


def exponents(
    system: System, state: Array, gaps: Array, periods: int = 1024
) -> tuple[Array, Array]:
    """Return the largest Lyapunov exponent of n responses at constant gaps.

    Positive for chaos; on a stable periodic orbit the logarithm of the largest multiplier over the
    period in seconds.

    Parameters
    ----------
    system : System
        Prepared by `models.beam.lanes`.
    state : ndarray, shape (n, 2 m + 4)
        Settled; updated in place.
    gaps : ndarray, shape (n, 2)
        In initial gaps.
    periods : int
        Forcing periods to average over, rounded up to a multiple of 128.

    Returns
    -------
    exponent, error : ndarray, shape (n,)
        [s-1], and the standard error of the time mean.
    """
    n, size = state.shape
    tangents = np.ones((n, size - 1, 1)) / size  # the clock has no tangent
    gaps = gaps.copy()
    still = np.zeros_like(gaps)

    def growth(stretches: int) -> Array:
        logs = np.empty((n, stretches))
        for k in range(stretches):
            before = state.copy()
            record = lanes.advance(system, state, gaps, still, _STRETCH, trace=True)
            carry(system, before, gaps, record.trace, tangents)
            logs[:, k] = grown(tangents[:, :, 0])
        return logs

    growth(_TURN // _STRETCH)
    per_batch = -(-periods // (BATCHES * _STRETCH))
    batches = growth(BATCHES * per_batch).reshape(n, BATCHES, per_batch).mean(axis=2)
    exponent, error = mean_and_error(batches / _STRETCH)
    to_rate = system.beams.forcing / (2 * np.pi)
    return exponent * to_rate, error * to_rate
