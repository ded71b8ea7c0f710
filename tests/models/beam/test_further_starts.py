"""Coexisting responses, which one start does not show."""

import numpy as np
import pytest

from models.beam import MODEL
from models.beam.parameters import REGIMES, Params, Settings

COEXISTING = {
    "forcing_frequency": 33.3637,
    "contact_stiffness": 21543.2,
    "initial_gap": 1.66261e-4,
    "force_amplitude": 5.7014,
}
"""A symmetric orbit from rest, and longer ones of nearly three times its work-rate."""
RESTING = {
    "forcing_frequency": 26.2346,
    "contact_stiffness": 10039.4,
    "initial_gap": 3.31171e-4,
    "force_amplitude": 5.98055,
}
"""Rattles from rest, and may be at rest between the stops."""


def compute(values, **settings):
    x = np.array([list(Params(**(MODEL.nominal | values)))])
    ran = Settings(depths=(1e-6,), accuracy=1.0, **settings)
    outputs, _ = MODEL.batch(x, np.zeros(1, np.uint64), ran)
    return {name: value[0] for name, value in outputs.items()}


def test_further_starts_find_an_orbit_that_coexists_and_the_error_reaches_it():
    alone, searched = compute(COEXISTING), compute(COEXISTING, starts=8)
    other = compute(COEXISTING | {"initial_displacement": 5e-4, "initial_velocity": -0.1})
    assert REGIMES[alone["regime"]] == "period-1-symmetric"
    assert REGIMES[other["regime"]] == "period-k"
    assert (alone["work_rate_error"] < 0.01 * alone["work_rate"]).all()
    apart = np.abs(other["work_rate"] - alone["work_rate"]).max()
    assert searched["work_rate_error"] == pytest.approx([apart, apart], rel=0.01)


def test_further_starts_change_nothing_but_the_error():
    alone, searched = compute(COEXISTING), compute(COEXISTING, starts=2)
    del alone["work_rate_error"], searched["work_rate_error"]
    assert all(np.array_equal(alone[k], searched[k], equal_nan=True) for k in alone)


def test_a_mirror_image_is_another_response():
    outputs = compute({}, starts=8)
    apart = abs(np.diff(outputs["work_rate"])[0])
    assert outputs["work_rate_error"] == pytest.approx([apart, apart], rel=0.01)


def test_rest_between_the_stops_is_another_response():
    outputs = compute(RESTING, starts=1)
    assert outputs["work_rate"].min() > 0
    assert (outputs["work_rate_error"] >= outputs["work_rate"]).all()
