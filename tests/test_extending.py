"""What is added from outside by one entry of a table appears everywhere it should."""

import json
from pathlib import Path
from typing import Literal

import generated
import numpy as np
import pytest
import scipy
from computed import kinds, linear

from uq import open_result, plots, sensitivity, summary
from uq.assess.statistic import Statistic, placed
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import summarise
from uq.assess.summary_facts import summary_facts
from uq.indices.index import IndexKind, Indices
from uq.indices.method import SensitivityMethod
from uq.indices.methods import METHODS
from uq.render.figures import subjects
from uq.render.figures.catalogue import Entry
from uq.render.figures.panel import column, finish
from uq.render.html.page import page
from uq.result.result import Result
from uq.sampling.designs import DESIGNS, Design
from uq.sampling.law import Law, Positive
from uq.sampling.laws import LAWS
from uq.sampling.unit_cube import monte_carlo
from uq.stats.estimate import Estimate
from uq.study.schema import json_schema

HOUSE = Path(__file__).parents[1]

# A figure


def rows_in_order(ds, output, *, axes=None):
    """Draw the values of an output as the rows came in."""
    (panel,) = column(axes, 2.0)
    panel.plot(ds[output].values.reshape(ds.sizes["row"], -1)[:, 0], ".")
    panel.set_xlabel("Row")
    return finish(panel)


@pytest.fixture
def toy_figure(no_other_figures, monkeypatch):
    entry = Entry(rows_in_order, subjects.outputs, "{what} row by row")
    monkeypatch.setitem(plots.FIGURES, "rows-in-order", entry)


def test_a_figure_is_drawn_reported_and_documented(toy_figure, tmp_path):
    ds = kinds(samples=32, analysis={"outputs": ["work", "life"]})
    stems = {path.stem for path in plots.save_all(Result(ds), tmp_path)}
    assert {"rows-in-order-work", "rows-in-order-life"} == stems
    text = page(Result(ds), "toy.nc")
    for output in ("work", "life"):
        meaning = ds[output].long_name
        assert f'aria-label="{meaning[:1].upper()}{meaning[1:]} row by row"' in text
    assert "| `rows-in-order` | each output with numbers |" in generated.figures()
    assert "the values of an output as the rows came in" in generated.figures()


# A design, and a sensitivity method


def mirrored(seed, replicates, d, samples, start, stop):
    """Draw every second point opposite to the one before."""
    first, last = start - start % 2, stop + stop % 2
    points = monte_carlo(seed, replicates, d, samples, first, last)
    points[1::2] = 1 - points[::2]
    return points[start - first : stop - first]


@pytest.fixture
def toy_design(monkeypatch):
    monkeypatch.setitem(DESIGNS, "mirrored", Design("pairs of opposite points", mirrored))


R2 = IndexKind("R2", "squared correlation (R2)", "variance")


def squared_correlation(sample):
    r = {name: np.corrcoef(x, sample.values)[0, 1] for name, x in sample.inputs.items()}
    return Indices({R2: {name: Estimate(estimate**2, 0.0, 1.0) for name, estimate in r.items()}})


@pytest.fixture
def toy_method(monkeypatch):
    method = SensitivityMethod(
        "how well a straight line fits",
        DESIGNS["monte-carlo"].layout,
        squared_correlation,
        (R2,),
        source="Pearson (1895)",
        intervals="from 0 to 1",
    )
    monkeypatch.setitem(METHODS, "correlation", method)


def asking(write_study, design, method):
    return write_study(
        "linear",
        design,
        uncertain=("x1", "x2", "x3", "x4"),
        more=f'[analysis]\nsensitivity = ["{method}"]',
    )


def offered(design):
    """Return the sensitivity methods that the schema offers an editor for a design."""
    for rule in json_schema()["allOf"]:
        named = rule["if"]["properties"].get("design", {}).get("properties")
        if named == {"method": {"const": design}}:
            asked = rule["then"]["properties"]["analysis"]["properties"]["sensitivity"]
    return asked["items"]["enum"]


def test_a_design_is_accepted_explained_and_documented(toy_design, uq, write_study):
    table = json_schema()["definitions"]["DesignTable"]["properties"]
    assert "mirrored" in table["method"]["enum"]
    assert offered("mirrored") == offered("monte-carlo")
    assert "# mirrored: pairs of opposite points\n" in uq("init", "linear").out
    checked = uq("check", asking(write_study, "mirrored", "rbd-fast")).out
    assert "mirrored: pairs of opposite points" in " ".join(checked.split())
    refused = uq("check", asking(write_study, "mirrored", "sobol"))
    assert "'mirrored' feeds 'first-order' or" in refused.err
    assert '| `"mirrored"` | pairs of opposite points | yes | first-order' in generated.designs()
    assert "`mirrored`" in generated.questions() and "`mirrored`" in generated.confidence()


def test_a_sensitivity_method_is_accepted_explained_and_documented(toy_method, uq, write_study):
    table = json_schema()["definitions"]["AnalysisTable"]["properties"]
    assert "correlation" in table["sensitivity"]["items"]["enum"]
    assert "correlation" in offered("halton") and "correlation" not in offered("saltelli")
    assert "correlation" in uq("check", asking(write_study, "halton", "correlation")).out
    refused = uq("check", asking(write_study, "saltelli", "correlation"))
    assert refused.code == 2 and "method = 'monte-carlo' or 'latin-hypercube' or" in refused.err
    misspelt = uq("check", asking(write_study, "halton", "corelation"))
    assert "did you mean 'correlation'?" in misspelt.err
    assert "correlation" in generated.designs()
    assert "| `correlation` | squared correlation (R2) | Pearson (1895) |" in generated.methods()
    assert "| how well a straight line fits | `correlation` | a plain" in generated.questions()


def test_a_study_of_both_is_run_and_shown(
    toy_design, toy_method, no_other_figures, uq, write_study
):
    path = asking(write_study, "mirrored", "correlation")
    ended = uq("run", path, "-o", "out.nc", "--workers", "0", "--chunk-rows", "7")
    assert ended.code == 0 and "64 runs, 0 invalid" in ended.out and "mirrored" in ended.out
    ds = open_result("out.nc")
    np.testing.assert_allclose(ds["x1"][1::2], 1 - ds["x1"][::2])
    values = sensitivity(ds)["R2"].sel(output="y").values
    assert values == pytest.approx(np.arange(1, 5) ** 2 / 30, abs=0.2)
    document = json.loads(uq("sensitivity", "out.nc", "--json").out)
    assert document["method"] == "correlation"
    assert [estimate["value"] for estimate in document["outputs"]["y"]["R2"].values()] == list(
        values
    )
    assert f"x4  {values[3]:.3f}  0.000 to 1.000" in uq("sensitivity", "out.nc").out
    text = page(Result(ds), "out.nc")
    assert "mirrored: pairs of opposite points" in text
    assert "squared correlation (R2)" in text and f"{values[3]:.3f}" in text


# A statistic


@placed(absent="null")
def _geometric_mean(element, context):
    """Yield exp(mean(log)) of an output whose values are all positive.

    References
    ----------
    D. McAlister, "The law of the geometric mean", Proc. R. Soc. 29, 367-376 (1879).
    """
    if (element.at_least > 0).all():
        logarithms = np.log(element.at_least)
        reach = 1.96 * logarithms.std() / np.sqrt(len(logarithms))
        value = logarithms.mean()
        estimate = Estimate(*np.exp([value, value - reach, value + reach]).tolist())
        yield Statistic(("geometric_mean",), "geometric mean", estimate, element.units)


def test_a_statistic_is_one_entry_of_a_table(no_other_figures, uq, write_study, monkeypatch):
    monkeypatch.setitem(STATISTICS, "geometric_mean", _geometric_mean)
    for name, seed in (("one", 1), ("other", 2)):
        assert uq("run", write_study("linear", seed=seed), "-o", f"{name}.nc").code == 0

    entry = json.loads(uq("summary", "one.nc", "--json").out)["outputs"]["y"]["geometric_mean"]
    assert entry["low"] < entry["value"] < entry["high"]
    (line,) = (
        x
        for x in uq("summary", "one.nc", "--explain", "--full").out.splitlines()
        if "geometric mean" in x
    )
    assert f"{entry['value']:.5g}" in line and f"{entry['low']:.5g}" in line
    table = summary(open_result("one.nc"))
    assert table.loc["y", "geometric mean"] == pytest.approx(entry["value"])
    assert table.loc["y", "geometric mean_high"] == pytest.approx(entry["high"])

    compared = json.loads(uq("compare", "one.nc", "other.nc", "--json").out)
    pair = compared["outputs"]["y"]["geometric_mean"]
    assert pair["a"] == entry
    apart = pair["difference"]
    assert apart["low"] < apart["value"] == pytest.approx(pair["b"]["value"] - entry["value"])
    assert "geometric mean" in uq("compare", "one.nc", "other.nc").out

    report = page(Result(open_result("one.nc")), "one.nc")
    assert f">{entry['value']:.5g}<" in report
    assert 'data-trace="outputs/y/geometric_mean"' in report
    traced = json.loads(uq("trace", "one.nc", "outputs/y/geometric_mean", "--json").out)
    assert traced["equal"] is True and traced["value"] == entry["value"]
    (estimator,) = traced["estimators"]
    assert estimator["does"] == "Yield exp(mean(log)) of an output whose values are all positive"
    assert estimator["sources"][0].startswith("D. McAlister")
    assert "| `geometric_mean` | exp(mean(log)) of an output" in generated.statistics()


def test_a_statistic_states_what_json_has_where_it_does_not_apply(monkeypatch):
    monkeypatch.setitem(STATISTICS, "geometric_mean", _geometric_mean)
    negative = linear(samples=32).assign(y=lambda ds: ds["y"] - 10)
    output = summary_facts(summarise(Result(negative))).json["outputs"]["y"]
    assert output["geometric_mean"] is None
    assert [*output][:3] == ["units", "mean", "mean_interval"]
    assert [*output][-1] == "geometric_mean"


def test_the_digits_of_a_new_statistic_show_a_small_scatter(monkeypatch):
    monkeypatch.setitem(STATISTICS, "geometric_mean", _geometric_mean)
    narrow = linear(samples=32).assign(y=lambda ds: 1000 + 1e-5 * ds["y"])
    described = summarise(Result(narrow)).outputs["y"]
    mean, geometric = described.find("mean"), described.find("geometric_mean")
    assert mean is not None and geometric is not None
    assert mean.words() == geometric.words() != "1000"


# A law


class Rayleigh(Law):
    """Length of a plane vector whose parts are Gaussian."""

    distribution: Literal["rayleigh"]
    mode: Positive

    def frozen(self):
        return scipy.stats.rayleigh(scale=self.mode)


def test_a_law_is_accepted_drawn_shown_and_documented(
    no_other_figures, uq, write_study, monkeypatch
):
    monkeypatch.setitem(LAWS, "rayleigh", Rayleigh)
    laws = json_schema()["definitions"]
    assert {"$ref": "#/definitions/Rayleigh"} in laws["Law"]["oneOf"]
    assert set(laws["Rayleigh"]["required"]) == {"distribution", "mode"}
    assert "# rayleigh: mode\n" in uq("init", "linear").out
    assert '| `"rayleigh"` | `mode` | Length of a plane vector' in generated.laws()

    def study(law):
        return write_study("linear", uncertain=("x1",), samples=2000, law=law)

    stated = 'distribution = "rayleigh", mode = 0.1'
    assert "rayleigh(mode = 0.1)" in uq("check", study(stated)).out
    assert "no such argument of x1's law" in uq("check", study(stated + ", sd = 1.0")).err
    assert "[uncertain.x1] mode: is missing" in uq("check", study('distribution = "rayleigh"')).err
    misspelt = uq("check", study('distribution = "raleigh", mode = 0.1'))
    assert "did you mean 'rayleigh'?" in misspelt.err
    outside = uq("check", study('distribution = "rayleigh", mode = 0.5'))
    assert "outside the parameter's bounds" in outside.err

    assert uq("run", study(stated), "-o", "out.nc", "--workers", "0").code == 0
    ds = open_result("out.nc")
    assert float((ds["x1"] < 0.1).mean()) == pytest.approx(1 - np.exp(-0.5), abs=0.04)
    assert "rayleigh: mode 0.1" in page(Result(ds), "out.nc")
    assert plots.inputs(ds).axes
