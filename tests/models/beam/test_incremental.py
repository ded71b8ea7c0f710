"""The reference for lifetimes: against a known law of wear, and against published lives."""

import types

import numpy as np
import pytest
from incremental import incremental_lives

from models.beam.parameters import Params, Settings
from models.beam.structure.modal import beams
from models.beam.structure.propagation import Record

W0 = beams(Params(*(np.array([value]) for value in Params())), Settings()).frequency[0, 0]


def wears_by(rates):
    """Return a propagator whose settled work-rates [k_c X0^2 w0] are a function of the gaps."""

    def advance(system, state, gaps, growth, periods):
        record = Record.empty(1, periods)
        record.work[:] = rates(gaps[0]) * system
        return record

    return types.SimpleNamespace(
        groups=lambda modal, settings: [
            ([0], 2 * np.pi * modal.frequency[0, 0] / modal.forcing[0])
        ],
        start=lambda system, displacement, velocity: None,
        advance=advance,
    )


def test_lives_of_a_known_law():
    """Rates 4 x_1 and 3 x_2^2 make lives ln(1 + g)/4 and g/(1 + g)/3 of the growth g."""
    growths = np.array([0.5, 1.0])
    law = wears_by(lambda gaps: np.array([4 * gaps[0], 3 * gaps[1] ** 2]))
    lives = incremental_lives(Params(), Settings(), growths, 64, propagator=law)
    right, left = np.log1p(growths) / 4, growths / (1 + growths) / 3
    expected = np.stack([right, left, np.minimum(right, left)])
    np.testing.assert_allclose(lives.time, expected, rtol=2e-4)
    assert (np.abs(lives.time - expected) < lives.error).all()


def test_the_sites_share_the_wear_coefficient_only_if_asked():
    law = wears_by(lambda gaps: 0 * gaps + 2.0)
    p = Params(wear_coefficient_ratio=0.25)
    lives = incremental_lives(p, Settings(), [1.0], 8, most=5.0, propagator=law)
    np.testing.assert_allclose(lives.time[:, 0], [0.5, 2.0, 0.5])


def test_wear_that_stops_gives_an_infinite_life():
    law = wears_by(lambda gaps: np.where(gaps < 1.5, 2.0, 0.0))
    lives = incremental_lives(Params(), Settings(), [0.25, 1.0], 8, propagator=law)
    np.testing.assert_allclose(lives.time[:, 0], 0.125)
    assert np.isinf(lives.time[:, 1]).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("omega", "first", "tolerance"),
    [(9.9, 0.007806, 2e-6), (5.61, 0.380, 2e-3)],
)
def test_lives_to_twice_the_gap(omega, first, tolerance):
    """T to a gap growth of one; at 5.61 it depends on the steps through a branch change."""
    p = Params(forcing_frequency=omega * W0 / (2 * np.pi))
    lives = incremental_lives(p, Settings(), [1.0], increments=80)
    assert abs(lives.time[2, 0] - first) < tolerance
    assert lives.error[2, 0] < tolerance
