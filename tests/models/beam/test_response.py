"""The settled response: the paper's regimes and work-rates, and when to stop looking."""

import numpy as np
import pytest

from models.beam import exact, lanes
from models.beam.modal import beams
from models.beam.parameters import REGIMES, Params, Settings
from models.beam.response import settle


def nominal(**values):
    fields = {**Params._field_defaults, **values}
    return Params(*(np.array([v], float) for v in fields.values()))


def settled(p, propagator=lanes, **settings):
    """Return the response and its work-rate per w0 tau, the paper's nondimensional unit."""
    s = Settings(**settings)
    b = beams(p, s)
    ((_, system),) = propagator.groups(b, s)
    x0 = p.initial_gap
    state = propagator.start(system, p.initial_displacement / x0, p.initial_velocity / x0)
    gaps = np.stack([1 + p.gap_asymmetry / 2, 1 - p.gap_asymmetry / 2], axis=1)
    response = settle(propagator, system, state, gaps)
    rate = response.work * (b.forcing / b.frequency[:, 0] / (2 * np.pi))[:, None]
    return response, rate[0]


@pytest.mark.parametrize(
    ("frequency", "heavy", "light", "regime"),
    [
        (32.3591, 3.919359, 3.394367, "period-1-asymmetric"),  # omega = 5.61
        (54.7970, 32.36390, 32.36390, "period-1-symmetric"),  # omega = 9.5
        (57.1042, 82.55679, 29.56878, "period-1-asymmetric"),  # omega = 9.900
    ],
)
def test_known_periodic_work_rates_are_met_within_two_per_mille(frequency, heavy, light, regime):
    response, rate = settled(nominal(forcing_frequency=frequency))
    assert sorted(rate) == pytest.approx([light, heavy], rel=2e-3)
    assert REGIMES[response.regime[0]] == regime
    assert response.period[0] == 1
    assert (response.error == 0).all()


@pytest.mark.parametrize("frequency", [32.3591, 57.1042])
def test_more_steps_come_closer_to_the_known_work_rates(frequency):
    known = {32.3591: [3.394367, 3.919359], 57.1042: [29.56878, 82.55679]}[frequency]
    _, rate = settled(nominal(forcing_frequency=frequency), steps_per_period=1600)
    assert sorted(rate) == pytest.approx(known, rel=5e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("omega", "gap", "mean", "band"),
    [(5.61, 2.5, 7.78, 0.04), (9.9, 3.0, 191.2, 0.6), (7.5, 1.0, 14.597, 0.010)],
)
def test_known_aperiodic_means_are_met_within_their_errors(omega, gap, mean, band):
    fundamental = 57.1042 / 9.900
    p = nominal(forcing_frequency=omega * fundamental)
    s = Settings()
    b = beams(p, s)
    ((_, system),) = lanes.groups(b, s)
    state, gaps = lanes.start(system, np.zeros(1), np.zeros(1)), np.full((1, 2), gap)
    lanes.advance(system, state, gaps, np.zeros((1, 2)), 1000)
    work = lanes.advance(system, state, gaps, np.zeros((1, 2)), 40_000).work[0].mean(axis=1)
    rate = work * b.forcing[0] / b.frequency[0, 0] / (2 * np.pi)
    batches = rate.reshape(100, -1).mean(axis=1)
    error = batches.std(ddof=1) / 10
    assert error < 0.01 * mean
    assert rate.mean() == pytest.approx(mean, abs=3 * np.hypot(error, band))


def test_an_aperiodic_mean_comes_with_an_error_that_it_keeps():
    p = nominal(forcing_frequency=7.5 * 57.1042 / 9.900)
    response, rate = settled(p)
    error = response.error[0] * rate / response.work[0]
    assert REGIMES[response.regime[0]] == "aperiodic"
    assert (error > 0).all() and (error < 0.05 * rate).all()
    assert rate.mean() == pytest.approx(14.597, abs=4 * error.mean())


def test_a_beam_that_never_touches_does_no_work():
    response, rate = settled(nominal(force_amplitude=0.05))
    assert REGIMES[response.regime[0]] == "no-impact"
    assert (rate == 0).all() and (response.peak == 0).all()


def test_contact_on_the_way_to_rest_does_not_count_in_the_settled_response():
    response, rate = settled(nominal(force_amplitude=0.05, initial_velocity=0.5))
    assert REGIMES[response.regime[0]] == "no-impact"
    assert (rate == 0).all() and (response.peak == 0).all()


def test_mirrored_gaps_give_the_mirrored_response():
    common = {"forcing_frequency": 20.0, "mass_damping": 30.0, "force_amplitude": 3.0}
    _, right_wide = settled(nominal(gap_asymmetry=1.5, **common))
    _, left_wide = settled(nominal(gap_asymmetry=-1.5, **common))
    assert right_wide.max() > 1.02 * right_wide.min()
    assert right_wide == pytest.approx(left_wide[::-1], rel=1e-3)


def test_a_period_longer_than_one_is_told_with_its_length():
    strobe = np.zeros((1, 32, 2))
    strobe[0, :, 0] = np.tile([1.0, 2.0, 4.0, 3.0], 8)
    from models.beam.response import _distances, _period

    distance = _distances(strobe)
    assert _period(np.full_like(distance, np.inf), distance, strobe)[0] == 4


def test_a_response_that_still_drifts_is_not_taken_for_periodic():
    from models.beam.response import _distances, _period

    drift = 1 + 1e-3 * np.arange(64)[None, :, None] * np.ones((1, 1, 2))
    before, now = _distances(drift[:, :32]), _distances(drift[:, 32:])
    assert _period(before, now, drift[:, 32:])[0] == 0


@pytest.mark.slow
def test_both_propagators_settle_on_the_same_response():
    p = nominal(forcing_frequency=54.797)
    fast, slow = (settled(p, propagator)[1] for propagator in (lanes, exact))
    assert fast == pytest.approx(slow, rel=1e-3)
