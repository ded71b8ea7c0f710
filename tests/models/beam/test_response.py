"""The settled response: the paper's regimes and work-rates, and when to stop looking."""

import numpy as np
import pytest

from models.beam import MODEL, exact, lanes
from models.beam.parameters import REGIMES, Params, Settings
from models.beam.response.settling import settle
from models.beam.structure.modal import beams
from models.numerics.multipliers import largest_multiplier
from uq.contract import Status

DOUBLED = 7.05 * 57.1042 / 9.900  # omega = 7.05


def nominal(**values):
    fields = {**Params._field_defaults, **values}
    return Params(*(np.array([v], float) for v in fields.values()))


def settled(p, propagator=lanes, **settings):
    """Return the response and its work-rate per w0 tau, the paper's dimensionless unit."""
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
    expected = {32.3591: [3.394367, 3.919359], 57.1042: [29.56878, 82.55679]}[frequency]
    _, rate = settled(nominal(forcing_frequency=frequency), steps_per_period=1600)
    assert sorted(rate) == pytest.approx(expected, rel=5e-4)


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


def symmetric_orbit(frequency):
    """Return system and state on the orbit that is stable at 54.797 Hz, wherever it has gone."""
    state, gaps, s = None, np.ones((1, 2)), Settings(steps_per_period=128)
    for at in np.linspace(54.797, frequency, 5):
        ((_, system),) = lanes.groups(beams(nominal(forcing_frequency=at), s), s)
        if state is None:
            state = lanes.start(system, np.zeros(1), np.zeros(1))
            settle(lanes, system, state, gaps)
        for _ in range(8):
            image = state.copy()
            lanes.advance(system, image, gaps, np.zeros((1, 2)), 1)
            flow = lanes.monodromy(system, state, gaps, 1)[0]
            state = state + np.linalg.solve(np.eye(len(flow)) - flow, (image - state)[0])
    return system, state


def test_an_orbit_of_two_periods_is_found_and_comes_back_after_two():
    p = nominal(forcing_frequency=DOUBLED)
    s = Settings()
    ((_, system),) = lanes.groups(beams(p, s), s)
    state, gaps = lanes.start(system, np.zeros(1), np.zeros(1)), np.ones((1, 2))
    response = settle(lanes, system, state, gaps)
    assert REGIMES[response.regime[0]] == "period-k"
    assert response.period[0] == 2
    before = state.copy()
    record = lanes.advance(system, state, gaps, np.zeros((1, 2)), 2)
    assert np.abs(np.delete(state - before, lanes.CLOCK, axis=1)).max() < 1e-7
    assert record.work[0].mean(axis=0) == pytest.approx(response.work[0], rel=1e-7)
    assert np.abs(record.work[0, 0] - record.work[0, 1]).max() > 1e-3 * response.work.max()
    assert record.peak[0] == pytest.approx(response.peak[0], rel=1e-7)


@pytest.mark.parametrize("frequency", [32.3591, 54.797, 57.1042])
def test_the_settled_state_is_on_the_orbit(frequency):
    p = nominal(forcing_frequency=frequency)
    s = Settings()
    ((_, system),) = lanes.groups(beams(p, s), s)
    state, gaps = lanes.start(system, np.zeros(1), np.zeros(1)), np.ones((1, 2))
    response = settle(lanes, system, state, gaps)
    before = state.copy()
    record = lanes.advance(system, state, gaps, np.zeros((1, 2)), 1)
    assert np.abs(np.delete(state - before, lanes.CLOCK, axis=1)).max() < 1e-8
    assert record.work[0, 0] == pytest.approx(response.work[0], rel=1e-8)


def test_the_multiplier_of_the_robust_orbit_is_the_known_one():
    response, _ = settled(nominal(forcing_frequency=54.797), steps_per_period=400)
    assert response.multiplier[0] == pytest.approx(0.98859, abs=3e-5)


@pytest.mark.parametrize("values", [{"force_amplitude": 0.05}, {"forcing_frequency": 43.26}])
def test_without_impacts_or_a_period_there_is_no_multiplier(values):
    response, _ = settled(nominal(**values))
    assert np.isnan(response.multiplier[0])


def test_a_symmetric_orbit_that_has_lost_its_stability_is_left():
    system, state = symmetric_orbit(57.1042)
    gaps = np.ones((1, 2))
    record = lanes.advance(system, state.copy(), gaps, np.zeros((1, 2)), 1)
    assert record.work[0, 0, 0] == pytest.approx(record.work[0, 0, 1], rel=1e-9)
    assert largest_multiplier(lanes.monodromy(system, state, gaps, 1))[0] > 1.04
    state[0, 0] += 1e-6
    response = settle(lanes, system, state, gaps)
    assert REGIMES[response.regime[0]] == "period-1-asymmetric"
    assert response.multiplier[0] < 1


def test_upon_an_unstable_orbit_nothing_periodic_is_reported():
    system, state = symmetric_orbit(57.1042)
    response = settle(lanes, system, state, np.ones((1, 2)))
    assert REGIMES[response.regime[0]] in ("aperiodic", "period-1-asymmetric")


def test_a_row_settles_alike_alone_and_among_others():
    rng = np.random.default_rng(6)
    n = 40
    fields = {**Params._field_defaults, "forcing_frequency": 57.1042}
    p = Params(*(np.full(n, float(v)) for v in fields.values()))
    p = p._replace(force_amplitude=rng.uniform(5, 7, n))
    s = Settings(steps_per_period=96)
    ((_, system),) = lanes.groups(beams(p, s), s)

    def settle_rows(rows):
        state = lanes.start(system, np.zeros(n), np.zeros(n))[rows]
        return [state, *settle(lanes, system.take(rows), state, np.ones((len(rows), 2)))]

    together = settle_rows(np.arange(n))
    assert len(np.unique(together[4])) > 1
    for row in (0, 17, n - 1):
        alone = settle_rows(np.array([row]))
        for some, alone_row in zip(together, alone, strict=True):
            assert np.array_equal(some[row], alone_row[0], equal_nan=True)


@pytest.mark.slow
def test_both_propagators_settle_on_the_same_response():
    p = nominal(forcing_frequency=54.797)
    fast, slow = (settled(p, propagator)[1] for propagator in (lanes, exact))
    assert fast == pytest.approx(slow, rel=1e-3)


def test_bits_do_not_depend_on_company():
    """Rows of different damping keep different numbers of modes."""
    rng = np.random.default_rng(8)
    n = 24
    x = np.tile(list(MODEL.nominal.values()), (n, 1))
    for name, low, high in (("stiffness_damping", 5e-7, 3e-4), ("forcing_frequency", 20.0, 90.0)):
        x[:, Params._fields.index(name)] = rng.uniform(low, high, n)
    settings = Settings(depths=(1e-5,), accuracy=0.3)
    together, _ = MODEL.batch(x, np.zeros(n, np.uint64), settings)
    for i in range(0, n, 2):
        alone, _ = MODEL.batch(x[i : i + 1], np.zeros(1, np.uint64), settings)
        for name, values in together.items():
            np.testing.assert_array_equal(alone[name][0], values[i], err_msg=f"{name}, row {i}")


def test_a_response_that_remembers_its_start_is_no_time_mean():
    """At 1500 Hz and next to no damping, a thousand periods are less than one second."""
    x = np.tile(list(MODEL.nominal.values()), (1, 1))
    changes = {
        "forcing_frequency": 1500.0,
        "force_amplitude": 200.0,
        "mass_damping": 0.2,
        "initial_velocity": 0.1,
    }
    for name, value in changes.items():
        x[:, Params._fields.index(name)] = value
    outputs, status = MODEL.batch(x, np.zeros(1, np.uint64), Settings())
    assert status[0] == Status.OUT_OF_BUDGET
    assert np.isnan(outputs["work_rate"]).all()
    assert np.isnan(outputs["first_time_to_depth"]).all()
