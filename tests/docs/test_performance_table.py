"""The page on performance, and the figures of the README, are those that the benchmarks kept."""

from benchmarks import figures, table
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
