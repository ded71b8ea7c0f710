"""The tangent of the fast propagator, and the Lyapunov exponent it gives."""

import numpy as np
import pytest
from nominal_beams import nominal, prepared

from models.beam import exact, lanes
from models.beam.explore.lyapunov import exponents, lyapunov_exponent
from models.beam.lanes.tangents import carry
from models.beam.parameters import Params, Settings
from models.beam.response.settling import settle
from models.numerics.blocks import LANES

FUNDAMENTAL = 57.1042 / 9.900  # [Hz]


def rattling(propagator, p, periods=40, **settings):
    """Return system, state and gaps after some periods from rest."""
    system, n = prepared(propagator, p, **settings), len(p.length)
    state, gaps = propagator.start(system, np.zeros(n), np.zeros(n)), np.ones((n, 2))
    gaps[:, 0] += p.gap_asymmetry / 2
    gaps[:, 1] -= p.gap_asymmetry / 2
    propagator.advance(system, state, gaps, np.zeros_like(gaps), periods)
    return system, state, gaps


def differences(system, state, gaps, periods, step=1e-6):
    """Return central differences of `lanes.advance` for one beam, all columns at once."""
    size = state.shape[1]
    moved = np.concatenate([state + step * np.eye(size), state - step * np.eye(size)])
    rows = np.zeros(2 * size, int)
    at = np.repeat(gaps, 2 * size, axis=0)
    lanes.advance(system.take(rows), moved, at, np.zeros_like(at), periods)
    moved[:, lanes.CLOCK] = 0.0
    return (moved[:size] - moved[size:]).T / (2 * step)


@pytest.mark.parametrize(
    "varied",
    [
        {"forcing_frequency": 32.3591},
        {"forcing_frequency": 57.1042},
        {"forcing_frequency": 40.0, "gap_asymmetry": 0.8, "force_amplitude": 9.0},
        {"stiffness_damping": 2e-4, "forcing_frequency": 20.0},
    ],
)
@pytest.mark.parametrize("periods", [1, 3])
def test_the_monodromy_is_what_central_differences_of_the_scheme_give(varied, periods):
    system, state, gaps = rattling(lanes, nominal(**varied))
    before = state.copy()
    flow = lanes.monodromy(system, state, gaps, periods)
    assert np.array_equal(state, before)
    expected = differences(system, state, gaps, periods)
    assert np.abs(flow[0] - expected).max() < 1e-6 * np.abs(expected).max()


def test_every_step_counts_where_contact_is_short_and_begins_and_ends_within_steps():
    p = nominal(forcing_frequency=57.1042, contact_stiffness=1e5)
    system, state, gaps = rattling(lanes, p, steps_per_period=192)
    record = lanes.advance(system, state.copy(), gaps.copy(), np.zeros((1, 2)), 1, trace=True)
    size = state.shape[1] - 1
    for steps in (1, 2, 50, 191):
        tangents = np.eye(size)[None].copy()
        carry(system, state, gaps, record.trace[:, :steps].copy(), tangents)
        rest = np.eye(size)[None].copy()
        x = np.concatenate([state[0, [-2, -3]], record.trace[0]])
        between = state.copy()
        between[0, [-3, -2]] = x[steps + 1], x[steps]
        carry(system, between, gaps, record.trace[:, steps:].copy(), rest)
        whole = lanes.monodromy(system, state, gaps, 1)[:, :size, :size]
        assert np.allclose(rest @ tangents, whole, rtol=0, atol=1e-10 * np.abs(whole).max())


def test_multipliers_are_those_of_the_exact_propagator_but_for_the_step():
    p = nominal(forcing_frequency=54.797)
    sizes = []
    for propagator, steps in ((lanes, 100), (lanes, 200), (lanes, 400)):
        system, state, gaps = rattling(propagator, p, 1500, steps_per_period=steps)
        sizes.append(np.abs(np.linalg.eigvals(propagator.monodromy(system, state, gaps, 1))).max())
    expected = 0.98859  # of the paper's robust case, by the exact propagator
    assert np.abs(np.array(sizes) - expected)[2] < 2e-5
    assert np.abs(np.array(sizes) - expected)[0] < 5e-4


def test_a_row_has_the_same_tangent_alone_and_anywhere_among_others():
    rng = np.random.default_rng(1)
    n = LANES + 5
    p = nominal(n, force_amplitude=rng.uniform(4, 8, n))
    system, state, gaps = rattling(lanes, p, steps_per_period=128)
    together = lanes.monodromy(system, state, gaps, 2)
    for row in (0, 7, n - 1):
        rows = np.array([row])
        alone = lanes.monodromy(system.take(rows), state[rows], gaps[rows], 2)
        assert np.array_equal(alone[0], together[row])


def test_the_exponent_of_a_stable_orbit_is_that_of_its_largest_multiplier():
    p = nominal(forcing_frequency=5.61 * FUNDAMENTAL)
    system = prepared(lanes, p)
    state, gaps = lanes.start(system, np.zeros(1), np.zeros(1)), np.ones((1, 2))
    response = settle(lanes, system, state, gaps)
    expected = np.log(response.multiplier[0]) * p.forcing_frequency[0]
    exponent, error = exponents(system, state, gaps, 2048)
    assert exponent[0] == pytest.approx(expected, rel=0.03)
    assert exponent[0] + error[0] < 0
    plain = Params(forcing_frequency=float(p.forcing_frequency[0]))
    assert lyapunov_exponent(plain, Settings())[0] == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(
    ("params", "settings", "message"),
    [
        (Params(random_force_level=1e-3), Settings(), "random load"),
        (Params(), Settings(propagator="exact"), "fast propagator"),
    ],
)
def test_what_has_no_exponent_is_said(params, settings, message):
    with pytest.raises(ValueError, match=message):
        lyapunov_exponent(params, settings)


@pytest.mark.slow
def test_the_exponent_of_chaos_is_the_rate_at_which_exact_neighbours_part():
    p = nominal(forcing_frequency=7.5 * FUNDAMENTAL)
    system, state, gaps = rattling(lanes, p, 500)
    exponent, error = exponents(system, state, gaps, 4096)
    assert exponent[0] > 5 * error[0]

    system, perturbed, gaps = rattling(exact, p, 500)
    distance, stretch, looks = 1e-6, 2, 640
    other = perturbed.copy()
    other[:, 0] += distance
    logs = np.zeros(looks)
    for k in range(looks):
        for state in (perturbed, other):
            exact.advance(system, state, gaps.copy(), np.zeros((1, 2)), stretch)
        apart = (other - perturbed)[:, :-2]
        grown = np.linalg.norm(apart)
        logs[k] = np.log(grown / distance) / stretch * p.forcing_frequency[0]
        other = perturbed.copy()
        other[:, :-2] += apart * distance / grown
    rates = logs.reshape(40, -1).mean(axis=1)
    spread = np.hypot(error[0], rates.std(ddof=1) / np.sqrt(len(rates)))
    assert exponent[0] == pytest.approx(rates.mean(), abs=3 * spread)
    assert spread < 0.1 * rates.mean()
