"""What captions, titles and axes of figures say: names in words, counts as in sentences."""

from computed import asking, kinds, linear, with_output

from uq import plots
from uq.assess.findings import Findings
from uq.plots import FIGURES
from uq.render.figures.catalogue import drawables
from uq.render.figures.figure import lay_out
from uq.render.html.pictures import pictures
from uq.result.result import Result


def captions(ds):
    return [picture.caption for picture in drawables(FIGURES, Findings(Result(ds)))]


def test_captions_name_outputs_and_events_in_words():
    shown_captions = captions(linear(samples=400, analysis={"thresholds": {"y": 6.0}}))
    event = "Probability that the value of the function is above 6, over its main driver"
    assert event in shown_captions
    assert "Value of the function, against the inputs with which it varies most" in shown_captions
    assert "Convergence: value of the function" in shown_captions
    of_kinds = captions(kinds(samples=200, analysis={"thresholds": {"life": 1.0}}))
    assert not any(
        "[" in caption or "P(" in caption or "_" in caption
        for caption in [*shown_captions, *of_kinds]
    )


def test_the_size_of_an_angle_is_what_exceeds_a_threshold():
    shown_captions = captions(kinds(samples=400, analysis={"thresholds": {"angle": 0.5}}))
    (event,) = (
        caption
        for caption in shown_captions
        if caption.startswith("Probability that the magnitude of the ")
    )
    assert event.endswith(", over its main driver")


def test_outputs_of_one_meaning_have_pictures_that_do_not_share_identifiers():
    ds = with_output(linear(samples=100), "z", linear(samples=100)["x1"].values)
    ds["z"].attrs["long_name"] = ds["y"].attrs["long_name"]
    first, second = (
        picture
        for picture in pictures(Findings(Result(ds)), "results")
        if picture.caption == "Value of the function"
    )
    identifiers = [set(picture.html.split('id="')[1:]) for picture in (first, second)]
    names = [
        {markup.split('"')[0] for markup in identifiers_of_picture}
        for identifiers_of_picture in identifiers
    ]
    assert names[0] and not names[0] & names[1]


def test_counts_of_rows_have_their_thousands_apart():
    ds = linear(samples=1024)
    titles = [plots.histogram(ds, "y"), plots.inputs(ds)]
    for figure in titles:
        assert "1 024 runs" in figure.axes[0].get_title(loc="left").replace("\n", " ")


def test_counts_along_an_axis_have_their_thousands_apart():
    figure = plots.convergence(linear(samples=4096), "y")
    lay_out(figure)
    assert "1 024" in [tick_label.get_text() for tick_label in figure.axes[0].get_xticklabels()]


def test_what_has_not_happened_is_said_as_one_says_it():
    ds = linear(samples=100)
    ds = with_output(ds, "locking", ds["y"].values, "lifetime")
    ds["locking"].attrs["success"] = "the motors have locked"
    axes = plots.lifetime(asking(ds, outputs=["locking"]), "locking").axes[0]
    (right,) = axes.child_axes
    assert right.get_ylabel() == "Probability that it has\nnot happened yet"


def test_dashes_of_marked_lines_can_be_seen_in_the_legend():
    figure = plots.convergence(kinds(samples=400), "life")
    (legend,) = figure.legends
    dashed = next(handle for handle in legend.legend_handles if handle.get_linestyle() == "--")
    start, *_, end = dashed.get_xdata()
    assert end - start - dashed.get_markersize() >= 12  # two dashes [points]
