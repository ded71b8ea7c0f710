"""The picture of a simulated motion: the whole beside its last periods, stops, angles."""

from dataclasses import replace

import numpy as np
import pytest
import sample_models
from drawn import words

import uq
from uq import plots
from uq.contract import Trajectory
from uq.render.figures.figure import lay_out


def simulated(quantities=None, **more):
    time = np.linspace(0.0, 20.0, 4001)
    place = 1e-3 * (1 + np.exp(-time)) * np.sin(2 * np.pi * time)
    given = quantities or {f"q{i}": ("m", f"place {i}", place) for i in range(8)}
    if quantities is None:
        given["angle"] = ("rad", "angle, turns included", 2 * np.pi * 3 + 100 * place)

    def simulate(params, settings, seed=0):
        return Trajectory(time, given, **more)

    return uq.simulate(replace(sample_models.KINDS, simulate=simulate))


def test_the_last_periods_stand_beside_the_whole():
    figure = plots.motion(simulated(period=1.0))
    assert len(figure.axes) == 12  # six quantities, twice
    whole, last = figure.axes[:2]
    assert whole.lines[0].get_xdata()[0] == 0 and whole.lines[0].get_xdata()[-1] == 20
    assert last.lines[0].get_xdata()[0] == 16
    assert np.abs(last.lines[0].get_ydata()).max() < 1.01 < np.abs(whole.lines[0].get_ydata()).max()
    assert "Place 0 [mm]" in words(figure)
    assert len(plots.motion(simulated()).axes) == 6  # without a drive there is nothing to settle to


def test_stops_and_angles_are_drawn_where_they_are():
    shown = ("q3", "angle")
    figure = plots.motion(
        simulated(period=1.0, shown=shown, stops={"q3": (np.nan, 5e-4)}, angles=("angle",))
    )
    place, _, angle, _ = figure.axes
    assert [line.get_ydata()[0] for line in place.lines[1:]] == [0.5]
    assert "Place 3 [mm], dashed: stop" in words(figure)
    assert np.abs(angle.lines[0].get_ydata()).max() < 12 and "turns" not in words(figure)


def test_a_change_by_rounding_is_drawn_as_none_and_no_number_hides_in_an_offset():
    time = np.linspace(0, 20, 4001)
    still = {"still": ("m", "progression", 0.863042 + 1e-10 * (time > 19))}
    figure = plots.motion(simulated(still, period=1.0))
    lay_out(figure)
    _, last = figure.axes
    low, high = last.get_ylim()
    assert high - low == pytest.approx(1e-5 * 0.863042, rel=1e-3)
    assert not last.yaxis.get_offset_text().get_text()


def test_a_long_label_does_not_narrow_its_column():
    meaning = "displacement u of the bar relative to the mole"
    long = {"long": ("m", meaning, np.linspace(-20e-3, 1e-3, 4001))}
    figure = plots.motion(simulated(long, period=1.0, stops={"long": (np.nan, -2e-3)}))
    lay_out(figure)
    left, right = (axes.bbox for axes in figure.axes)
    assert right.x0 - left.x1 < 0.06 * figure.bbox.width
