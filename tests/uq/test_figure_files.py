"""Figures as files, in a notebook, and in axes that are given."""

import io
import xml.etree.ElementTree as ElementTree

import matplotlib.pyplot as plt
import pytest
from asked_indices import sensitivities
from computed import kinds, linear
from IPython.core.formatters import DisplayFormatter
from matplotlib.figure import Figure
from matplotlib.image import imread

from uq import plots
from uq.result.result import Result
from uq.assess.findings import Findings
from uq.errors import InputError
from uq.render.figures.catalogue import drawables


def files(ds):
    """Return the names of the files of all figures of a result."""
    return {one.file for one in drawables(plots.FIGURES, Findings(Result(ds)))}


@pytest.mark.slow
def test_every_figure_of_a_study_is_written_as_png_svg_and_pdf(tmp_path):
    asked = {"outputs": ["life", "angle", "regime"], "thresholds": {"life": 1.0}}
    ds = kinds(samples=96, analysis=asked | {"sensitivity": ["pawn"]})
    paths = plots.save_all(Result(ds), tmp_path / "new" / "figures")
    assert {path.suffix for path in paths} == {".png", ".svg", ".pdf"}
    stems = {path.stem for path in paths}
    assert {"histogram-angle", "lifetime-life", "pairs", "inputs", "pawn-angle"} < stems
    for kind in ("regimes", "quantiles", "scatter", "convergence"):
        assert {f"{kind}-life", f"{kind}-angle"} < stems
    assert any("regime" in stem and stem.startswith("pawn") for stem in stems)
    assert not any("rate" in stem for stem in stems)  # censored: no rate
    for path in paths:
        if path.suffix == ".png":
            columns = 2 if path.stem.startswith("scatter") else 1  # at 200 dots per inch
            assert 600 < imread(path).shape[1] / columns < 800
        elif path.suffix == ".svg":
            assert ElementTree.parse(path).getroot().tag.endswith("svg")
        else:
            assert path.read_bytes().startswith(b"%PDF-")


@pytest.mark.parametrize("figure", ["histogram", "scatter", "regimes", "quantiles", "inputs"])
def test_figures_are_drawn_into_axes_that_are_given(figure):
    ds, (whole, (left, right)) = kinds(samples=40), plt.subplots(1, 2, layout="constrained")
    entry = plots.FIGURES[figure]
    names = [] if figure == "inputs" else ["work"]
    assert entry.draw(ds, *names, axes=right) is whole
    whole.draw_without_rendering()
    (alone,) = {len(entry.draw(ds, *names).axes)}
    drawn = [axes for axes in whole.axes if axes is not left and axes.axison]
    assert len(drawn) == alone or figure == "quantiles"
    middle = whole.bbox.width / 2
    assert all(axes.bbox.x0 >= middle for axes in drawn)
    assert not left.lines and not left.texts and not whole.legends
    plt.close(whole)


def test_panels_need_axes_of_a_grid():
    axes = Figure().add_axes((0, 0, 1, 1))
    with pytest.raises(InputError, match="needs axes of a grid"):
        plots.scatter(kinds(samples=40), "work", axes=axes)


@pytest.mark.parametrize(
    ("ds", "included"),
    [
        (linear("morris", samples=8, replicates=2), {"morris-y"}),
        pytest.param(
            linear(samples=32),
            {"histogram-y", "quantiles-y", "scatter-y", "convergence-y", "inputs"},
            marks=pytest.mark.slow,
        ),
    ],
    ids=["one figure", "all figures"],
)
def test_the_same_result_gives_the_same_bytes(tmp_path, ds, included):
    once, again = (plots.save_all(Result(ds), tmp_path / name) for name in ("once", "again"))
    stems = {path.stem for path in once}
    assert included <= stems == files(ds)
    assert len(once) == 3 * len(stems)
    for one, other in zip(once, again, strict=True):
        assert one.read_bytes() == other.read_bytes()


def test_a_figure_is_drawn_once_for_each_of_its_files(tmp_path, monkeypatch):
    draw, drawn = Figure.draw, []
    monkeypatch.setattr(Figure, "draw", lambda *given: (drawn.append(given), draw(*given)))
    ds = linear("morris", samples=8, replicates=2)
    paths = plots.save_all(Result(ds), tmp_path)
    assert len(drawn) == len(paths) == 3 * len(files(ds))


@pytest.mark.parametrize(
    ("figure", "of"),
    [
        ("lifetime", ["life"]),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in (
                ("scatter", ["angle"]),
                ("pairs", []),
                ("inputs", []),
                ("quantile_table", ["work"]),
            )
        ),
    ],
)
def test_a_notebook_shows_figures_without_pyplot(figure, of):
    shown, _ = DisplayFormatter().format(getattr(plots, figure)(kinds(samples=40), *of))
    assert imread(io.BytesIO(shown["image/png"])).std() > 0.05


def test_categories_alone_have_the_indices_of_each():
    ds = kinds(analysis={"outputs": ["regime"]})
    assert list(sensitivities(ds)["outputs"]) == ["P(regime=slow)", "P(regime=fast)"]
    assert {"pairs", "first-order-P_regime_slow", "first-order-P_regime_fast"} <= files(ds)


@pytest.mark.slow
def test_categories_alone_are_drawn(tmp_path):
    ds = kinds(analysis={"outputs": ["regime"]})
    stems = {path.stem for path in plots.save_all(Result(ds), tmp_path)}
    assert stems == files(ds)


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="file: cannot create this folder"):
        plots.save_all(Result(linear()), tmp_path / "file")
