"""Figures: what each shows of a result."""

import re

import numpy as np
import pytest
from answered import lifetime
from computed import asking, computed, kinds, linear, study_of, summarised, with_output
from drawn import words
from matplotlib.figure import Figure
from wordings import sentence

from uq import plots
from uq.errors import InputError
from uq.render.figures.scatter_plot import _fragments, _is_empty, _is_torn
from uq.stats.order_statistics import quantile_interval


def test_lifetime_figure_shows_share_band_and_what_never_ends():
    days = 86400.0
    values = np.r_[np.linspace(5, 15, 60) * days, np.full(20, np.inf)]
    ds = with_output(linear(samples=80), "life", values, "lifetime")
    figure = plots.lifetime(ds, "life")
    (axes,) = figure.axes
    assert axes.get_xlabel() == "Meaning of life [days]"
    assert "estimate, never: 25.0 %" in words(figure) and "80 runs" in words(figure)
    (line,) = axes.lines[:1]
    assert line.get_xdata()[0] == pytest.approx(5) and line.get_ydata()[-1] == pytest.approx(0.75)
    band = axes.collections[0].get_paths()[0].get_extents()
    assert band.y0 < 0.02 and 0.75 < band.y1 < 0.9
    assert axes.get_xscale() == "linear" and "95 % band" in words(figure)
    wide = with_output(linear(samples=80), "life", np.geomspace(1, 1e6, 80), "lifetime")
    assert plots.lifetime(wide, "life").axes[0].get_xscale() == "log"
    alone = linear("sobol", samples=64)  # no replicates, no band
    alone = with_output(alone, "life", alone["y"].values, "lifetime")
    assert "band" not in words(plots.lifetime(alone, "life"))


def test_elements_of_an_output_share_a_figure_and_differ():
    figure = plots.lifetime(kinds(samples=100), "life")
    lines = [line for line in figure.axes[0].lines if line.get_linestyle() != "None"]
    assert len({(line.get_color(), line.get_linestyle()) for line in lines}) == 4
    assert "left, depth 0.5, never" in words(figure)
    assert "censored" in words(figure)
    lifetime_figure = plots.lifetime(kinds(samples=100), "life[side=left,depth=0.5]")
    assert [line.get_linestyle() for line in lifetime_figure.axes[0].lines].count("-") == 1


def test_histogram_shows_every_row_once():
    figure = plots.histogram(linear(samples=300), "y")
    (patch,) = figure.axes[0].patches
    counts, edges, _ = patch.get_data()
    assert sum(counts * np.diff(edges)) == pytest.approx(1) and edges[0] < 2 < 8 < edges[-1]
    assert figure.axes[0].get_ylabel() == "Density"
    assert figure.axes[0].get_xlabel() == "Value of the function"
    both = plots.histogram(kinds(samples=100), "work")
    assert both.axes[0].get_xlabel() == "Work rate [W]" and "right" in words(both)
    assert "undefined" in words(plots.histogram(kinds(samples=100), "angle"))
    slow = with_output(linear(samples=64), "slow", np.linspace(2, 9, 64) * 86400.0)
    slow["slow"].attrs["units"] = "s"
    (axes,) = plots.histogram(slow, "slow").axes
    assert axes.get_xlabel() == "Meaning of slow [days]" and axes.get_xlim()[1] < 10


def test_rows_at_the_ends_of_a_logarithmic_histogram_are_drawn():
    """A third of them share a largest value whose logarithm is rounded down."""
    values = np.where(np.arange(400) % 3, np.geomspace(1e-6, 5e-5, 400), 5e-4)
    ds = asking(with_output(linear(samples=400), "depth", values), outputs=["depth"])
    (axes,) = plots.histogram(ds, "depth").axes
    assert axes.get_xscale() == "log"
    assert axes.get_ylabel() == "Density [per decade]"
    (steps,) = (patch.get_data() for patch in axes.patches if hasattr(patch, "get_data"))
    assert np.isclose(sum(steps.values * np.diff(np.log10(steps.edges))), 1.0)


def test_marks_lie_on_the_curve_that_integrates_what_scales_a_life():
    ds, _ = lifetime()
    axes = plots.lifetime(ds, "life").axes[0]
    curve = next(line for line in axes.lines if len(line.get_xdata()) > 100)
    marks = next(line for line in axes.lines if line.get_marker() == "o")
    b_lives = summarised(ds)["outputs"]["life"]["b_lives"]
    assert np.allclose(
        marks.get_xdata() * 86400, [b_lives[n]["value"] for n in ("B1", "B10", "B50")]
    )
    on_it = np.interp(marks.get_xdata(), curve.get_xdata(), curve.get_ydata())
    assert np.allclose(on_it, marks.get_ydata(), atol=0.006)


def test_index_bars_show_values_intervals_and_full_names():
    ds = linear("saltelli", samples=64, replicates=4)
    figure = plots.index_bars(ds, "y")
    (axes,) = figure.axes
    assert len(axes.patches) == 8 and len(axes.collections) == 2
    assert [label.get_text() for label in axes.get_yticklabels()] == [
        f"Independent input ($x_{{{i}}}$)" for i in (1, 2, 3, 4)
    ]
    assert "Value of the function" in words(figure) and "95 % interval" in words(figure)
    plain = words(plots.index_bars(linear(samples=128), "y", method="pawn"))
    assert "PAWN" in plain and "95 % interval" not in plain
    assert "95 % limit for an input without effect" in plain
    fitted = words(plots.index_bars(linear(samples=600), "y", method="hdmr"))
    assert "50 % limit for an input without effect" in fitted and "largest" not in fitted


def test_a_wide_interval_does_not_squeeze_the_bars():
    ds = linear("saltelli", 16, 2)
    rare = np.where(ds["y"].values > 8.3, 1000.0, ds["x2"].values)
    axes = plots.index_bars(with_output(ds, "rare", rare), "rare").axes[0]
    assert max(patch.get_width() for patch in axes.patches) > 0.3
    low, high = axes.get_xlim()
    assert -0.25 <= low <= 0 and high <= 1.25


def test_titles_of_indices_are_in_words():
    ds = linear("saltelli", 32, 4)
    ds = with_output(ds, "life", 1440 * ds["y"].values, "lifetime")
    ds = asking(ds, outputs=["life"], thresholds={"life": [7200.0]})
    assert "Logarithm of the meaning of life" in words(plots.index_bars(ds, "log(life)"))
    assert "Rank of the meaning of life" in words(plots.index_bars(ds, "rank(life)"))
    assert "Inverse of the meaning of life" in words(plots.index_bars(ds, "rate(life)"))
    assert "Whether the meaning of life is below 2 hours" in words(
        plots.index_bars(ds, "P(life<7200.0)")
    )
    with pytest.raises(InputError, match=r"'life' is ambiguous; name one of: log\(life\), P"):
        plots.index_bars(ds, "life")
    flat = with_output(ds, "flat", np.ones(ds.sizes["row"]))
    with pytest.raises(InputError, match="flat: the same value"):
        plots.index_bars(flat, "flat")


@pytest.mark.parametrize("value", [np.nan, np.inf, 3.0])
@pytest.mark.parametrize("kind", ["lifetime", "value"])
def test_degenerate_results_are_drawn_all_the_same(value, kind):
    ds = asking(with_output(linear(samples=64), "odd", np.full(64, value), kind), outputs=["odd"])
    drawn = [plots.lifetime if kind == "lifetime" else plots.histogram, plots.scatter]
    for draw in drawn:
        draw(ds, "odd").draw_without_rendering()
    assert len(plots.quantile_table(ds, "odd")) == 3
    if np.isfinite(value):
        plots.convergence(ds, "odd").draw_without_rendering()


def test_lifetime_figure_marks_b_lives_and_reads_both_ways():
    ds = with_output(linear(samples=200), "life", np.linspace(1.0, 3.0, 200), "lifetime")
    axes = plots.lifetime(ds, "life").axes[0]
    marks = {
        round(float(share), 2): time
        for line in axes.lines
        if line.get_marker() == "o"
        for time, share in zip(*line.get_data(), strict=True)
    }
    assert marks == pytest.approx({0.01: 1.02, 0.1: 1.2, 0.5: 2.0}, abs=0.02)
    (other,) = axes.child_axes
    assert other.get_ylabel() == "Survival probability"
    axes.figure.draw_without_rendering()
    assert sorted(other.get_ylim()) == pytest.approx([-0.02, 1.0])


def test_histograms_by_regime_add_up():
    ds = kinds(samples=300)
    figure = plots.histogram_by_regime(ds, "work[side=left]")
    slow, fast = figure.axes[0].patches
    parts = [
        np.sum((steps.values - steps.baseline) * np.diff(steps.edges))
        for steps in (slow.get_data(), fast.get_data())
    ]
    assert sum(parts) == pytest.approx(1)
    assert parts[0] == pytest.approx(float((ds["regime"] == 0).mean()))
    assert "slow" in words(figure) and "Work rate [W]" in words(figure)
    assert len(plots.histogram_by_regime(ds, "life").axes) == 4
    part = with_output(ds, "part", np.where(ds["regime"] == 0, ds["x1"], np.nan))
    assert "fast" not in words(plots.histogram_by_regime(part, "part"))


def test_a_figure_of_a_life_names_its_bound_its_threshold_and_what_is_assumed():
    ds, _ = lifetime()
    ds = asking(
        ds,
        thresholds={"life": 864000.0},
        tolerance={"coverage": 0.95, "confidence": 0.95},
    )
    figure = plots.lifetime(ds, "life")
    text = " ".join(words(figure).split())
    (share,) = summarised(ds)["outputs"]["life"]["thresholds"].values()
    assert f"{100 * share['below']['value']:.1f} % within 10 days" in text
    bound = summarised(ds)["outputs"]["life"]["tolerance"]["lower"] / 86400
    (named,) = re.findall(r"95/95 life ([\d.]+) days", text)
    assert bound - 0.01 < float(named) <= bound  # rounded to the safe side
    assert "not a prediction" not in text
    ds["depth"].attrs["source"] = "assumed: a guess"  # all lives are proportional to it
    assert "not a prediction: depth assumed" in words(plots.lifetime(ds, "life"))


def test_index_bars_count_inputs_that_do_not_matter():
    inside = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
    tables = {
        "study": {"name": "g", "model": "g-function"},
        "design": {"method": "saltelli", "samples": 256, "replicates": 4},
        "uncertain": {f"x{i}": inside for i in range(1, 9)},
    }
    ds = computed(study_of(tables))
    figure = plots.index_bars(ds, "y")
    labels = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert len(labels) == 4 and "x_{1}" in labels[-1]
    assert "4 other inputs: at most 0.0" in words(figure)
    assert len(plots.index_bars(ds, "y", every=True).axes[0].get_yticklabels()) == 8


def test_shares_of_regimes_add_up_over_the_input_that_decides_them():
    ds = kinds(samples=200)
    first, _ = plots.regime_shares(ds).axes
    assert first.get_xlabel() == "First input ($x_{1}$) [m]"  # decides it alone
    slow, fast = (patch.get_data() for patch in first.patches)
    assert np.allclose(slow.values, fast.baseline) and np.allclose(fast.values, 1)
    middles = (slow.edges[1:] + slow.edges[:-1]) / 2
    assert (slow.values[middles < 0.45] == 1).all() and (slow.values[middles > 0.55] == 0).all()
    with pytest.raises(InputError, match="need a model with regimes"):
        plots.regime_shares(linear())


def test_a_line_has_no_pieces_too_short_to_be_one():
    there = np.array([1, 1, 0, 1, 1, 1, 0, 0, 1], dtype=bool)
    assert _fragments(there).nonzero()[0].tolist() == [0, 1, 8]
    assert not _fragments(np.ones(3, dtype=bool)).any()


def test_a_mean_through_empty_space_is_no_line_but_one_between_few_rows_is():
    axes = Figure().subplots()
    axes.set_ylim(0, 10)
    apart = np.r_[np.linspace(0, 1, 10), np.linspace(9, 10, 10)]
    assert _is_empty(apart, float(apart.mean()), axes)
    few = np.random.default_rng(1).uniform(0, 10, (200, 20))
    is_empty = [_is_empty(rows, float(rows.mean()), axes) for rows in few]
    assert np.mean(is_empty) < 0.02
    assert not _is_empty(apart, np.inf, axes)


def test_a_median_whose_interval_reaches_over_empty_space_is_no_line():
    axes = Figure().subplots()
    axes.set_ylim(0, 10)
    rng = np.random.default_rng(1)
    apart = np.r_[np.linspace(0, 1, 10), np.linspace(9, 10, 10)]
    assert _is_torn(apart, *quantile_interval(apart, 0.5), axes)
    assert not _is_torn(apart, 0.0, 0.9, axes) and not _is_torn(apart, np.nan, np.nan, axes)
    whole = [np.sort(rows) for rows in rng.uniform(0, 10, (200, 20))]
    assert not any(_is_torn(rows, *quantile_interval(rows, 0.5), axes) for rows in whole)


def test_scatter_leads_with_what_matters_and_shows_conditional_means():
    ds = linear(samples=1000)
    figure = plots.scatter(ds, "y")
    assert [axes.get_xlabel() for axes in figure.axes] == [
        f"Independent input ($x_{{{i}}}$)" for i in (4, 3, 2)
    ]
    points, line = figure.axes[0].lines
    assert np.array_equal(points.get_xdata(), ds["x4"].values)  # 4 x4 moves y most
    slope = np.polyfit(line.get_xdata(), line.get_ydata(), 1)[0]
    assert slope == pytest.approx(4, abs=0.5)
    assert len(figure.axes[0].collections) == 1 and "95 % band" in words(figure)
    assert not plots.scatter(linear("sobol", samples=256), "y").axes[0].collections
    lives = plots.scatter(kinds(samples=300), "life")
    assert "never (at the top edge)" in words(lives) and "censored" in words(lives)
    assert "median in slices" in words(lives)


def test_many_rows_are_thinned_in_figures():
    figure = plots.scatter(linear(samples=20_000), "y")
    assert len(figure.axes[0].lines[0].get_xdata()) == 3000


def test_pairs_show_the_inputs_that_decide_the_regime():
    ds = kinds(samples=200)
    figure = plots.pairs(ds)
    (axes,) = figure.axes
    assert axes.get_xlabel() == "First input ($x_{1}$) [m]"  # decides it alone
    (points,) = axes.collections
    x, colours = points.get_offsets()[:, 0], points.get_facecolors()
    assert np.array_equal(x, ds["x1"].values)  # in the order of the rows: none covers the others
    slow, fast = (set(map(tuple, colours[part])) for part in (x <= 0.5, x > 0.5))
    assert len(slow) == len(fast) == 1 and slow != fast
    with pytest.raises(InputError, match="need a model with regimes and two uncertain inputs"):
        plots.pairs(linear())


def test_a_regime_of_one_row_does_not_choose_the_inputs_of_pairs():
    ds = kinds(samples=200)
    ds["regime"].attrs |= {"flag_values": [-1, 0, 1, 2], "flag_meanings": "none slow fast odd"}
    chance = np.random.default_rng(0).random(200)
    ds["regime"].values[:] = ds["x1"].values + chance > 1
    ds["regime"].values[int(ds["x2"].values.argmax())] = 2
    (axes,) = plots.pairs(ds).axes
    assert axes.get_xlabel() == "First input ($x_{1}$) [m]"
    assert len(axes.lines) == 3


def test_convergence_ends_with_all_rows_and_narrows():
    ds = linear(samples=512)
    figure = plots.convergence(ds, "y")
    (axes,) = figure.axes
    line = axes.lines[0]
    assert line.get_xdata().tolist() == [16, 32, 64, 128, 256, 512]
    assert line.get_ydata()[-1] == pytest.approx(float(ds["y"].mean()))
    band = axes.collections[0].get_paths()[0].vertices
    first, last = (np.ptp(band[band[:, 0] == n, 1]) for n in (16, 512))
    assert last < first / 3
    assert "Mean: value of the function" in words(figure) and axes.get_xlabel() == "Samples"
    assert "Median: time to a depth" in words(plots.convergence(kinds(samples=64), "life"))
    lives = np.r_[np.linspace(1.0, 2.0, 60), np.full(4, np.inf)]  # only the first rows have a mean
    (axes,) = plots.convergence(with_output(linear(), "life", lives, "lifetime"), "life").axes
    assert axes.get_title("left").startswith("Median: ")
    assert axes.lines[0].get_xdata()[-1] == 64
    with pytest.raises(InputError, match=sentence("no fewer samples")):
        plots.convergence(linear("latin-hypercube", samples=64), "y")


def test_total_indices_converge_in_a_figure():
    ds = linear("saltelli", samples=64, replicates=4)
    figure = plots.index_convergence(ds, "y")
    (axes,) = figure.axes
    assert len(axes.lines) == 4 and "Independent input ($x_{4}$)" in words(figure)
    for line in axes.lines:  # side by side, near their number of samples
        assert np.log2(line.get_xdata()) == pytest.approx([4, 5, 6], abs=0.1)
    assert axes.lines[0].get_ydata()[-1] == pytest.approx(16 / 30, abs=0.01)
    assert axes.get_xlabel() == "Samples of each of 4 replicates"


def test_quantiles_are_a_table_to_print():
    ds = kinds(samples=200)
    entries = summarised(ds)["outputs"]
    table = plots.quantile_table(ds, "work")
    assert list(table.columns) == ["of", "quantile", "Work rate [W]", "95 % interval"]
    median = entries["work[side=left]"]["quantiles"]["0.5"]["value"]
    assert table.iloc[1, :3].tolist() == ["left", "50 %", f"{median:.3f}"]
    assert "never" in plots.quantile_table(ds, "life").to_string()
