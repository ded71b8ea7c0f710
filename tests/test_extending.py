"""What is added from outside by one entry of a table appears everywhere it should."""

import sys
from pathlib import Path

import pytest

HOUSE = Path(__file__).parents[1]
sys.path[:0] = [str(HOUSE / "docs"), str(HOUSE / "tests" / "uq")]

import generated  # noqa: E402
from computed import kinds  # noqa: E402

from uq import plots  # noqa: E402
from uq.drawing import subjects  # noqa: E402
from uq.drawing.catalogue import Entry  # noqa: E402
from uq.drawing.panel import column, figure_of  # noqa: E402
from uq.report import page  # noqa: E402


def rows_in_order(ds, output, *, axes=None):
    """Draw the values of an output as the rows came in."""
    (panel,) = column(axes, 2.0)
    panel.plot(ds[output].values.reshape(ds.sizes["sample"], -1)[:, 0], ".")
    panel.set_xlabel("Row")
    return figure_of(panel)


@pytest.fixture
def toy_figure(monkeypatch):
    entry = Entry(rows_in_order, subjects.outputs, "{name} row by row: {meaning}")
    monkeypatch.setitem(plots.FIGURES, "rows-in-order", entry)


def test_a_figure_is_drawn_reported_and_documented(toy_figure, tmp_path):
    ds = kinds(samples=32, analysis={"outputs": ["work", "life"]})
    stems = {path.stem for path in plots.save_all(ds, tmp_path)}
    assert {"rows-in-order-work", "rows-in-order-life"} < stems
    text = page(ds, "toy.nc")
    for output in ("work", "life"):
        assert f"<figcaption>{output} row by row: {ds[output].long_name}</figcaption>" in text
    assert "| `rows-in-order` | each output with numbers |" in generated.figures()
    assert "the values of an output as the rows came in" in generated.figures()
