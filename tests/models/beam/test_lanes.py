"""The fast propagator: exact modes, the right order, and rows that do not see their neighbours."""

import numpy as np
import pytest
from nominal_beams import nominal, prepared
from scipy.linalg import expm

from models.beam import exact, lanes
from models.beam.lanes.recurrence import mode_step
from models.beam.lanes.systems import COMPLIANCE, LADDER, gains
from models.beam.parameters import Settings
from models.beam.response.settling import settle
from models.beam.structure.modal import beams
from models.numerics.blocks import LANES


def at_rest(propagator, system, n=1):
    return propagator.start(system, np.zeros(n), np.zeros(n)), np.ones((n, 2))


@pytest.mark.parametrize(
    ("frequency", "decay", "step"),
    [
        (36.0, 1.0, 1e-4),
        (36.0, 1.0, 0.05),
        (8e4, 1e3, 5e-5),
        (8e4, 8e4, 5e-5),  # critically damped
        (8e4, 4e5, 5e-5),  # overdamped
    ],
)
def test_a_mode_is_propagated_exactly_under_a_force_linear_in_the_step(frequency, decay, step):
    w, d, h = frequency, decay, step
    # z, z'/w and a force g0 + (g1 - g0) t/h as four first-order equations
    a = np.zeros((4, 4))
    a[0, 1], a[1, 0], a[1, 1], a[1, 2], a[2, 3] = w, -w, -2 * d, 1 / w, 1 / h
    flow = expm(a * h)
    p11, p12, p21, p22, a1, a2, b1, b2 = mode_step(w, d, h)
    assert np.allclose([[p11, p12], [p21, p22]], flow[:2, :2], rtol=1e-10, atol=1e-13)
    # a force that falls from 1 to 0 is a constant 1 less a rise from 0 to 1
    rise = flow[:2, 3]
    scale = np.abs(flow[:2, 2]).max()
    assert np.allclose([b1, b2], rise, rtol=0, atol=1e-11 * scale)
    assert np.allclose([a1, a2], flow[:2, 2] - rise, rtol=0, atol=1e-11 * scale)


def transients(system, times):
    """Return what static modes lack: their free motion from the start, summed, shape (times,)."""
    b = system.beams
    total = np.zeros(len(times))
    for i in range(system.modes.shape[2], b.frequency.shape[1]):
        w, d, steady = b.frequency[0, i], b.decay[0, i], system.modal[0, i]
        begun = -steady.real, steady.imag * b.forcing[0] / w
        total += [np.dot(mode_step(w, d, t)[:2], begun) for t in times]
    return total


@pytest.mark.parametrize(("steps", "largest"), [(50, 5e-4), (200, 1e-5), (800, 0.0)])
def test_without_contact_the_tip_follows_the_exact_solution_at_any_step(steps, largest):
    p = nominal(force_amplitude=0.5, initial_displacement=5e-5, initial_velocity=2e-3)
    x0 = p.initial_gap
    traces = []
    for propagator, count in ((exact, 50), (lanes, steps)):
        system = prepared(propagator, p, steps_per_period=count)
        state = propagator.start(system, p.initial_displacement / x0, p.initial_velocity / x0)
        gaps = np.full((1, 2), 1e3)
        record = propagator.advance(system, state, gaps, np.zeros((1, 2)), 20, trace=True)
        traces.append(record.trace[0, count // 50 - 1 :: count // 50])
    lacking = transients(system, np.arange(1, 1001) / (50 * p.forcing_frequency[0]))
    assert np.abs(traces[0]).max() > 0.1
    assert np.abs(lacking).max() <= largest
    assert np.abs(traces[1] + lacking - traces[0]).max() < 1e-9


@pytest.mark.parametrize("frequency", [32.3591, 57.1042])
def test_through_contacts_the_error_falls_with_the_square_of_the_step_or_faster(frequency):
    p = nominal(forcing_frequency=frequency)
    periods, coarse = 4, 200

    def trace(propagator, steps):
        system = prepared(propagator, p, steps_per_period=steps)
        state, gaps = at_rest(propagator, system)
        record = propagator.advance(system, state, gaps, np.zeros((1, 2)), periods, trace=True)
        assert record.work.sum() > 1
        return record.trace[0, steps // coarse - 1 :: steps // coarse]

    truth = trace(exact, coarse)
    errors = [np.abs(trace(lanes, steps) - truth).max() for steps in (200, 400, 800, 1600)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 2e-4 * np.abs(truth).max()
    assert orders.mean() > 1.9


def test_work_and_peak_of_a_period_are_those_of_the_exact_propagator():
    p = nominal()
    records = []
    for propagator in (lanes, exact):
        system = prepared(propagator, p, steps_per_period=1600)
        state, gaps = at_rest(propagator, system)
        records.append(propagator.advance(system, state, gaps, np.zeros((1, 2)), 4))
    fast, truth = records
    assert fast.work.sum() > 10
    # the fast one books work at the turning point, so the contact under way is still to come
    under_way = 0.5 * np.maximum(np.abs(fast.strobe[0, -1, 0]) - 1, 0) ** 2
    assert under_way > 1
    expected = truth.work.sum(axis=1) - [under_way if fast.strobe[0, -1, 0] > 0 else 0, 0]
    assert np.allclose(fast.work.sum(axis=1), expected, rtol=1e-5)
    assert np.allclose(fast.peak, truth.peak, rtol=1e-5)
    assert np.allclose(fast.strobe[:, -1], truth.strobe[:, -1], rtol=1e-4, atol=1e-3)


def test_gaps_grow_by_the_work_done_on_their_own_site():
    p = nominal()
    system = prepared(lanes, p)
    state, gaps = at_rest(lanes, system)
    growth = np.array([[1e-4, 3e-4]])
    record = lanes.advance(system, state, gaps, growth, 30)
    assert np.allclose(gaps, 1 + growth * record.work.sum(axis=1), rtol=1e-12)
    assert (gaps > 1.005).all()


def test_a_run_in_two_parts_is_the_run_in_one():
    p = nominal(3, force_amplitude=[5.0, 6.0, 7.0])
    system = prepared(lanes, p, steps_per_period=128)
    state, gaps = at_rest(lanes, system, 3)
    whole = lanes.advance(system, state, gaps, np.full((3, 2), 1e-4), 12)
    again, parts = at_rest(lanes, system, 3)
    pieces = [lanes.advance(system, again, parts, np.full((3, 2), 1e-4), k) for k in (5, 7)]
    assert np.array_equal(whole.work, np.concatenate([r.work for r in pieces], axis=1))
    assert np.array_equal(state, again)
    assert np.array_equal(gaps, parts)


def test_a_row_has_the_same_bits_alone_and_anywhere_among_others():
    rng = np.random.default_rng(1)
    n = 2 * LANES + 5
    p = nominal(n, force_amplitude=rng.uniform(4, 8, n), contact_stiffness=rng.uniform(1e4, 2e4, n))
    system = prepared(lanes, p, steps_per_period=128)

    def works(rows):
        state, gaps = at_rest(lanes, system, n)
        part = system.take(rows)
        record = lanes.advance(part, state[rows], gaps[rows], np.full((len(rows), 2), 1e-4), 20)
        return record.work

    order = rng.permutation(n)
    together = works(np.arange(n))
    assert np.array_equal(works(order), together[order])
    for row in (0, 7, n - 1):
        assert np.array_equal(works(np.array([row]))[0], together[row])


def test_steps_are_as_long_as_contact_allows_and_set_by_the_row_alone():
    p = nominal(3, contact_stiffness=[1e3, 13750.0, 2e5])
    s = Settings()
    chosen = {}
    for rows, system in lanes.groups(beams(p, s), s):
        chosen.update(dict.fromkeys(rows.tolist(), system.steps))
    assert chosen[0] < chosen[1] < chosen[2]
    for row, b in enumerate(beams(p, s).take(np.array([row])) for row in range(3)):
        at = LADDER.index(chosen[row])
        steps = np.array(LADDER[max(at - 1, 0) : at + 1])
        h = 1 / (p.forcing_frequency[row] * steps)
        modes = zip(b.frequency[0], b.decay[0], gains(b)[0], strict=True)
        yields = np.abs(sum(g * np.array([mode_step(w, d, x)[6] for x in h]) for w, d, g in modes))
        assert yields[-1] <= COMPLIANCE
        assert at == 0 or yields[0] > COMPLIANCE


def test_modes_too_fast_for_the_step_follow_statically_unless_their_damping_is_slow():
    def moving(steps, **values):
        return int(prepared(lanes, nominal(**values), steps_per_period=steps).begin[0, 2].sum())

    assert 4 < moving(64) < moving(256) < moving(1024) == 22
    assert moving(64, stiffness_damping=3e-4) == 22


@pytest.mark.parametrize(("frequency", "elements"), [(32.3591, 40), (57.1042, 10)])
def test_residual_flexibility_stands_in_for_the_modes_left_out(frequency, elements):
    """A few modes alone settle to other work-rates; with the others as springs, to the same."""
    work = {}
    p = nominal(forcing_frequency=frequency)
    for modes, residual in ((0, False), (8, False), (8, True)):
        system = prepared(
            lanes,
            p,
            elements=elements,
            modes=modes,
            residual_flexibility=residual,
            steps_per_period=384,
        )
        state, gaps = at_rest(lanes, system)
        work[modes, residual] = settle(lanes, system, state, gaps).work[0]
        assert system.modes.shape[2] == 8 or modes == 0
    np.testing.assert_allclose(work[8, True], work[0, False], rtol=2e-3)
    assert (abs(work[8, False] / work[0, False] - 1)).max() > 0.05


def test_residual_flexibility_is_that_of_the_tip():
    """A light tip, pressed slowly against its stop with the first mode alone in motion."""
    p = nominal(forcing_frequency=1.0, mass_per_length=0.02, mass_damping=60, force_amplitude=2.0)
    whole = beams(p, Settings())
    flexibility = whole.mobility[0] / whole.frequency[0] ** 2
    assert flexibility[0] < 0.99 * flexibility.sum()
    k = p.contact_stiffness[0]
    settings = {"modes": 1, "steps_per_period": 16384}
    for residual, given in ((True, flexibility.sum()), (False, flexibility[0])):
        system = prepared(lanes, p, residual_flexibility=residual, **settings)
        state, gaps = at_rest(lanes, system)
        lanes.advance(system, state, gaps, np.zeros((1, 2)), 2)
        peak = lanes.advance(system, state, gaps, np.zeros((1, 2)), 1).peak[0]
        free = p.force_amplitude[0] * given / p.initial_gap[0]
        np.testing.assert_allclose(peak, (free - 1) / (1 + k * given), rtol=1e-3)


def test_residual_flexibility_is_the_fast_propagators():
    with pytest.raises(ValueError, match="residual_flexibility needs propagator = 'fast'"):
        Settings(propagator="exact", residual_flexibility=True)


def test_motion_that_has_died_out_is_zero_and_not_next_to_it():
    """Numbers below 1e-308 cost a hundred times what others do."""
    p = nominal(2, force_amplitude=0.0, mass_damping=30.0)
    system = prepared(lanes, p)
    state, gaps = lanes.start(system, np.full(2, 0.5), np.zeros(2)), np.ones((2, 2))
    m = system.modes.shape[2]
    for _ in range(60):
        lanes.advance(system, state, gaps, np.zeros((2, 2)), 64)
        alive = np.abs(state[:, : 2 * m][state[:, : 2 * m] != 0])
        assert (alive > 1e-200).all()
    assert (state[:, : 2 * m] == 0).all()
