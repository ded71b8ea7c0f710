"""Errors of averages and extremes where the motion does not repeat."""

import numpy as np
import pytest

from models.mole.batch import batch
from models.mole.parameters import CHAOTIC, OUTPUTS, PERIODIC, Params, Settings

MEANS = (
    "progression_rate",
    "impact_work_rate",
    "impact_impulse",
    "impact_energy",
    "electrical_power",
    "efficiency",
)
EXTREMES = "peak_contact_force", "displacement_range"


def compute(starts, **settings):
    """Return outputs at 9 Hz, where the nominal mole is chaotic, from bars 0.1 mm apart."""
    x = np.array(
        [
            Params(control_frequency=9.0, initial_displacement=-0.022 - 1e-4 * i)
            for i in range(starts)
        ]
    )
    outputs, status = batch(x, np.zeros(starts, np.uint64), Settings(**settings))
    assert not status.any() and np.all(outputs["regime"] == CHAOTIC)
    return outputs


@pytest.fixture(scope="module")
def short():
    """Twenty times the nine control periods after which the mains repeats."""
    return compute(32, transient=50, duration=180)


def test_every_number_of_a_mole_has_an_error():
    numbers = {name for name, output in OUTPUTS.items() if not output.is_category}
    values = {name for name in numbers if not name.endswith("_error")}
    assert numbers == values | {f"{name}_error" for name in values}


@pytest.mark.parametrize("name", MEANS)
def test_stated_errors_are_those_that_averages_have(short, name):
    values, errors = short[name], short[f"{name}_error"]
    stated = np.sqrt(np.mean(errors**2))
    assert 0.6 * stated < values.std(ddof=1) < 1.5 * stated
    assert np.mean(np.abs(values - values.mean()) < 1.645 * errors) > 0.8


@pytest.mark.parametrize("name", EXTREMES)
def test_extremes_grow_with_time_and_by_no_more_than_stated(short, name):
    """The largest of 32 averaging times is that of a time 32 times as long."""
    values, growth = short[name], short[f"{name}_error"]
    assert 0 < growth.max() < 0.2 * values.min()
    assert np.mean(values.max() - values <= growth) > 0.85


def test_what_repeats_has_no_error():
    x = np.array([Params(control_frequency=frequency) for frequency in (7.0, 13.0)])
    outputs, _ = batch(x, np.zeros(2, np.uint64), Settings())
    assert outputs["period"].tolist() == [1, 1] and outputs["regime"][0] == PERIODIC
    for name in (*MEANS, *EXTREMES, "impacts_per_period"):
        values, errors = outputs[name], outputs[f"{name}_error"]
        assert errors.tolist() == [0.0, 0.0] or np.isnan([values[1], errors[1]]).all(), name
        assert errors[0] == 0
