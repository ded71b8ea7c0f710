"""The page on performance, and the figures of the README, are those that the benchmarks kept."""

import numpy as np

from benchmarks import figures, ports, quick, table
from benchmarks.figures import Figure

KEPT = {
    "mole": [Figure("a", "scipy", 1234.0), Figure("b", "heyoka", 3.25)],
    "startup": [Figure("c", "an import", 1.5, longer=True)],
}


def test_the_readme_shows_three_figures_of_the_page():
    shown = table.README.read_text().split(table.BEGIN)[1].split(table.END)[0]
    rows = shown.strip().splitlines()[2:]
    assert len(rows) == 3
    assert set(rows) <= set(table.PAGE.read_text().splitlines())


def test_a_benchmark_replaces_its_own_figures_alone(folder, monkeypatch):
    monkeypatch.setattr(figures, "FOLDER", folder / "kept")
    for name, new_figures in KEPT.items():
        figures.keep(name, [Figure("old", "peer", 1.0)])
        figures.keep(name, new_figures)
    assert {benchmark.benchmark: benchmark.figures for benchmark in figures.kept()} == KEPT
    page = table.page(figures.kept())
    assert "| b | heyoka | 3.25 times as fast |" in page
    assert "| c | an import | 1.5 times as long |" in page
    assert figures.machine() in page
    readme = f"before {table.BEGIN} old {table.END} after"
    marked = table.marked(readme, figures.kept())
    assert "heyoka" in marked and "scipy" not in marked and "old" not in marked
    assert marked.startswith("before ") and marked.endswith(" after")
    assert table.marked(marked, figures.kept()) == marked


def test_every_benchmark_with_figures_belongs_to_make_bench():
    bench = (table.HOUSE / "Makefile").read_text()
    using = [
        path.stem for path in table.HOUSE.glob("benchmarks/*.py") if "keep(" in path.read_text()
    ]
    assert len(using) > 5
    for name in {*using, "table"} - {"figures"}:
        assert f"benchmarks.{name}\n" in bench


def test_what_takes_longer_than_what_was_kept_is_named(capsys):
    kept = {"lives": 10.0, "rates": 10.0, "gone": 1.0}
    slower = quick.report({"lives": 10.9, "rates": 11.2, "new": 5.0}, kept)
    assert slower == ["rates"]
    assert "+12%" in capsys.readouterr().out


def test_operations_are_counted_by_kind_of_unit():
    w = ports.Memory(np.array([2.0, 3.0, 0.0]))
    ports.Number.done.clear()
    x, y = w[0], w[1]
    w[2] = ports.counted_fma(x, y, 1.0) / (x - y if x < y else 1.0)
    assert w.array[2] == -7.0
    assert ports.Number.done == {"loads": 2, "stores": 1, "fused": 1, "sums": 2, "quotients": 1}
    limit = ports.limits({"fused": 24, "sums": 8, "loads": 16}, ports.PROCESSORS["Intel"])
    assert limit == {"fused": 2.0, "loads": 1.0}
