"""The exact propagator against independent integrators, and what its callers rely on."""

import numpy as np
import pytest
from exact_beams import FAR, NOMINAL, at_omega, critically_damped, deflected, set_up
from scipy.linalg import expm
from twins import assemble, by_dop853, by_newmark, first_order, initial_state

from models.beam.parameters import Params

# Free flight


@pytest.mark.parametrize(
    ("p", "elements"),
    [
        (NOMINAL, 10),
        (NOMINAL._replace(stiffness_damping=3.6e-4), 10),  # most modes overdamped
        (critically_damped(4, 2), 4),
        (critically_damped(4, 9), 4),
    ],
)
def test_free_flight_is_the_matrix_exponential(p, elements):
    p = deflected(p)
    beam = assemble(p, elements)
    matrix, _, harmonic = first_order(p, beam)
    size, omega = len(matrix), 2 * np.pi * p.forcing_frequency
    # In units that balance deflections and velocities, with cos and sin of the force as unknowns.
    units = np.repeat([1.0, omega], size // 2)
    augmented = np.zeros((size + 2, size + 2))
    augmented[:size, :size] = matrix * units / units[:, None] / omega
    augmented[:size, size] = harmonic / units / omega
    augmented[size:, size:] = [[0, -1], [1, 0]]
    over_a_period = expm(2 * np.pi * augmented)
    y = np.concatenate([initial_state(p, beam) / units, [1, 0]])

    setup = set_up(p, gap=FAR, elements=elements)
    for strobe in setup.advance(3).strobe[0]:
        y = over_a_period @ y
        expected = y[[beam.tip, size // 2 + beam.tip]] / p.initial_gap
        np.testing.assert_allclose(strobe, expected, rtol=0, atol=1e-9 * abs(expected).max())


# Contact


HARD = {
    "9.9": (NOMINAL, 3, 3),
    "5.61": (NOMINAL._replace(forcing_frequency=32.3591), 3, 3),
    "unequal gaps": (NOMINAL._replace(gap_asymmetry=0.8), 2, 3),
    "starts in contact": (
        NOMINAL._replace(initial_displacement=7e-4, initial_velocity=0.1, gap_asymmetry=-1.2),
        2,
        2,
    ),
    "overdamped": (NOMINAL._replace(stiffness_damping=3.6e-4, forcing_frequency=32.0), 3, 2),
    "stiff stops": (NOMINAL._replace(contact_stiffness=4e5), 3, 2),
    "critically damped": (critically_damped(3, 3), 3, 2),
    "slow force": (NOMINAL._replace(forcing_frequency=5.0, force_amplitude=3.0), 1, 2),
}


def assert_matches_dop853(p, elements, periods, tolerance):
    setup = set_up(p, elements=elements)
    record = setup.advance(periods)
    twin = by_dop853(p, elements, periods)
    speed = twin.velocity / setup.modal.forcing[0]
    assert (record.work.sum(axis=1) > 0).any()
    np.testing.assert_allclose(record.strobe[0, :, 0], twin.displacement, rtol=0, atol=tolerance)
    np.testing.assert_allclose(record.strobe[0, :, 1], speed, rtol=0, atol=tolerance)
    np.testing.assert_allclose(record.work[0], twin.work, rtol=0, atol=tolerance)
    np.testing.assert_allclose(record.peak[0], twin.peak, rtol=0, atol=tolerance)


@pytest.mark.parametrize("case", HARD)
def test_motion_matches_dop853_in_physical_coordinates(case):
    assert_matches_dop853(*HARD[case], tolerance=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [57.1042, 32.3591])
def test_five_periods_from_rest_match_dop853(frequency):
    """The nominal mesh, all 22 modes."""
    p = NOMINAL._replace(forcing_frequency=frequency)
    assert_matches_dop853(p, 10, 5, tolerance=1e-8)


@pytest.mark.parametrize("frequency", [57.1042, 32.3591])
def test_newmark_converges_to_it_at_second_order(frequency):
    p = NOMINAL._replace(forcing_frequency=frequency)
    setup = set_up(p)
    record = setup.advance(2)
    forcing = setup.modal.forcing[0]
    errors = []
    for steps in (500, 2000):
        twin = by_newmark(p, 10, 2, steps)
        strobe = np.stack([twin.displacement, twin.velocity / forcing], axis=1)
        errors.append(
            [np.abs(strobe - record.strobe[0]).max(), np.abs(twin.work - record.work[0]).max()]
        )
    order = np.log(np.divide(*errors)) / np.log(4)
    np.testing.assert_allclose(order, 2, atol=0.25)
    assert max(errors[1]) < 2e-3


@pytest.mark.parametrize("depth", [1e-5, 1e-8, 1e-11])
def test_the_briefest_contact_is_met(depth):
    """A gap that the steady free motion crosses by a hair is touched once a period at each site."""
    setup = set_up(NOMINAL, gap=FAR)
    setup.advance(2000)
    amplitude = abs(setup.system.modal.sum())
    setup.gaps[:] = amplitude * (1 + 1e-12)
    assert not setup.advance(3).work.any()
    setup.gaps[:] = amplitude * (1 - depth)
    record = setup.advance(1)
    # One hump of depth d is worth d^2; the stop's impulse is of order d^(3/2).
    tolerance = 10 * np.sqrt(depth) + 1e-13 / depth
    np.testing.assert_allclose(record.peak[0] / amplitude, depth, rtol=tolerance)
    np.testing.assert_allclose(record.work[0, 0], record.peak[0] ** 2, rtol=1e-12 + 1e-19 / depth)


# What callers rely on


def test_rows_and_calls_do_not_matter():
    """Beams advanced together or alone, at once or in parts, come out bit for bit alike."""
    rows = (NOMINAL, NOMINAL._replace(stiffness_damping=4e-5), at_omega(5.61))
    together, alone = set_up(*rows), set_up(rows[1])
    record = together.advance(7, growth=1e-4)
    taken = alone._replace(system=together.system.take(np.array([1])))
    parts = [alone.advance(3, growth=1e-4), taken.advance(4, growth=1e-4, trace=True)]
    work = np.concatenate([part.work[0] for part in parts])
    np.testing.assert_array_equal(record.work[1], work)
    np.testing.assert_array_equal(together.state[1], alone.state[0])
    np.testing.assert_array_equal(together.gaps[1], alone.gaps[0])
    strobe = np.concatenate([part.strobe[0] for part in parts])
    np.testing.assert_array_equal(record.strobe[1], strobe)


def test_a_trace_passes_through_the_strobe_points():
    setup = set_up(NOMINAL, steps_per_period=60)
    record = setup.advance(5, trace=True)
    np.testing.assert_allclose(
        record.trace.reshape(5, 60)[:, -1], record.strobe[0, :, 0], rtol=0, atol=1e-12
    )
    coarse = set_up(NOMINAL, steps_per_period=30).advance(5, trace=True)
    np.testing.assert_allclose(coarse.trace[0], record.trace[0, 1::2], rtol=0, atol=1e-12)


def test_gaps_grow_by_the_work_of_finished_contacts():
    setup = set_up(at_omega(5.61))
    growth = 1e-3
    work = setup.advance(23, growth=growth).work[0].sum(axis=0)
    unfinished = setup.state[0, -2:]
    assert work.min() > 10
    np.testing.assert_allclose(setup.gaps[0] - 1, growth * (work - unfinished), rtol=1e-12)


def test_a_beam_at_rest_stays_at_rest():
    setup = set_up(NOMINAL._replace(force_amplitude=0.0))
    record = setup.advance(2)
    assert not record.strobe.any()
    assert not record.work.any()


def test_a_beam_beyond_the_budget_is_marked_not_endless():
    """A force thousands of times slower than the beam leaves too many events to a period."""
    slow = Params(
        stiffness_damping=1e-9,
        mass_damping=0.05,
        forcing_frequency=0.01,
        initial_displacement=2e-3,
    )
    setup = set_up(slow, NOMINAL, elements=2)
    record = setup.advance(2)
    assert np.isnan(record.work[0]).all()
    assert np.isnan(record.strobe[0]).all()
    assert np.isnan(setup.state[0]).all()
    assert np.isfinite(record.work[1]).all()
