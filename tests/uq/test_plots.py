import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from computed import asking, kinds, linear, with_output
from matplotlib.figure import Figure
from matplotlib.image import imread

from uq import plots
from uq.errors import InputError
from uq.figure import file_name, powers, sentence
from uq.index_plot import index_bars
from uq.indices import sensitivities


def words(figure):
    """Return everything that is written in a figure."""
    texts = [text.get_text() for text in figure.findobj(lambda artist: hasattr(artist, "get_text"))]
    return " ".join(" ".join(texts).split())


def test_every_figure_of_a_study_is_written_as_png_and_svg(tmp_path):
    asked = {"thresholds": {"life": 1.0}, "sensitivity": ["rbd-fast", "pawn"]}
    ds = kinds(samples=128, analysis=asked)
    paths = plots.save_all(ds, tmp_path / "new" / "figures")
    assert {path.suffix for path in paths} == {".png", ".svg"}
    stems = {path.stem for path in paths}
    assert {"histogram-work", "histogram-angle", "lifetime-life"} < stems
    assert {"rbd-fast-work_side_left", "rbd-fast-angle", "pawn-angle"} < stems
    assert any("regime" in stem and stem.startswith("pawn") for stem in stems)
    assert not any("rate" in stem for stem in stems)  # censored: no rate
    for path in paths:
        if path.suffix == ".png":
            assert 600 < imread(path).shape[1] < 800  # one column at 200 dots per inch
        else:
            assert ElementTree.parse(path).getroot().tag.endswith("svg")


def test_the_same_result_gives_the_same_bytes(tmp_path):
    ds = linear("saltelli", samples=16, replicates=4)
    once, again = (plots.save_all(ds, tmp_path / name) for name in ("once", "again"))
    assert len(once) == 6
    for one, other in zip(once, again, strict=True):
        assert one.read_bytes() == other.read_bytes()


def test_a_figure_is_drawn_once_for_each_of_its_files(tmp_path, monkeypatch):
    draw, drawn = Figure.draw, []
    monkeypatch.setattr(Figure, "draw", lambda *given: (drawn.append(given), draw(*given)))
    paths = plots.save_all(linear(samples=64), tmp_path)
    assert len(drawn) == len(paths) == 6


def test_categories_alone_have_the_indices_of_each(tmp_path):
    ds = kinds(analysis={"outputs": ["regime"]})
    assert list(sensitivities(ds)["outputs"]) == ["P(regime=slow)", "P(regime=fast)"]
    stems = {path.stem for path in plots.save_all(ds, tmp_path)}
    assert len(stems) == 2 and all(stem.startswith("rbd-fast-") for stem in stems)


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="file: cannot make this folder"):
        plots.save_all(linear(), tmp_path / "file")


def test_lifetime_figure_shows_share_band_and_what_never_ends():
    days = 86400.0
    values = np.r_[np.linspace(5, 15, 60) * days, np.full(20, np.inf)]
    ds = with_output(linear(samples=80), "life", values, "lifetime")
    figure = plots.lifetime(ds, "life")
    (axes,) = figure.axes
    assert axes.get_xlabel() == "Meaning of life [days]"
    assert "never: 25.0%" in words(figure) and "80 rows" in words(figure)
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


def test_elements_of_an_output_share_a_figure_and_are_told_apart():
    figure = plots.lifetime(kinds(samples=100), "life")
    lines = figure.axes[0].lines
    assert len({(line.get_color(), line.get_linestyle()) for line in lines}) == 4
    assert "left, depth 0.5, never" in words(figure)
    assert "censored" in words(figure)
    one = plots.lifetime(kinds(samples=100), "life[side=left,depth=0.5]")
    assert len(one.axes[0].lines) == 1


def test_histogram_shows_every_row_once():
    figure = plots.histogram(linear(samples=300), "y")
    (patch,) = figure.axes[0].patches
    counts, edges, _ = patch.get_data()
    assert sum(counts) == pytest.approx(1) and edges[0] < 2 < 8 < edges[-1]
    assert figure.axes[0].get_xlabel() == "Value of the function"
    both = plots.histogram(kinds(samples=100), "work")
    assert both.axes[0].get_xlabel() == "Work rate [W]" and "right" in words(both)
    assert "undefined" in words(plots.histogram(kinds(samples=100), "angle"))


def test_index_bars_show_values_intervals_and_full_names():
    ds = linear("saltelli", samples=64, replicates=4)
    figure = index_bars(ds, "y")
    (axes,) = figure.axes
    assert len(axes.patches) == 8 and len(axes.collections) == 2
    assert [label.get_text() for label in axes.get_yticklabels()] == [
        f"Independent input (x_{i})" for i in (1, 2, 3, 4)
    ]
    assert "Value of the function" in words(figure) and "95 % interval" in words(figure)
    plain = words(index_bars(linear(samples=128), "y", "pawn"))
    assert "play no part" in plain and "PAWN" in plain and "95 %" not in plain


def test_a_wide_interval_does_not_squeeze_the_bars():
    ds = linear("saltelli", 16, 2)
    rare = np.where(ds["y"].values > 8.3, 1000.0, ds["x2"].values)
    axes = index_bars(with_output(ds, "rare", rare), "rare").axes[0]
    assert max(patch.get_width() for patch in axes.patches) > 0.3
    low, high = axes.get_xlim()
    assert -0.25 <= low <= 0 and high <= 1.25


def test_titles_of_indices_are_in_words():
    ds = linear("saltelli", 32, 4)
    ds = with_output(ds, "life", 1440 * ds["y"].values, "lifetime")
    ds = asking(ds, outputs=["life"], thresholds={"life": [7200.0]})
    assert "Rate, 1/time: meaning of life" in words(index_bars(ds, "rate(life)"))
    assert "Whether it ends before 2 hours: meaning of life" in words(
        index_bars(ds, "P(life<7200.0)")
    )
    with pytest.raises(
        InputError, match=r"'life' stands for several; name one of: rate\(life\), P"
    ):
        index_bars(ds, "life")
    flat = with_output(ds, "flat", np.ones(ds.sizes["sample"]))
    with pytest.raises(InputError, match="flat: the same value"):
        index_bars(flat, "flat")


@pytest.mark.parametrize("value", [np.nan, np.inf, 3.0])
@pytest.mark.parametrize("kind", ["lifetime", "value"])
def test_degenerate_results_are_drawn_all_the_same(tmp_path, value, kind):
    ds = asking(with_output(linear(samples=64), "odd", np.full(64, value), kind), outputs=["odd"])
    assert len(plots.save_all(ds, tmp_path)) == 4


def test_words_and_units_of_axes():
    assert sentence("worn volume per work", "m2 N-1") == "Worn volume per work [m² N⁻¹]"
    assert sentence("a $price$") == r"A $price$"
    assert sentence("a pure number", "1") == "A pure number"
    assert powers("kg m-1") == "kg m⁻¹"
    assert file_name("sobol", "P(life[depth=0.1]<1e6)") == "sobol-P_life_depth_0.1_1e6"
