"""Categories are no numbers: shares instead of means, wherever a result is read."""

import json
import re

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import asking, compared, linear, summarised, with_status
from scipy import stats

from uq import compare, plots, summary
from uq.assess.findings import Findings
from uq.contract import Status
from uq.errors import InputError
from uq.files.whole_files import write_result
from uq.render.figures.catalogue import drawables
from uq.render.html.page import write_report
from uq.render.trace.trace import traced
from uq.result.result import Result
from uq.result.row_choice import lowest_row
from uq.study.installed_models import find_model
from uq.text.keys import key_of

LABELS = ("aperiodic", "1", "2", "3")


def with_period(samples=200, seed=0):
    """Return a result with a period of 0, 1 or 2 in each row."""
    ds = linear(samples=samples)
    codes = np.random.default_rng(seed).choice([0, 1, 2], samples, p=[0.2, 0.7, 0.1])
    attrs = {
        "role": "output",
        "kind": "category",
        "units": "1",
        "long_name": "period of the response",
        "may_be_undefined": 0,
        "flag_values": np.arange(-1, 4, dtype=np.int8),
        "flag_meanings": " ".join(("none", *LABELS)),
    }
    ds = ds.assign({"period": ("row", codes.astype(np.int8), attrs)})
    return asking(ds, outputs=["y", "period"]), codes


def test_a_period_is_a_category_whose_codes_are_periods():
    for machine in ("beam", "mole"):
        period = find_model(machine).outputs["period"]
        assert period.is_category
        assert all(int(label) == code for code, label in enumerate(period.categories) if code)


def test_a_summary_has_shares_and_no_moments():
    ds, codes = with_period()
    statistics = summarised(ds)
    assert set(statistics["outputs"]) == {"y"} and list(summary(ds).index) == ["y"]
    assert list(statistics["categories"]["period"]) == ["aperiodic", "1", "2"]  # those that occur
    share = statistics["categories"]["period"]["1"]
    hits = int((codes == 1).sum())
    assert (share["count"], share["share"]) == (hits, hits / 200)
    wilson = stats.binomtest(hits, 200).proportion_ci(method="wilson")
    assert (share["low"], share["high"]) == pytest.approx(tuple(wilson))
    assert statistics["regime"] == {} and summarised(linear())["categories"] == {}


def test_failed_rows_bound_a_share():
    ds, codes = with_period()
    ds["period"][:5] = -1
    share = summarised(with_status(ds, slice(5), Status.RAISED))["categories"]["period"]["1"]
    assert share["count"] == (codes[5:] == 1).sum() and share["failed_low"] < share["low"]


def test_each_number_has_a_key():
    ds, codes = with_period()
    traced_number = traced(Result(ds), "categories/period/1")
    assert traced_number.equal and traced_number.numbers["share"] == (codes == 1).mean()
    assert traced_number.estimators[0].does


def test_tables_report_and_figures_show_shares(uq, folder):
    ds, codes = with_period()
    write_result(ds, folder / "out.nc")
    shown = uq("summary", "out.nc", "--explain", "--full").out
    lines = [line.split() for line in shown[shown.index("\nperiod") :].splitlines()]
    assert lines[1] == ["period", "period", "of", "the", "response"]
    assert ["1", f"{(codes == 1).mean():.5g}"] in [line[:2] for line in lines]
    assert list(json.loads(uq("summary", "out.nc", "--json").out)["categories"]) == ["period"]
    write_report(folder / "out.nc", folder / "out.html")
    page = (folder / "out.html").read_text()
    (table,) = re.findall(r"<table>\s*<caption>Period, .*?</table>", page, re.DOTALL)
    assert [table.count(f'"categories/period/{label}/share"') for label in LABELS] == [1, 1, 1, 0]
    assert "P(period=1)" in uq("levels", "out.nc").out
    assert "period" not in uq("convergence", "out.nc").out


def test_two_studies_compare_shares():
    pair = [with_period(seed=seed) for seed in (0, 1)]
    period = compared(*(ds for ds, _ in pair))["categories"]["period"]
    assert list(period) == ["aperiodic", "1", "2"]
    shares = [(codes == 1).mean() for _, codes in pair]
    assert [period["1"][side]["share"] for side in "ab"] == shares
    assert period["1"]["difference"]["value"] == pytest.approx(shares[1] - shares[0])
    table = compare(*(ds for ds, _ in pair))
    assert table.loc[("period", "1"), "first"] == shares[0]


def test_indices_are_those_of_each_label():
    ds, _ = with_period(2000)
    outputs = sensitivities(ds, "regional", "period")["outputs"]
    assert list(outputs) == ["P(period=aperiodic)", "P(period=1)", "P(period=2)"]


@pytest.mark.parametrize("label", ["x[3].y", "x]y", "a/b", "x,y=1"])
def test_a_label_may_hold_what_separates_the_parts_of_a_name(label):
    ds, codes = with_period(2000)
    ds["period"].attrs["flag_meanings"] = " ".join(("none", LABELS[0], label, *LABELS[2:]))
    sites = ds.assign(period=(("row", "site"), codes[:, None].astype(np.int8), ds.period.attrs))
    for dataset, name in (
        (ds, "period"),
        (sites.assign_coords(site=["left"]), "period[site=left]"),
        (sites.assign_coords(site=["x[3].y"]), "period[site=x[3].y]"),
    ):
        target = f"P({name}={label})"
        assert list(sensitivities(dataset, "regional", target)["outputs"]) == [target]
        for key in (
            key_of("outputs", target, "S1", "x1", verb="sensitivity"),
            key_of("outputs", target, "variance", verb="levels"),
            key_of("categories", name, label, "share"),
        ):
            assert traced(Result(dataset), key).equal


def with_sites(samples=200):
    """Return a result with a period at each of two sites."""
    ds, codes = with_period(samples)
    both = np.column_stack([codes, codes[::-1]]).astype(np.int8)
    ds = ds.assign({"period": (("row", "site"), both, ds["period"].attrs)})
    return ds.assign_coords(site=["left", "right"]), both


def test_a_category_with_dimensions_has_shares_of_each_element(uq, folder):
    ds, both = with_sites()
    categories = summarised(ds)["categories"]
    assert list(categories) == ["period[site=left]", "period[site=right]"]
    for i, of in enumerate(categories.values()):
        assert of["1"]["share"] == (both[:, i] == 1).mean()
    traced_number = traced(Result(ds), "categories/period[site=left]/1")
    assert traced_number.equal and traced_number.numbers["share"] == (both[:, 0] == 1).mean()
    assert list(compared(ds, ds)["categories"]) == list(categories)
    indices = sensitivities(ds, "regional", "period[site=left]")["outputs"]
    assert list(indices) == [f"P(period[site=left]={label})" for label in LABELS[:3]]
    assert len(sensitivities(ds, "regional", "period")["outputs"]) == 6
    with pytest.raises(InputError, match=r"no such element 'period\[site=up\]'"):
        sensitivities(ds, "regional", "period[site=up]")
    write_result(ds, folder / "out.nc")
    assert "\nperiod[site=right]" in uq("summary", "out.nc", "--explain", "--full").out
    write_report(folder / "out.nc", folder / "out.html")
    page = (folder / "out.html").read_text()
    assert page.count("<caption>Period") == 2


def test_a_figure_shows_the_shares_of_each_label():
    ds, both = with_sites()
    for output, shown in (("period", 2), ("period[site=right]", 1)):
        (axes,) = plots.shares(ds, output).axes
        labels = [label.get_text() for label in axes.get_yticklabels()]
        assert labels == list(LABELS[:3]) and len(axes.patches) == 3 * shown
    left = [(both[:, 1] == code).mean() for code in range(3)]
    assert [bar.get_width() for bar in axes.patches] == pytest.approx(left)
    with pytest.raises(InputError, match="'y' is no category"):
        plots.shares(ds, "y")
    assert {"shares-period"} == {
        picture.file
        for picture in drawables({"shares": plots.FIGURES["shares"]}, Findings(Result(ds)))
    }


def test_it_has_no_thresholds_quantiles_or_lowest_row():
    ds, _ = with_period()
    with pytest.raises(InputError, match="'period' is a category, not a number"):
        lowest_row(Result(ds), "period")
