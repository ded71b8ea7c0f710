"""The exact propagator against balances of energy and values of the literature."""

import numpy as np
import pytest
from exact_beams import NOMINAL, at_omega, set_up

from models.beam.structure.modal import Beams


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
    work_rates = np.sort(work / (2 * np.pi / omega))[::-1]
    np.testing.assert_allclose(work_rates, rates, rtol=3e-7)


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
    sampling_error = batches.std(ddof=1) / np.sqrt(len(batches))
    assert abs(batches.mean() - mean) < 4 * np.hypot(sampling_error, error)
