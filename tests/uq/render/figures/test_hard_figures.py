"""Figures of data that few studies have: wide, many, none, or one row."""

from dataclasses import replace

import numpy as np
import pytest
from computed import asking, computed, kinds, linear, study_of, with_output
from drawn import collisions, words

from uq import plots
from uq.assess.sensitivities import sensitivities
from uq.indices.index import Null
from uq.render.figures.figure import lay_out
from uq.render.figures.words import as_label
from uq.result.result import Result


def profile(places, samples=40):
    """Return a result with one output along a dimension."""
    ds = with_output(linear(samples=samples), "profile", np.zeros(samples))
    values = np.outer(ds["y"].values, 1 + np.arange(places))
    attrs = ds["profile"].attrs
    ds = ds.drop_vars("profile").assign_coords(profile_index=np.arange(float(places)))
    ds["profile"] = ("row", "profile_index"), values
    ds["profile"].attrs |= attrs
    return asking(ds, outputs=["profile"])


def test_of_many_elements_a_figure_shows_some_and_says_so():
    ds = profile(50)
    for draw in (plots.histogram, plots.convergence):
        figure = draw(ds, "profile")
        lay_out(figure)
        assert "12 of 50 elements" in words(figure), draw
        shown = [place for place in range(50) if f"profile index {place} " in f"{words(figure)} "]
        assert len(shown) == 12 and {0, 49} <= set(shown), draw
        assert not collisions(figure), draw
    assert "elements" not in words(plots.histogram(profile(12), "profile"))


def test_a_quantile_beyond_the_horizon_is_stated():
    values, going = np.linspace(1.0, 4.0, 100), np.arange(100) >= 45
    ds = with_output(linear(samples=100), "life", values, "lifetime", censored=going)
    assert "beyond the horizon" in plots.quantile_table(ds, "life").to_string()


def test_inputs_over_decades_have_a_logarithmic_axis():
    ds = linear(samples=400)
    assert plots.scatter(ds, "y").axes[0].get_xscale() == "linear"
    ds["x1"] = ds["x1"].copy(data=1e-3 * 1e6 ** ds["x1"].values)
    first = plots.scatter(with_output(ds, "of_it", np.log(ds["x1"].values)), "of_it").axes[0]
    assert first.get_xscale() == "log"
    (line,) = (drawn_line for drawn_line in first.lines if drawn_line.get_linestyle() == "-")
    assert np.isfinite(line.get_ydata()).all()  # no part of the axis is empty


def test_powers_of_ten_on_an_axis_are_short_and_apart():
    ds = with_output(linear(samples=200), "wide", np.geomspace(1e-6, 1e6, 200))
    figure = plots.histogram(ds, "wide")
    lay_out(figure)
    assert {"1e−6", "1e6"} <= set(words(figure).split())
    assert not collisions(figure)


def test_an_axis_along_which_nothing_is_known_has_no_numbers():
    never = with_output(linear(samples=80), "life", np.full(80, np.inf), "lifetime")
    assert not len(plots.lifetime(never, "life").axes[0].get_xticks())
    assert not len(plots.scatter(never, "life").axes[0].get_yticks())


def test_the_interval_of_one_number_of_samples_is_seen():
    figure = plots.convergence(linear(samples=2), "y")
    (band,) = figure.axes[0].collections
    assert band.get_linewidth()[0] > 0
    (band,) = plots.convergence(linear(samples=100), "y").axes[0].collections
    assert band.get_linewidth()[0] == 0


def test_limits_that_coincide_are_one_line_of_the_legend():
    ds = linear(samples=100, analysis={"sensitivity": ["rbd-fast"]})
    result = sensitivities(Result(ds), "rbd-fast", "y").targets["y"]
    (kind,) = result.indices.nulls
    same = replace(result.indices, nulls={kind: Null(0.1, 0.1)})
    (legend,) = plots.index_bars(ds, "y", indices=replace(result, indices=same)).legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert labels == ["95 % limit for an input without effect, or several", "alone (S1)"]


def test_shares_without_intervals_promise_none():
    assert "95 %" not in words(plots.shares(kinds("sobol", samples=64), "regime"))
    assert "95 %" in words(plots.shares(kinds(samples=64), "regime"))


@pytest.mark.parametrize(
    ("text", "symbol", "label"),
    [
        ("x1", "x1", "$x_{1}$"),
        ("omega", "omega", r"$\omega$"),
        ("load", "load", "Load"),
        ("stiffness", "k", "Stiffness ($k$)"),
    ],
)
def test_what_is_its_own_symbol_is_written_once(text, symbol, label):
    assert as_label(text, symbol=symbol) == label


def test_lines_break_within_no_difference_and_before_no_number():
    inductance = as_label("added by the bar: area under L - L_0", "H m", width=30, symbol="A")
    assert inductance.splitlines()[-1].startswith("under L − $L_{0}$")
    lines = as_label("rank of the speed of vibrator 1 at the instant, 0.35 s", width=30)
    assert any("vibrator 1" in line for line in lines.splitlines())


def test_inputs_of_samples_of_several_rows_say_which_rows_are_drawn():
    inside = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
    tables = {
        "study": {"name": "repeated", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 30, "repeats": 2},
        "uncertain": {"x1": inside, "x2": inside | {"level": "chance"}},
    }
    figure = plots.inputs(computed(study_of(tables)))
    assert "Density of 30 runs, one of each sample" in words(figure)
    lay_out(figure)
    assert not collisions(figure)
    assert "sample" not in words(plots.inputs(linear()))


def test_the_title_of_weighted_inputs_has_room():
    ds = linear(samples=1000)
    ds = ds.assign(weight=("row", np.linspace(0.5, 1.5, 1000), {"role": "weight"}))
    figure = plots.inputs(ds, names=["x1", "x2"])
    assert "1 000 weighted runs" in words(figure)
    lay_out(figure)
    assert not collisions(figure)
