"""What captions, titles and axes of figures say: names in words, counts as in sentences."""

from computed import asking, kinds, linear, with_output

from uq import plots
from uq.result.result import Result
from uq.assess.findings import Findings
from uq.plots import FIGURES
from uq.render.figures.catalogue import drawables
from uq.render.figures.figure import lay_out
from uq.render.html.pictures import pictures


def captions(ds):
    return [one.caption for one in drawables(FIGURES, Findings(Result(ds)))]


def test_captions_name_outputs_and_events_in_words():
    found = captions(linear(samples=400, analysis={"thresholds": {"y": 6.0}}))
    event = "Probability that the value of the function is above 6, over the input that decides it"
    assert event in found
    assert "Value of the function, against the inputs with which it varies most" in found
    assert "Convergence: value of the function" in found
    of_kinds = captions(kinds(samples=200, analysis={"thresholds": {"life": 1.0}}))
    assert not any("[" in one or "P(" in one or "_" in one for one in [*found, *of_kinds])


def test_the_size_of_an_angle_is_what_exceeds_a_threshold():
    found = captions(kinds(samples=400, analysis={"thresholds": {"angle": 0.5}}))
    (event,) = (one for one in found if one.startswith("Probability that the magnitude of the "))
    assert event.endswith(", over the input that decides it")


def test_outputs_of_one_meaning_have_pictures_that_do_not_share_identifiers():
    ds = with_output(linear(samples=100), "z", linear(samples=100)["x1"].values)
    ds["z"].attrs["long_name"] = ds["y"].attrs["long_name"]
    first, second = (
        one for one in pictures(Findings(Result(ds)), "results") if one.caption == "Value of the function"
    )
    identifiers = [set(one.html.split('id="')[1:]) for one in (first, second)]
    names = [{one.split('"')[0] for one in own} for own in identifiers]
    assert names[0] and not names[0] & names[1]


def test_counts_of_rows_have_their_thousands_apart():
    ds = linear(samples=1024)
    titles = [plots.histogram(ds, "y"), plots.inputs(ds)]
    for figure in titles:
        assert "1 024 rows" in figure.axes[0].get_title(loc="left").replace("\n", " ")


def test_counts_along_an_axis_have_their_thousands_apart():
    figure = plots.convergence(linear(samples=4096), "y")
    lay_out(figure)
    assert "1 024" in [one.get_text() for one in figure.axes[0].get_xticklabels()]


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
    dashed = next(one for one in legend.legend_handles if one.get_linestyle() == "--")
    start, *_, end = dashed.get_xdata()
    assert end - start - dashed.get_markersize() >= 12  # two dashes [points]
