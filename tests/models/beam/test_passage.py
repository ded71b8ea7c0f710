"""The variational flow: against differences of the propagator, and against Liouville's formula."""

import numpy as np
import pytest
from exact_beams import at_omega, deflected, set_up

from models.beam import exact
from models.beam.exact.passage import passage
from models.beam.exact.tuning import Beam, Tuning
from models.beam.parameters import Params

NOMINAL = Params()
CASES = {
    "9.9": (NOMINAL, 10, 1),
    "5.61": (NOMINAL._replace(forcing_frequency=32.3591), 10, 3),
    "unequal gaps": (NOMINAL._replace(gap_asymmetry=0.8), 3, 2),
    "starts in contact": (
        NOMINAL._replace(initial_displacement=7e-4, initial_velocity=0.1, gap_asymmetry=-1.2),
        2,
        2,
    ),
    "overdamped": (NOMINAL._replace(stiffness_damping=3.6e-4, forcing_frequency=32.0), 3, 2),
    "stiff stops": (NOMINAL._replace(contact_stiffness=4e5), 3, 2),
}


def after(beam, setup, state, gaps, periods):
    """Return the state after some periods, by the propagator without tangents."""
    system = setup.system._replace(phases=((beam.free, beam.contact),))
    row = np.zeros_like(setup.state)
    row[0, : len(state)] = state
    exact.advance(system, row, gaps[None].copy(), np.zeros((1, 2)), periods)
    return row[0, : len(state)]


def differences(function, size, h=1e-6):
    """Return the central differences of a function of `size` increments."""
    return np.stack([(function(e) - function(-e)) / (2 * h) for e in h * np.eye(size)], axis=1)


@pytest.mark.parametrize("case", CASES)
def test_tangents_are_the_derivatives_of_the_propagator(case):
    p, elements, periods = CASES[case]
    setup = set_up(deflected(p), elements=elements)
    setup.advance(3)
    tuning = Tuning(setup.modal)
    beam = tuning.at(tuning.forcing)
    n = tuning.size
    state, gaps = setup.state[0, :n], setup.gaps[0]
    flow = passage(beam, state, gaps, periods=periods)
    assert flow.contacts.sum() > 0

    np.testing.assert_array_equal(flow.state, after(beam, setup, state, gaps, periods))
    by_state = differences(lambda e: after(beam, setup, state + e, gaps, periods), n)
    by_gaps = differences(lambda e: after(beam, setup, state, gaps + e, periods), 2)
    by_forcing = differences(
        lambda e: after(tuning.at(tuning.forcing * np.exp(e[0])), setup, state, gaps, periods), 1
    )
    for tangents, expected in (
        (flow.tangents[:, :n], by_state),
        (flow.tangents[:, n : n + 2], by_gaps),
        (flow.tangents[:, n + 2 :], by_forcing),
    ):
        size = np.abs(expected).max()
        assert size > 0.01
        np.testing.assert_allclose(tangents, expected, rtol=0, atol=2e-7 * max(size, 1))


@pytest.mark.parametrize(("omega", "elements", "modes"), [(9.9, 10, 3), (5.61, 2, 4)])
def test_volume_shrinks_as_damping_says(omega, elements, modes):
    """Liouville: ln det of the monodromy is minus the integral of the damping, contact or not.

    With few modes: the determinant of many is beyond rounding.
    """
    setup = set_up(at_omega(omega), elements=elements, modes=modes)
    setup.advance(5)
    periods = 2
    size = 2 * modes
    matrix = exact.monodromy(setup.system, setup.state, setup.gaps, periods)[0, :size, :size]
    sign, log = np.linalg.slogdet(matrix)
    rate = 2 * setup.modal.decay.sum() / setup.modal.forcing[0]
    assert setup.advance(periods).work.all()
    assert sign == 1
    assert log == pytest.approx(-2 * np.pi * periods * rate, rel=1e-7)


def test_monodromy_of_many_beams_leaves_their_states_and_bookkeeping_alone():
    setup = set_up(NOMINAL, at_omega(5.61))
    setup.advance(4)
    state, gaps = setup.state.copy(), setup.gaps.copy()
    matrix = exact.monodromy(setup.system, setup.state, setup.gaps, 2)
    np.testing.assert_array_equal(setup.state, state)
    np.testing.assert_array_equal(setup.gaps, gaps)
    n = 2 * setup.system.modal.shape[1]
    assert matrix.shape == (2, state.shape[1], state.shape[1])
    assert not matrix[:, n:].any() and not matrix[:, :, n:].any()
    one_period = exact.monodromy(setup.system, setup.state, setup.gaps, 1)
    setup.advance(1)
    next_one = exact.monodromy(setup.system, setup.state, setup.gaps, 1)
    np.testing.assert_allclose(
        next_one @ one_period, matrix, rtol=0, atol=1e-11 * np.abs(matrix).max()
    )


def test_a_tuned_beam_is_that_of_its_frequency():
    setup, other = set_up(NOMINAL), set_up(NOMINAL._replace(forcing_frequency=31.0))
    tuned = Tuning(setup.modal).at(other.modal.forcing[0])
    state = np.random.default_rng(3).normal(size=44) / 10
    direct = passage(Beam.of(other.system.phases[0]), state, setup.gaps[0])
    flow = passage(tuned, state, setup.gaps[0])
    np.testing.assert_allclose(flow.state, direct.state, rtol=0, atol=1e-11)
    np.testing.assert_allclose(flow.tangents[:, :46], direct.tangents[:, :46], rtol=0, atol=1e-10)


def test_what_is_met_on_the_way_is_what_the_record_says():
    setup = set_up(at_omega(5.61))
    setup.advance(300)
    beam = Beam.of(setup.system.phases[0])
    flow = passage(beam, setup.state[0, :44], setup.gaps[0], periods=3)
    record = setup.advance(3)
    np.testing.assert_allclose(flow.work, record.work[0].sum(axis=0), rtol=1e-13)
    np.testing.assert_allclose(flow.peak, record.peak[0], rtol=1e-13)
    assert flow.contacts.tolist() == [3, 3]
    assert (flow.impacts > 0).all()


@pytest.mark.parametrize(("side", "depth"), [(0, 1e-3), (0, 1e-6), (1, 1e-6), (1, -1e-3)])
def test_clearance_is_the_distance_of_the_tips_turn_from_a_stop(side, depth):
    """The steady free motion turns once at either side; one stop is brought near."""
    setup = set_up(NOMINAL, gap=1e6)
    amplitude = abs(setup.system.modal.sum())
    gaps = np.full(2, 10 * amplitude)
    gaps[side] = amplitude * (1 - depth)
    steady = setup.system.modal[0]
    state = np.concatenate([steady.real, -steady.imag])
    flow = passage(Beam.of(setup.system.phases[0]), state, gaps)
    tolerance = 10 * np.sqrt(max(depth, 0)) + 1e-9
    assert flow.clearance / amplitude == pytest.approx(abs(depth), rel=tolerance)
    assert flow.contacts[side] == (depth > 0)
    assert flow.contacts[1 - side] == 0
