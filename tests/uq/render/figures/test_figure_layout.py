"""Words, numbers and labels in figures: plain, whole and apart."""

from itertools import pairwise

import numpy as np
import pytest
from computed import kinds, linear, with_output
from drawn import words
from matplotlib.figure import Figure

from uq import plots
from uq.render.figures.catalogue import file_name
from uq.render.figures.elements_plot import display_unit
from uq.render.figures.figure import lay_out
from uq.render.figures.line_labels import label_two_curves
from uq.render.figures.panel import logarithmic, roomy
from uq.render.figures.words import as_label, powers


def test_numbers_on_logarithmic_axes_are_plain():
    ds = with_output(linear(samples=200), "wide", np.geomspace(1e-3, 1e4, 200))
    for figure, tick in (
        (plots.histogram(ds, "wide"), "0.01"),
        (plots.scatter(ds, "wide"), "0.01"),
    ):
        figure.draw_without_rendering()
        assert "mathdefault" not in words(figure) and tick in words(figure).split()


def test_minus_signs_are_the_same_on_every_axis():
    ds = with_output(linear(samples=200), "shift", np.linspace(-5.0, 5.0, 200))
    figure = plots.scatter(ds, "shift")
    figure.draw_without_rendering()
    assert "\N{MINUS SIGN}5" in words(figure).split() and "-5" not in words(figure).split()


def test_words_and_units_of_axes():
    assert as_label("worn volume per work", "m2 N-1") == "Worn volume per work [m² N⁻¹]"
    assert as_label("a $price$") == r"A \$price\$"
    assert as_label("stiffness of a stop", "N m-1", 24) == "Stiffness of a\nstop [N m⁻¹]"
    assert as_label("a pure number", "1") == "A pure number"
    assert powers("kg m-1") == "kg m⁻¹"
    assert file_name("sobol", "P(life[depth=0.1]<1e6)") == "sobol-P_life_depth_0.1_1e6"


def test_values_with_a_zero_among_them_have_no_logarithmic_axis():
    values = np.r_[np.zeros(2), np.geomspace(1e-3, 1e3, 998)]
    figure = plots.histogram(with_output(linear(samples=1000), "wide", values), "wide")
    assert figure.axes[0].get_xscale() == "linear"
    assert figure.axes[0].get_xlim()[0] <= 0


def test_labels_of_three_lines_keep_apart():
    ds = linear(samples=64, analysis={"sensitivity": ["rbd-fast"]})
    for name in ("x1", "x2", "x3", "x4"):
        ds[name].attrs["long_name"] = (
            "bearing torque of the vibrator over its centrifugal force, mean"
        )
    figure = plots.index_bars(ds, "y")
    lay_out(figure)
    boxes = [label.get_window_extent() for label in figure.axes[0].get_yticklabels()]
    boxes.sort(key=lambda box: box.y0)
    assert boxes[0].height > 2.5 * 8 * figure.dpi / 72  # three lines of 8 points
    assert all(upper.y1 <= other.y0 for upper, other in pairwise(boxes))


def test_nothing_sticks_out_of_a_figure():
    ds = linear(samples=400)
    y = ds["y"].values
    ds = with_output(ds, "angle", 0.14 * (y - y.mean()) / y.std())
    ds["angle"].attrs["long_name"] = "mean of psi_1 - psi_2 over one revolution"
    figure = plots.scatter(ds, "angle")
    lay_out(figure)
    assert min(text.get_window_extent().x0 for text in figure.axes[0].get_yticklabels()) >= 0
    ds = with_output(ds, "stroke", 0.00466 + 4e-5 * (y - y.mean()) / y.std())
    ds["stroke"].attrs["long_name"] = "half peak-to-peak displacement along xi of the deck end"
    ds["x4"].attrs["long_name"] = "damping of the supports, b = 2 xi sqrt((M_k + 2m) k)"
    figure = plots.scatter(ds, "stroke")
    lay_out(figure)
    labels = [axes.xaxis.label.get_window_extent() for axes in figure.axes]
    ends = [*(box.x0 for box in labels[1:]), figure.bbox.x1]
    room = 0.01 * figure.bbox.x1  # a browser's letters may be wider
    assert all(box.x1 + room <= end for box, end in zip(labels, ends, strict=True))


def test_labels_of_pairs_keep_apart():
    ds = linear(samples=64).assign(regime=kinds(samples=64)["regime"])
    for name in ("x1", "x2", "x3", "x4"):
        ds[name] = ds[name].copy(data=15000 + 300 * ds[name].values)
        ds[name].attrs["long_name"] = "phase of vibrator 1 at the start, from hanging down"
    figure = plots.pairs(ds)
    lay_out(figure)
    _, left, right = (axes for axes in figure.axes if axes.axison)
    box, other = (axes.xaxis.label.get_window_extent() for axes in (left, right))
    assert box.x1 < other.x0 and other.x1 <= figure.bbox.x1
    figure = plots.pairs(kinds(samples=64))
    lay_out(figure)
    (axes,) = figure.axes
    assert axes.bbox.height > 0.6 * axes.bbox.width


def test_long_numbers_have_room():
    ds = with_output(linear(), "stroke", np.linspace(0.004593, 0.004727, 64))
    figure = plots.histogram(ds, "stroke")
    lay_out(figure)
    boxes = [label.get_window_extent() for label in figure.axes[0].get_xticklabels()]
    assert all(box.x1 < other.x0 for box, other in pairwise(boxes))
    axes = Figure().subplots()
    axes.set_xlim(7e4, 5.2e5)
    roomy(axes, ticks=3)
    shown = [tick for tick in axes.get_xticks() if 7e4 <= tick <= 5.2e5]
    assert 1 <= len(shown) <= 2


@pytest.mark.parametrize(
    ("ends", "numbers"),
    [((-0.445, -0.356), ["−0.425", "−0.375"]), ((1.3e6, 2.8e6), ["1.5e6", "2e6", "2.5e6"])],
)
def test_numbers_have_room_where_no_round_step_leaves_two(ends, numbers):
    axes = Figure().subplots()
    axes.set_xlim(ends)
    roomy(axes, ticks=3)
    shown = [tick for tick in axes.get_xticks() if ends[0] <= tick <= ends[1]]
    assert axes.xaxis.get_major_formatter().format_ticks(shown) == numbers


def test_colours_of_points_are_seen_in_the_legend():
    (shown,) = plots.pairs(kinds(samples=200)).legends
    assert len(shown.legend_handles) == 2
    assert all(handle.get_markersize() >= 6 for handle in shown.legend_handles)


def test_short_entries_of_a_legend_stand_side_by_side():
    ds = kinds(samples=64)
    is_side_by_side = []
    for figure in (plots.pairs(ds), plots.lifetime(ds, "life")):
        lay_out(figure)
        figure.canvas.draw()
        (legend,) = figure.legends
        is_side_by_side.append([text.get_window_extent().y0 for text in legend.get_texts()])
    side_by_side, below_each_other = is_side_by_side
    assert len(set(side_by_side)) == 1 < len(side_by_side)
    assert len(set(below_each_other)) == len(below_each_other) == 7


def test_the_legend_of_many_indices_of_few_inputs_has_room():
    ds = kinds(samples=1000, analysis={"quantiles": [0.1, 0.5, 0.9]})
    figure = plots.index_bars(ds, "work[side=left]", method="quantile")
    lay_out(figure)  # a warning, which is an error here, if nothing is left for the bars
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert len(labels) == len(set(labels)) == 5
    assert figure.axes[0].get_window_extent().height > 30


def test_a_logarithmic_axis_of_more_than_a_decade_labels_1_2_and_5():
    figure = Figure((3, 2))
    axes = figure.subplots()
    axes.plot([0.18, 9.5], [0, 1])
    logarithmic(axes)
    axes.set_xlim(0.18, 9.5)
    figure.draw_without_rendering()
    labels = axes.xaxis.get_ticklabels(which="both")
    shown = [label.get_text() for label in labels if label.get_text()]
    assert sorted(shown, key=float) == ["0.1", "0.2", "0.5", "1", "2", "5", "10"]


@pytest.mark.parametrize(
    ("values", "unit"), [(np.geomspace(500.0, 3e4, 99), "hours"), (np.linspace(1, 99, 99), "s")]
)
def test_an_axis_of_times_has_the_unit_of_long_ones(values, unit):
    assert display_unit("s", values).name == unit


def test_curves_are_labelled_only_where_the_labels_say_which_is_which():
    axes = Figure().subplots()
    axes.set_xlim(0, 10)
    time = np.linspace(0, 10, 50)
    colours, texts = ["black", "gray"], ["57 µm", "228 µm"]
    early, late = np.clip(time / 4, 0, 1), np.clip(time / 8, 0, 1)
    assert label_two_curves(axes, [(time, early), (time, late)], texts, colours, [])
    for other in (early, 0.1 * early):  # the same curve, and one that ends low
        assert not label_two_curves(axes, [(time, early), (time, other)], texts, colours, [])
