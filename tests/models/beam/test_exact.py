"""The exact propagator against independent integrators, balances and published values."""

from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.linalg import expm
from twins import assemble, by_dop853, by_newmark, first_order, initial_state

from models.beam import exact
from models.beam.parameters import Params, Settings
from models.beam.structure.modal import Beams, beams

NOMINAL = Params()
FAR = 1e6  # a gap never crossed [X0]


class Setup(NamedTuple):
    """One or more beams, ready to be advanced."""

    modal: Beams
    system: Any
    state: np.ndarray
    gaps: np.ndarray

    def advance(self, periods, growth=0.0, trace=False):
        growth = np.full_like(self.gaps, growth)
        return exact.advance(self.system, self.state, self.gaps, growth, periods, trace)


def set_up(*rows, gap=1.0, **settings):
    settings = Settings(**settings)
    p = Params(*np.array(rows, float).T)
    modal = beams(p, settings)
    ((_, system),) = exact.groups(modal, settings)
    state = exact.start(
        system, p.initial_displacement / p.initial_gap, p.initial_velocity / p.initial_gap
    )
    gaps = gap * np.stack([1 + p.gap_asymmetry / 2, 1 - p.gap_asymmetry / 2], axis=1)
    return Setup(modal, system, state, gaps)


def at_omega(omega, **settings):
    """Return the nominal beam, forced at a multiple of its fundamental frequency."""
    w0 = set_up(NOMINAL, **settings).modal.frequency[0, 0]
    return NOMINAL._replace(forcing_frequency=omega * w0 / (2 * np.pi))


def critically_damped(elements, mode):
    w = set_up(NOMINAL, elements=elements).modal.frequency[0, mode]
    c_k = (2 * w - NOMINAL.mass_damping) / w**2
    return NOMINAL._replace(stiffness_damping=c_k)


def deflected(p):
    return p._replace(initial_displacement=4e-4, initial_velocity=-0.1)


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


# Energy


def energy(setup, contact=True):
    """Return the mechanical energy of one beam [k_c X0^2], its springs at the tip included."""
    m = setup.modal.frequency.shape[1]
    z, v = setup.state[0, :m], setup.state[0, m : 2 * m] * setup.modal.forcing[0]
    modal = 0.5 * ((v**2 + (setup.modal.frequency[0] * z) ** 2) / setup.modal.mobility[0]).sum()
    over = np.maximum([z.sum() - setup.gaps[0, 0], -z.sum() - setup.gaps[0, 1]], 0)
    return modal / setup.modal.stiffness[0] + 0.5 * (over**2).sum()


def dissipation(setup):
    """Return the power lost to damping, per unit of Omega t."""
    m = setup.modal.frequency.shape[1]
    v = setup.state[0, m : 2 * m] * setup.modal.forcing[0]
    power = (2 * setup.modal.decay[0] * v**2 / setup.modal.mobility[0]).sum()
    return power / setup.modal.stiffness[0] / setup.modal.forcing[0]


def test_energy_lost_in_free_rattling_is_what_damping_takes():
    """Without a force its frequency is arbitrary, so that a period can be a short step."""
    p = NOMINAL._replace(force_amplitude=0.0, forcing_frequency=1e4, initial_displacement=2e-3)
    setup = set_up(p, elements=2)
    steps = 10_000
    start, power, work = energy(setup), [dissipation(setup)], np.zeros(2)
    for _ in range(steps):
        work += setup.advance(1).work[0, 0]
        power.append(dissipation(setup))
    lost = 2 * np.pi * (np.sum(power) - 0.5 * (power[0] + power[-1]))
    assert (work > 100).all()
    assert lost > 0.1 * start
    np.testing.assert_allclose(start - energy(setup), lost, rtol=1e-5)


@pytest.mark.parametrize("omega", [5.61, 9.9])
def test_in_a_settled_orbit_damping_takes_what_the_force_gives(omega):
    """Modes driven by the harmonics of force and contact return the orbit's displacement."""
    samples = 1 << 16
    setup = set_up(at_omega(omega), steps_per_period=samples)
    setup.advance(3000)
    x = np.roll(setup.advance(1, trace=True).trace[0], 1)
    b = Beams(*(a[0] for a in setup.modal))
    contact = np.maximum(x - 1, 0) - np.maximum(-x - 1, 0)
    phase = 2 * np.pi * np.arange(samples) / samples
    total = np.fft.rfft(b.force * np.cos(phase) - b.stiffness * contact) / samples
    n = np.arange(len(total))[:, None] * b.forcing
    velocity = 1j * n * b.mobility / (b.frequency**2 - n**2 + 2j * n * b.decay) * total[:, None]
    lost = (2 * 2 * b.decay / b.mobility * abs(velocity) ** 2).sum()
    given = 2 * (0.5 * b.force * 1j * b.forcing * np.fft.rfft(x)[1] / samples).real
    displacement = np.fft.irfft(
        (b.mobility / (b.frequency**2 - n**2 + 2j * n * b.decay)).sum(axis=1) * total * samples
    )
    np.testing.assert_allclose(displacement, x, rtol=0, atol=1e-6)
    np.testing.assert_allclose(lost, given, rtol=1e-6)


# Values of the literature's nominal set


@pytest.mark.parametrize(
    ("omega", "rates"),
    [(5.61, (3.919359, 3.394367)), (9.9, (82.55679, 29.56878)), (9.5, (32.36390, 32.36390))],
)
def test_work_rates_of_settled_orbits(omega, rates):
    """In k_c X0^2 w0; which site is the heavy one depends on the start."""
    setup = set_up(at_omega(omega))
    work = setup.advance(4000).work[0, -1]
    found = np.sort(work / (2 * np.pi / omega))[::-1]
    np.testing.assert_allclose(found, rates, rtol=3e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("omega", "gap", "mean", "error"),
    [(5.61, 2.5, 7.78, 0.04), (9.9, 3.0, 191.2, 0.6), (7.5, 1.0, 14.597, 0.010)],
)
def test_means_of_aperiodic_motion(omega, gap, mean, error):
    """The mean of both sites, within four standard errors of the difference."""
    setup = set_up(at_omega(omega), gap=gap)
    setup.advance(1000)
    batches = setup.advance(40_000).work[0].reshape(40, 1000, 2).mean(axis=(1, 2))
    batches /= 2 * np.pi / omega
    own = batches.std(ddof=1) / np.sqrt(len(batches))
    assert abs(batches.mean() - mean) < 4 * np.hypot(own, error)


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
