"""What a share is called that is due to a correlation alone."""

from computed import with_output
from dependent_studies import entry_of, weighted

import uq
from uq import plots
from uq.assess import sensitivities as module
from uq.assess.answer.rankings import ranking_of
from uq.assess.findings import Findings
from uq.cli.sensitivity import show
from uq.render.html.indices import sensitivity_of
from uq.result.result import Result


def test_an_input_without_an_effect_of_its_own_is_named():
    entry = entry_of(weighted(0.9))
    assert entry["by_correlation"] == ["x4"]
    assert entry["notes"][0].startswith("x4 does not change the output by itself in any of ")
    assert entry["notes"][0].endswith("its share is due to its correlation with x1")
    assert "by_correlation" not in entry_of(weighted(0.0))


def test_an_input_that_changes_the_output_now_and_then_is_not_called_without_effect():
    ds = weighted(0.9)
    x2, x4 = ds["x2"].values, ds["x4"].values
    y = ds["weighted"].values + 0.1 * (x4 > 1.5) * x2
    assert "by_correlation" not in entry_of(with_output(ds, "weighted", y))


def test_few_paths_do_not_show_that_an_input_has_no_effect():
    assert "by_correlation" not in entry_of(weighted(0.9, 32))


def test_the_remark_stands_beside_the_bar_in_table_figure_and_report(capsys):
    ds = weighted(0.9)
    show(Result(ds), module.sensitivities(Result(ds)))
    shown = capsys.readouterr().out.splitlines()
    line = next(table_line for table_line in shown if table_line.startswith("  x4 "))
    assert line.endswith("by correlation alone")
    labels = [
        label.get_text() for label in plots.index_bars(ds, "weighted").axes[0].get_yticklabels()
    ]
    assert ["by correlation alone" in label for label in labels] == [
        "x_{4}" in text for text in labels
    ]
    ((_, subjects),) = sensitivity_of(Findings(Result(ds))).values()
    beside = {row[0].text: row[0].more for row in subjects[0].tables[0].rows}
    assert beside == {"x1": "", "x2": "", "x3": "", "x4": "by correlation alone"}
    assert uq.sensitivity(ds)["by_correlation"].values.tolist() == [[False, False, False, True]]


def test_the_answer_does_not_count_a_share_by_correlation_as_a_contribution():
    # x4 is correlated with the only input that the model uses.
    ds = weighted(0.9)
    y = ds["x1"].values + 0.01 * ds["x2"].values
    ranking = ranking_of(
        Findings(Result(with_output(ds, "weighted", y))), "weighted", "shapley", ("", "")
    )
    assert [contribution.inputs for contribution in ranking.contributions] == [("x1",)]
