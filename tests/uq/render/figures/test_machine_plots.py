"""Figures of machines: what a reader finds on the axes, and that each point is where it belongs."""

import numpy as np
import pytest
import sample_models
import xarray as xr
from matplotlib.colors import to_hex

import models.beam.explore as beam
import models.mole.explore as mole
import uq
from models.beam.parameters import REGIMES as BEAM_REGIMES
from models.beam.parameters import Params as Beam
from models.beam.parameters import Settings as BeamSettings
from models.mole.parameters import REGIMES
from models.mole.parameters import Params as Mole
from models.mole.parameters import Settings as MoleSettings
from uq import plots
from uq.errors import InputError
from uq.render.figures.figure import COLOURS, lay_out
from uq.text.numbers import percent


def labels(figure):
    """Return what the axes of a figure say; panels above others share the lowest one's."""
    texts = [axes.get_ylabel() for axes in figure.axes] + [figure.axes[-1].get_xlabel()]
    return [" ".join(text.split()) for text in texts]


def entries(figure):
    """Return the lines of the legend."""
    (legend,) = figure.legends
    return [text.get_text() for text in legend.get_texts()]


@pytest.fixture(scope="module")
def swept():
    return mole.bifurcation_diagram([7.0, 8.0], Mole(), MoleSettings(), dropped=2, kept=5)


@pytest.fixture(scope="module")
def basins():
    axes = {"initial_displacement": (-0.05, 0.0, 3), "initial_velocity": (-1.0, 1.0, 2)}
    return uq.basins("mole", axes, {"control_frequency": 10.0}, workers=0)


@pytest.fixture(scope="module")
def worn():
    frequency = beam.bifurcation_diagram(Beam(), BeamSettings(), [54.6, 54.8], periods=2)
    gaps = beam.work_rate_against_gap(
        Beam(forcing_frequency=54.797), BeamSettings(), [2.5e-4, 3e-4]
    )
    return frequency, gaps


def test_every_axis_of_a_machine_has_words_and_a_unit(swept, basins, worn):
    frequency, gaps = worn
    history = mole.history(Mole(), MoleSettings(), 0.0, 0.1, points=50)
    figures = [
        plots.history(uq.simulate("mole")),
        plots.history(history),
        plots.phase_portrait(history, section=swept.isel(control_frequency=0)),
        plots.section(swept),
        plots.bifurcation(swept, "displacement", against="control_frequency", by="regime"),
        plots.bifurcation(frequency, "impact_velocity", against="forcing_frequency"),
        plots.curve(gaps, "work_rate", against="gap"),
        plots.curve(swept, "progression_rate", against="control_frequency"),
        plots.basins(basins, ["progression_rate"]),
    ]
    for figure in figures:
        for label in labels(figure):
            if label != "1 while the relay is closed, else 0":  # a number
                assert "_" not in label.split(" (")[0]
                assert label[0].isupper() and label.endswith("]")
    assert labels(figures[-1]) == [
        "Rate of u at the start ($v(0)$) [m s⁻¹]",
        "Displacement u at the start ($u(0)$) [mm]",
    ]
    assert labels(figures[2]) == [
        "Rate of u [m s⁻¹]",
        "Displacement u of the bar relative to the mole [mm]",
    ]


def test_long_labels_of_low_panels_do_not_overlap():
    figure = plots.history(uq.simulate("mole"))
    figure.draw_without_rendering()
    boxes = [axes.yaxis.label.get_window_extent() for axes in figure.axes]
    assert len(boxes) == 11
    for upper, axes, lower in zip(boxes, figure.axes, boxes[1:], strict=False):
        assert lower.y1 < axes.get_window_extent().y0 < upper.y0
        assert upper.x1 <= figure.bbox.width


def test_a_history_in_panels_of_one_and_of_several_quantities():
    ds = uq.simulate(sample_models.KINDS)
    figure = plots.history(ds)
    assert labels(figure) == ["Place [m]", "Speed [m s⁻¹]", "Time [s]"]
    assert figure.axes[0].lines[0].get_ydata()[-1] == pytest.approx(0.25)
    run_up = xr.Dataset(
        {
            "a": ("time", [1.0, 2.0], {"units": "m s-1", "long_name": "first"}),
            "b": ("time", [3.0, 4.0], {"units": "m s-1", "long_name": "second"}),
        },
        {"time": ("time", [0.0, 7200.0], {"units": "s", "long_name": "time"})},
    )
    figure = plots.history(run_up, [["a", "b"]])
    assert labels(figure) == ["[m s⁻¹]", "Time [hours]"]
    assert figure.axes[0].lines[0].get_xdata().tolist() == [0.0, 2.0]
    assert [line.get_label() for line in figure.axes[0].lines] == ["First", "Second"]
    with pytest.raises(InputError, match=r"different units .*: x \[m\], v \[m s-1\]"):
        plots.history(ds, [["x", "v"]])
    with pytest.raises(InputError, match="no such quantity 'sped'; did you mean 'speed'?"):
        plots.history(xr.Dataset({"speed": ("time", [1.0])}, {"time": [0.0]}), ["sped"])


def test_a_portrait_and_its_section_share_a_scale():
    around = np.linspace(0, 2 * np.pi, 50)
    orbit = xr.Dataset(
        {
            "displacement": ("phase", 0.002 * np.cos(around), {"units": "m", "long_name": "x"}),
            "velocity": ("phase", np.sin(around), {"units": "m s-1", "long_name": "v"}),
        }
    )
    figure = plots.phase_portrait(orbit, section=orbit.isel(phase=[0]))
    curve, point = figure.axes[0].lines
    assert curve.get_xdata()[0] == point.get_xdata()[0] == pytest.approx(2.0)
    assert labels(figure) == ["v [m s⁻¹]", "x [mm]"] and entries(figure) == ["Poincaré section"]
    two = xr.concat([orbit, 2 * orbit.assign_attrs()], "start", combine_attrs="override")
    assert entries(plots.section(two)) == ["start 1", "start 2"]


def test_a_bifurcation_diagram_shows_every_point_in_the_colour_of_its_kind(swept):
    labelled = swept.assign(regime=("control_frequency", ["calm", "wild"]))
    figure = plots.bifurcation(labelled, "displacement", against="control_frequency", by="regime")
    assert entries(figure) == ["calm", "wild"]
    for i, line in enumerate(figure.axes[0].lines):
        assert line.get_color() == COLOURS[i]
        assert line.get_xdata() == pytest.approx([7.0 + i] * 5)
        assert line.get_ydata() == pytest.approx(1e3 * swept["displacement"][i].values)


def test_a_regime_has_the_colour_that_it_has_in_results(swept):
    words = np.array(["periodic", "chaotic"])
    labelled = swept.assign(regime=("control_frequency", words, swept["regime"].attrs))
    figure = plots.bifurcation(labelled, "displacement", by="regime")
    assert entries(figure) == ["periodic", "chaotic"]
    colours = [COLOURS[REGIMES.index(word)] for word in words]
    assert [line.get_color() for line in figure.axes[0].lines] == colours


def test_regimes_of_a_beam_are_in_the_order_of_its_model():
    ds = beam.bifurcation_diagram(Beam(), BeamSettings(), [54.6], periods=2)
    assert tuple(ds["regime"].attrs["flag_meanings"].split()) == BEAM_REGIMES


def test_curves_are_named_and_marked_where_the_regime_changes(worn):
    _, gaps = worn
    changing = gaps.assign(regime=("case", ["periodic", "aperiodic"]))
    figure = plots.curve(changing, "work_rate", against="gap")
    assert entries(figure) == ["right", "left", "change of regime"]
    assert figure.axes[0].lines[-1].get_xdata()[0] == pytest.approx(300.0)


def wearing(regimes):
    """Return gaps that grow, one twice as fast as the other."""
    time = np.linspace(0.0, 5e4, len(regimes))
    gap = 2.5e-4 + np.outer(time, [1e-8, 2e-8])
    named = {"long_name": "gap between rod and stop", "units": "m"}
    ds = xr.Dataset({"gap": (("look", "site"), gap, named), "regime": ("look", regimes)})
    ds["time"] = ("look", time, {"long_name": "time of wear", "units": "s"})
    ds["rate"] = (("look", "site"), gap**2, {"long_name": "impact work-rate", "units": "W"})
    return ds.assign_coords(site=["right", "left"])


def test_the_change_of_regime_is_marked_on_every_curve_unless_it_never_stops():
    once = wearing(["periodic"] * 10 + ["aperiodic"] * 10)
    lines = plots.curve(once, "rate", against="gap").axes[0].lines
    assert [line.get_xdata()[0] for line in lines[2:]] == pytest.approx(
        1e3 * once["gap"].isel(look=10).values
    )
    often = plots.curve(wearing(["periodic", "quasi-periodic"] * 20), "rate", against="gap")
    assert entries(often) == ["right", "left"]


def test_the_label_of_a_low_figure_is_whole():
    figure = plots.curve(wearing(["periodic"] * 10 + ["aperiodic"] * 10), "gap", against="time")
    lay_out(figure)
    assert figure.axes[0].yaxis.label.get_window_extent().y1 <= figure.bbox.y1


def test_basins_are_coloured_by_attractor_and_explained(basins):
    labelled = basins.copy(deep=True)
    labelled["attractor"].values[:] = [[0, 0], [1, -1], [0, 0]]
    figure = plots.basins(labelled.isel(basin=[0, 0]), ["progression_rate"])
    (mesh,) = figure.axes[0].collections
    mesh.update_scalarmappable()
    colours = [to_hex(colour).upper() for colour in mesh.get_facecolors()]
    assert colours == [COLOURS[0], COLOURS[1], COLOURS[0], COLOURS[0], "#FFFFFF", COLOURS[0]]
    text = entries(figure)[0]
    assert text.startswith("No-impact, period 1, −") and "µm s⁻¹, " in text and text.endswith(" %")
    assert entries(figure)[-1] == "invalid, 16.7 %"
    share = float(basins["share"][0])
    many = basins.isel(basin=[0] * (len(COLOURS) + 2))
    assert entries(plots.basins(many))[len(COLOURS)] == f"2 others, {percent(2 * share)}"
    with pytest.raises(InputError, match="over two parameters, not 1"):
        plots.basins(basins.isel(initial_velocity=0))


def test_what_cannot_be_drawn_is_refused_in_words(worn):
    _, gaps = worn
    with pytest.raises(InputError, match="no such quantity 'work'; did you mean 'work_rate'?"):
        plots.curve(gaps, "work", against="gap")
    with pytest.raises(InputError, match="'regime' is not numeric and cannot be drawn"):
        plots.curve(gaps, "regime", against="gap")
    deep = gaps.assign(cube=gaps["gap"] * xr.DataArray([1.0, 2.0], dims="layer"))
    with pytest.raises(InputError, match="along case, site, layer, not one or two dimensions"):
        plots.curve(deep, "cube", against="gap")
    with pytest.raises(InputError, match="no variable varies along time"):
        plots.history(gaps)
