"""No text of a figure touches another, or sticks out, with the longest names of the machines."""

import numpy as np
import pytest
from computed import asking, kinds, linear, with_output
from drawn import collisions

import uq
from models import beam, mole, vibrator
from uq.assess.findings import Findings
from uq.plots import FIGURES
from uq.render.figures.catalogue import drawables
from uq.render.figures.figure import lay_out
from uq.result.result import Result


def dressed(ds, model):
    """Give inputs and outputs the longest names of a machine, with its symbols and units."""
    parameters = [model.parameter(name) for name in model.parameter_names]
    longest = sorted(parameters, key=lambda declared: -len(declared.meaning + declared.symbol))
    names = [name for name in ds.data_vars if ds[name].attrs.get("role") == "input"]
    for name, declared in zip(names, longest, strict=False):
        ds[name].attrs |= {
            "long_name": declared.meaning,
            "symbol": declared.symbol,
            "units": declared.unit,
        }
    meanings = sorted((output.meaning for output in model.outputs.values()), key=len)
    for name in ds.data_vars:
        if ds[name].attrs.get("role") == "output" and name != "regime":
            ds[name].attrs["long_name"] = meanings[-1]
    return ds


def figures(ds):
    findings = Findings(Result(ds))
    kinds_of = {name: entry for name, entry in FIGURES.items() if "running" not in entry.needs}
    for picture in drawables(kinds_of, findings):
        figure = picture.draw()
        lay_out(figure)
        yield picture.file, figure


@pytest.mark.parametrize("model", [beam.MODEL, mole.MODEL, vibrator.MODEL], ids=lambda m: m.name)
def test_no_text_of_a_figure_touches_another(model):
    ds = linear(samples=100)
    ds = with_output(ds, "small", 1e-5 * ds["y"].values)
    ds = asking(ds, outputs=["small"], thresholds={"small": 9e-5}, sensitivity=["rbd-fast"])
    for name, figure in figures(dressed(ds, model)):
        assert not collisions(figure), name


def test_no_text_of_a_figure_by_regime_touches_another():
    ds = asking(kinds(samples=100), outputs=["work"], sensitivity=["rbd-fast"])
    for name, figure in figures(dressed(ds, vibrator.MODEL)):
        assert not collisions(figure), name


@pytest.mark.parametrize("most", [9e4, 4e5, 3e7])
def test_the_second_scale_of_a_life_touches_nothing(most):
    ds = with_output(linear(samples=100), "life", np.geomspace(1e3, most, 100), "lifetime")
    (figure,) = (
        drawing for name, drawing in figures(asking(ds, outputs=["life"])) if "lifetime" in name
    )
    (second,) = figure.axes[0].child_axes
    numbers = [
        tick_label.get_window_extent()
        for tick_label in second.get_yticklabels()
        if tick_label.get_text()
    ]
    label = second.yaxis.label.get_window_extent()
    assert numbers and not any(number.overlaps(label) for number in numbers)
    assert label.x1 <= figure.bbox.x1
    assert not collisions(figure)


def test_thresholds_are_drawn_wherever_the_output_is():
    ds = with_output(linear(samples=100), "psi", np.radians(np.linspace(-20, 20, 100)), "angle")
    ds["psi"].attrs["units"] = "rad"
    ds = asking(ds, outputs=["psi"], thresholds={"psi": float(np.radians(12))})
    shown = dict(figures(ds))
    (legend,) = shown["scatter-psi"].legends
    assert "threshold ±12°" in [text.get_text() for text in legend.get_texts()]
    above = [text.get_text() for text in shown["histogram-psi"].axes[0].texts]
    assert above == ["−12°", "40.0 % beyond 12°"]
    lines = [line.get_xdata()[0] for line in shown["histogram-psi"].axes[0].lines]
    assert lines == pytest.approx([-12, 12])


@pytest.mark.parametrize(
    ("wanted", "sides"), [({"y": "above"}, ["lower"]), ({}, ["lower", "upper"])]
)
def test_a_histogram_draws_the_tolerance_bounds_on_the_sides_that_matter(wanted, sides):
    asked = {"tolerance": {"coverage": 0.9, "confidence": 0.9}, "wanted": wanted}
    ds = asking(linear(samples=100), outputs=["y"], **asked)
    figure = dict(figures(ds))["histogram-y"]
    statistics = uq.summary(ds).T["y"]
    drawn = [line.get_xdata()[0] for line in figure.axes[0].lines if line.get_linestyle() == ":"]
    assert drawn == [statistics[f"tolerance_{side}"] for side in sides]
    named = [text.get_text() for text in figure.axes[0].texts]
    assert len(named) == len(sides) and all(text.startswith("90/90 bound ") for text in named)


def test_bounds_of_the_sign_of_an_angle_are_not_drawn():
    ds = with_output(linear(samples=100), "psi", np.radians(np.linspace(-20, 20, 100)), "angle")
    ds = asking(ds, outputs=["psi"], tolerance={"coverage": 0.9, "confidence": 0.9})
    assert not dict(figures(ds))["histogram-psi"].axes[0].lines
