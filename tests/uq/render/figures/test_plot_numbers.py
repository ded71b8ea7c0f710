"""What is drawn is what its axis says: in the unit of the axis, all of it, and in its colour."""

import io

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from answered import lifetime
from asked_indices import sensitivities
from computed import asking, kinds, linear, summarised, with_output
from drawn import words

from uq import plots
from uq.render.figures.figure import COLOURS, thinned
from uq.render.figures.words import as_label

DAY = 86400.0


def lives(ds):
    """Return a result with lives of 5 to 15 days."""
    values = np.linspace(5, 15, ds.sizes["row"]) * DAY
    return asking(with_output(ds, "day_long", values, "lifetime"), outputs=["day_long"])


def median(ds):
    """Return the median of the lives, and the ends of its interval [days]."""
    quantile = summarised(ds)["outputs"]["day_long"]["quantiles"]["0.5"]
    return [quantile[end] / DAY for end in ("value", "low", "high")]


def test_estimates_converge_in_the_unit_of_their_axis():
    never = lives(linear(samples=64))
    never["day_long"][:5] = np.inf  # of which there is a median alone
    (axes,) = plots.convergence(never, "day_long").axes
    value, low, high = median(never)
    assert "[days]" in axes.get_title("left")
    assert axes.lines[0].get_ydata()[-1] == pytest.approx(value)
    band = axes.collections[0].get_paths()[0].vertices
    last = band[band[:, 0] == 64, 1]
    assert (last.min(), last.max()) == pytest.approx((low, high))


def test_values_that_differ_by_rounding_alone_are_drawn_as_one():
    ds = linear(samples=64)
    values = 1.0 + 1e-16 * ds["y"].values
    (axes,) = plots.histogram(with_output(ds, "same", values), "same").axes
    assert axes.patches[0].get_data().values.sum() > 0


def test_an_interval_is_spoken_of_where_there_is_one():
    for ds, there in ((linear(samples=64), True), (linear("sobol", samples=64), False)):
        assert ("95 % interval" in words(plots.convergence(ds, "y"))) is there


def test_a_band_that_ends_before_its_line_is_said_to():
    ds = linear(samples=512)
    heavy = with_output(ds, "heavy", np.random.default_rng(1).pareto(1.5, 512))
    sentence = " where the rows allow one"
    assert sentence in words(plots.convergence(heavy, "heavy"))
    assert sentence not in words(plots.convergence(ds, "y"))


def test_elements_that_are_not_drawn_are_counted():
    ds = kinds(samples=16)
    many = xr.concat([ds["life"].isel(depth=0, drop=True)] * 3, "third").transpose("row", ...)
    ds = ds.drop_vars(["life", "life_censored"]).assign(life=many.assign_attrs(ds["life"].attrs))
    assert "the first and the last of 6 elements" in words(plots.histogram_by_regime(ds, "life"))
    assert "the first" not in words(plots.histogram_by_regime(kinds(samples=16), "life"))


def test_what_an_input_without_effect_has_is_a_line_across_the_bars():
    ds = linear(samples=100)
    (axes,) = plots.index_bars(ds, "y", method="rbd-fast").axes
    idle = sensitivities(ds, "rbd-fast")["outputs"]["y"]["dummy"]["S1"]
    assert [line.get_xdata()[0] for line in axes.lines if line.get_linestyle() == "--"] == [idle]


def test_a_table_has_one_unit():
    ds = lives(linear(samples=64))
    table = plots.quantile_table(ds, "day_long")
    value, low, high = median(ds)
    assert "[days]" in table.columns[1]
    assert table.iloc[1].tolist() == ["50 %", f"{value:.1f}", f"{low:.1f} to {high:.1f}"]


def test_points_and_bars_stand_in_the_unit_of_their_axis():
    ds = lives(kinds(samples=64))
    points = plots.scatter(ds, "day_long").axes[0].lines[0].get_ydata()
    assert (points.min(), points.max()) == pytest.approx((5, 15))
    (axes,) = plots.histogram_by_regime(ds, "day_long").axes
    edges = axes.patches[0].get_data().edges
    assert (edges[0], edges[-1]) == pytest.approx((5, 15))


def test_marks_and_band_of_a_life_lie_at_its_curve():
    ds = lives(linear(samples=200))
    (axes,) = plots.lifetime(ds, "day_long").axes
    (marks,) = [line for line in axes.lines if line.get_marker() == "o"]
    assert marks.get_xdata()[marks.get_ydata() == 0.5] == pytest.approx(median(ds)[0])
    curve = axes.lines[0]
    at = np.searchsorted(curve.get_xdata(), 7)  # a fifth have ended by then
    band = axes.collections[0].get_paths()[0].vertices
    low, *_, high = np.sort(band[np.isclose(band[:, 0], curve.get_xdata()[at]), 1])
    assert 0.1 < low < curve.get_ydata()[at] < high < 0.3


def test_rows_without_a_value_are_counted_where_they_are_missing():
    ds = linear(samples=64, settings={"fail_above": 0.9})
    lost = int(ds["y"].isnull().sum())
    assert f"64 runs, {lost} invalid" in words(plots.histogram(ds, "y"))
    ds = kinds(samples=100)
    censored = int(ds["life_censored"][:, 0, 0].sum())
    assert f"{censored} censored" in words(plots.scatter(ds, "life[side=left,depth=0.5]"))
    assert f"up to {censored} censored" in words(plots.lifetime(ds, "life"))


def test_censored_rows_are_points_of_their_own_and_not_in_a_histogram_of_ends():
    ds = kinds(samples=200)
    name = "life[side=left,depth=0.5]"
    censored = ds["life_censored"].values[:, 0, 0].astype(bool)
    finite = np.isfinite(ds["life"].values[:, 0, 0])
    markers = {
        line.get_marker(): len(line.get_xdata()) for line in plots.scatter(ds, name).axes[0].lines
    }
    assert markers["."] == (finite & ~censored).sum() and markers["^"] == censored.sum() > 0
    slow, fast = plots.histogram_by_regime(ds, name).axes[0].patches
    edges = slow.get_data().edges
    share = np.sum((slow.get_data().values - slow.get_data().baseline) * np.diff(edges))
    ended = finite & ~censored
    assert share == pytest.approx((ds["regime"].values[ended] == 0).mean())


def test_a_regime_has_its_colour_whichever_others_occur():
    ds = kinds(samples=100)
    both = [line.get_color() for line in plots.pairs(ds).axes[0].lines]
    assert both == list(COLOURS[:2])
    fast = ds.isel(row=ds["regime"].values == 1)
    (bars,) = plots.histogram_by_regime(fast, "angle").axes[0].patches
    assert bars.get_facecolor()[:3] == pytest.approx(
        [int(COLOURS[1][i : i + 2], 16) / 255 for i in (1, 3, 5)]
    )


def test_a_dollar_sign_is_no_formula():
    ds = linear(samples=32)
    ds["y"].attrs["long_name"] = "price in $, cost in $"
    figure = plots.histogram(ds, "y")
    svg = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none"}):
        figure.savefig(svg, format="svg")
    assert ">Price in $, cost in $<" in svg.getvalue()


def test_of_many_points_the_ends_are_drawn():
    places = thinned(5000, 100)
    assert (places[0], places[-1], len(places)) == (0, 4999, 100)
    assert thinned(3).tolist() == [0, 1, 2]


def test_the_probability_of_an_event_is_over_the_input_by_the_name_in_the_answer():
    ds, conclusions = lifetime()
    (event,) = conclusions.lead.events
    figure = plots.event_probability(ds, event.name)
    (panel,) = figure.axes
    title = f"Time until the depth is reached\nRuns that {event.predicate}"
    assert panel.get_title("left") == title
    assert event.decided_by.startswith("Main driver: rate")
    assert panel.get_xlabel().startswith("Rate ") and "pm" in panel.get_xlabel()
    drawn = panel.patches[-1].get_data().values
    assert np.allclose(drawn, [share.value for share in event.curve.shares])
    (legend,) = figure.legends  # which says what line and band are
    assert [text.get_text() for text in legend.get_texts()] == [
        "slices of the input",
        "95 % intervals",
        f"all runs: {100 * event.share.value:.1f} %",
    ]


def test_labels_are_lines_of_about_one_length_and_break_no_word_that_fits():
    assert as_label("whether the period of the response is 1", width=38).splitlines() == [
        "Whether the period",
        "of the response is 1",
    ]
    assert as_label("the larger of the two sites' work-rates", width=36).splitlines() == [
        "The larger of the two",
        "sites' work-rates",
    ]
    assert as_label("stiffness-proportional", width=12).splitlines() == [
        "Stiffness-",
        "proportional",
    ]
