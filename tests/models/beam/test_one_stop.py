"""Lives where the rod meets one stop only: the other is never worn, or not until later."""

import numpy as np
import pytest
from laws import Law, lives

from models.beam import MODEL
from models.beam.parameters import Params, Settings
from models.beam.response.response import APERIODIC, SYMMETRIC
from models.beam.wear.random_lives import _step
from uq.contract import Status

REACH = 1.5  # amplitude without contact of the beams of `laws`


def one_stop(met):
    """Return work that falls to nothing as the gap of the one stop grows to the free amplitude."""

    def work(gaps):
        out = np.zeros_like(gaps)
        out[:, met] = np.maximum(REACH - gaps[:, met], 0.0)
        return out

    return work


def meets_later(first, touches):
    """Return work of 1 at one stop, and at the other once the gap of the first is wide enough."""

    def work(gaps):
        out = np.ones_like(gaps)
        out[:, 1 - first] = gaps[:, first] >= 1 + touches
        return out

    return work


def computed(parameters, **settings):
    """Return outputs and status of a row with some parameters changed."""
    x = np.array([list(Params(**(MODEL.nominal | parameters)))])
    return MODEL.batch(x, np.zeros(1, np.uint64), Settings(**settings))


@pytest.mark.parametrize("regime", [SYMMETRIC, APERIODIC])
@pytest.mark.parametrize("met", [0, 1])
def test_a_stop_that_is_never_met_never_wears_though_the_other_has_reached_the_last_depth(
    met, regime
):
    initial = np.where(np.arange(2) == met, 1.0, 2.0)
    law = Law(one_stop(met))
    worn = lives(law, [0.1, 0.2], regime=regime, accuracy=0.02, initial=initial)
    assert worn.ended[0] and worn.reached[0, met].all()
    assert worn.time[0, met] == pytest.approx(np.log(0.5 / (0.5 - np.array([0.1, 0.2]))), rel=0.01)
    assert np.isposinf(worn.time[0, 1 - met]).all()


@pytest.mark.parametrize("regime", [SYMMETRIC, APERIODIC])
@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("touches", [0.13, 0.37])
def test_a_stop_that_is_met_later_has_an_error_from_where_it_is_met(first, touches, regime):
    """It is met before or after the other stop has worn by the last depth, 0.2."""
    law = Law(meets_later(first, touches))
    worn = lives(law, [0.1, 0.2], regime=regime, accuracy=0.02)
    life, error = worn.time[0, 1 - first], worn.error[0, 1 - first]
    truth = touches + np.array([0.1, 0.2])
    assert worn.reached.all()
    assert (np.abs(life - truth) <= error + 1e-9 * truth).all()
    assert (error <= 0.1 * truth).all()


@pytest.mark.parametrize("side", [-1, 1])
def test_the_first_life_is_known_and_the_other_infinite(side):
    """Soft stops, one close to the heavily damped rod and one beyond its reach."""
    p = {
        "gap_asymmetry": 1.85 * side,
        "contact_stiffness": 1000.0,
        "mass_damping": 30.0,
        "forcing_frequency": 20.0,
        "force_amplitude": 0.3,
    }
    outputs, status = computed(p, depths=(5e-6, 1e-5))
    near, far = (1, 0) if side > 0 else (0, 1)
    assert outputs["work_rate"][0, far] == 0 < outputs["work_rate"][0, near]
    assert status[0] == Status.OK
    assert np.isfinite(outputs["time_to_depth"][0, near]).all()
    assert np.isposinf(outputs["time_to_depth"][0, far]).all()
    assert not outputs["time_to_depth_censored"].any()


@pytest.mark.parametrize("side", [-1, 1])
def test_a_worn_stop_is_followed_over_many_times_the_last_depth(side):
    """An orbit of five periods at one stop; contact ends after 1e5 times the depth."""
    p = {
        "gap_asymmetry": 1.236913 * side,
        "contact_stiffness": 27987.9,
        "mass_damping": 14.9712,
        "stiffness_damping": 3.7e-5,
        "forcing_frequency": 44.477256,
        "force_amplitude": 0.290711,
    }
    outputs, status = computed(p, depths=(1e-9,), accuracy=1.0)
    assert status[0] == Status.OK
    assert np.isfinite(outputs["time_to_depth"]).sum() == 1
    assert np.isposinf(outputs["time_to_depth"]).sum() == 1


def test_under_a_random_load_the_worn_stop_widens_until_the_other_is_met_or_contact_ends():
    grown = np.array([[1.0, 0.0], [1.0, 1.0], [0.5, 0.0]])
    rate = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 0.0]])
    step = _step(grown, rate, np.array([[0.5, 1.0]] * 3))
    assert step[0, 0] > 1.0 and step[0, 1] == 0.0
    assert np.isnan(step[1:]).all()  # both have worn by the last depth; none wears
