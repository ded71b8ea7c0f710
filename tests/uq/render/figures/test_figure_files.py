"""Figures as files, in a notebook, and in axes that are given."""

import io
import xml.etree.ElementTree as ElementTree

import matplotlib.pyplot as plt
import pytest
from asked_indices import sensitivities
from computed import kinds, linear
from IPython.core.formatters import DisplayFormatter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread

from uq import plots
from uq.assess.findings import Findings
from uq.errors import InputError
from uq.render.figures.catalogue import drawables
from uq.render.figures.figure import width_in_metres
from uq.result.result import Result


def files(ds):
    """Return the names of the files of all figures of a result."""
    return {picture.file for picture in drawables(plots.FIGURES, Findings(Result(ds)))}


FORMATS = ("png", "svg", "pdf")
PLACES = ("left", "center", "right")


def all_files(ds, folder, **options):
    """Write all figures of a result, and return their paths."""
    return plots.save_all(Result(ds), folder, every=True, formats=FORMATS, **options)


@pytest.mark.slow
def test_every_figure_of_a_study_is_written_as_png_svg_and_pdf(tmp_path):
    asked = {"outputs": ["life", "angle", "regime"], "thresholds": {"life": 1.0}}
    ds = kinds(samples=96, analysis=asked | {"sensitivity": ["pawn"]})
    paths = all_files(ds, tmp_path / "new" / "figures")
    assert {path.suffix for path in paths} == {".png", ".svg", ".pdf", ".csv", ".tex"}
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
        elif path.suffix == ".pdf":
            assert path.read_bytes().startswith(b"%PDF-")


@pytest.mark.parametrize("figure", ["histogram", "scatter", "regimes", "inputs"])
def test_figures_are_drawn_into_axes_that_are_given(figure):
    ds, (whole, (left, right)) = kinds(samples=40), plt.subplots(1, 2, layout="constrained")
    entry = plots.FIGURES[figure]
    names = [] if figure == "inputs" else ["work"]
    assert entry.draw(ds, *names, axes=right) is whole
    whole.draw_without_rendering()
    (alone,) = {len(entry.draw(ds, *names).axes)}
    drawn = [axes for axes in whole.axes if axes is not left and axes.axison]
    assert len(drawn) == alone
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
            {"histogram-y", "scatter-y", "convergence-y", "inputs"},
            marks=pytest.mark.slow,
        ),
    ],
    ids=["one figure", "all figures"],
)
def test_the_same_result_gives_the_same_bytes(tmp_path, ds, included):
    once, again = (all_files(ds, tmp_path / name) for name in ("once", "again"))
    stems = {path.stem for path in once if path.suffix in (".png", ".svg", ".pdf")}
    assert included <= stems == files(ds)
    for file, other in zip(once, again, strict=True):
        assert file.read_bytes() == other.read_bytes()


def test_a_figure_is_drawn_once_for_each_of_its_files(tmp_path, monkeypatch):
    draw, drawn = Figure.draw, []
    monkeypatch.setattr(Figure, "draw", lambda *given: (drawn.append(given), draw(*given)))
    ds = linear("morris", samples=8, replicates=2)
    paths = all_files(ds, tmp_path)
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
    stems = {path.stem for path in all_files(ds, tmp_path)}
    assert stems == files(ds)


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="file: cannot create this folder"):
        plots.save_all(Result(linear()), tmp_path / "file")


@pytest.fixture(scope="module")
def lives():
    """Return a result about a life, which also has angles and regimes."""
    asked = {"outputs": ["angle", "life", "work"], "thresholds": {"life": 1.0}}
    return Result(kinds(samples=96, analysis=asked))


def names(paths):
    """Return the names of files."""
    return [path.name for path in paths]


def test_by_default_a_few_figures_are_about_the_subject_of_the_study(lives, tmp_path):
    drawn = names(plots.save_all(lives, tmp_path))
    assert drawn[0] == "lifetime-life.png" and len(drawn) <= 10
    assert all(name.endswith(".png") for name in drawn)
    assert not any("work" in name or "convergence" in name for name in drawn)


def test_one_figure_is_drawn_by_its_kind_its_output_or_its_file_name(lives, tmp_path):
    kind = plots.save_all(lives, tmp_path, only=["histogram"])
    assert names(kind) == ["histogram-angle.png", "histogram-work.png"]
    file = plots.save_all(lives, tmp_path, only=["histogram-work"])
    assert names(file) == ["histogram-work.png"]
    both = plots.save_all(lives, tmp_path, only=["histogram"], outputs=["work"])
    assert names(both) == ["histogram-work.png"]
    about = names(plots.save_all(lives, tmp_path, outputs=["work"]))
    assert about[0] == "histogram-work.png" and "lifetime-life.png" not in about


def test_a_table_is_written_as_csv_and_latex(lives, tmp_path):
    csv, tex = plots.save_all(lives, tmp_path, only=["quantiles"], outputs=["angle"])
    assert csv.read_text().splitlines()[0].startswith("quantile,") and len(tex.read_text()) > 100
    assert r"50 \% & " in tex.read_text() and r"\bottomrule" in tex.read_text()


@pytest.mark.parametrize("width", ["84mm", "17.4 cm"])
def test_figures_have_the_width_asked_for(lives, width, tmp_path):
    metres = width_in_metres(width)
    (file,) = plots.save_all(lives, tmp_path, only=["scatter-life"], width=metres)
    assert imread(file).shape[1] == pytest.approx(200 * metres / 0.0254, abs=1)


def test_without_titles_nothing_stands_above_a_figure(lives, tmp_path, monkeypatch):
    drawn = {}
    monkeypatch.setattr(
        plots, "write", lambda figure, path, formats: drawn.update({path.name: figure}) or []
    )
    plots.save_all(lives, tmp_path, every=True, titles=False)
    kinds_drawn = {name.partition("-")[0] for name in drawn}
    assert kinds_drawn >= {"events", "shares", "lifetime", "regimes", "scatter", "convergence"}
    for figure in drawn.values():
        above = [axes.get_title(loc=place) for axes in figure.axes for place in PLACES]
        assert not any(text.strip() for text in (*above, figure.get_suptitle()))
        assert not figure.texts or figure.texts == [figure._suptitle]
    for name in ("convergence-life", "scatter-life", "scatter-work"):
        label = drawn[name].axes[0].yaxis.label
        assert label.get_visible() and "[" in label.get_text()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"only": ["histgram"]}, "no figure 'histgram'.*did you mean 'histogram'"),
        ({"only": ["histogram-wrk"]}, "did you mean 'histogram-work'"),
        ({"outputs": ["lfe"]}, "no output 'lfe' in this result; did you mean 'life'"),
        ({"formats": ["jpg"]}, "no format 'jpg'.*png, svg, pdf"),
        ({"only": ["lifetime"], "outputs": ["work"]}, "no such figure of work"),
    ],
)
def test_a_figure_that_does_not_exist_is_refused(lives, options, message, tmp_path):
    with pytest.raises(InputError, match=message):
        plots.save_all(lives, tmp_path / "new", **options)
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("text", ["84", "84 s", "wide", "1mm", "9 m"])
def test_a_width_that_is_none_is_refused(text):
    with pytest.raises(InputError, match="--width .* 50 to 500 mm with its unit, such as 84mm"):
        width_in_metres(text)


def test_a_full_disk_leaves_no_part_of_a_figure(lives, tmp_path, monkeypatch):
    def fails(figure, path, **options):
        path.write_bytes(b"part")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(FigureCanvasAgg, "print_png", fails)
    with pytest.raises(InputError, match="cannot write a figure: No space left on device"):
        plots.save_all(lives, tmp_path, only=["histogram-work"])
    assert not list(tmp_path.iterdir())
