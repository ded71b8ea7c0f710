"""The tables of ``uq summary`` and ``uq sensitivity``: each number on its line, none left out."""

import numpy as np
import pytest
from computed import asking, computed, linear, study_of, summarised, with_output, with_status
from limit_states import PARTS

from uq.contract import Status
from uq.files.whole_files import write_result
from uq.text.numbers import grouped


@pytest.fixture
def printed(uq, folder):
    """Return a function that shows a result: what stands behind each label."""

    def printed(verb, ds):
        write_result(ds, folder / "out.nc")
        options = ["--full"] if verb == "summary" else []
        ended = uq(verb, "out.nc", *options)
        assert (ended.code, ended.err) == (0, "")
        return [line.split("  ") for line in map(str.strip, ended.out.splitlines())]

    return printed


def cells(lines, label):
    row = next(line for line in lines if line[0].strip() == label)
    return [cell.strip() for cell in row[1:] if cell.strip()]


def test_a_summary_names_units_sides_and_rows_that_failed(printed):
    values = 3600.0 * np.r_[np.linspace(5, 15, 62), np.nan, np.nan]
    ds = with_output(linear(samples=64), "life", values, "lifetime")
    ds = with_status(ds, [62, 63], Status.RAISED)
    ds = asking(ds, outputs=["life"], thresholds={"life": [25200.0]})
    lines = printed("summary", ds)
    assert cells(lines, "life [hours]") == ["meaning of life"]
    sides = summarised(ds)["outputs"]["life"]["thresholds"]["25200.0"]
    assert cells(lines, "P(> 7 hours)")[0] == f"{sides['above']['value']:.5g}"
    assert cells(lines, "P(< 7 hours)")[0] == f"{sides['below']['value']:.5g}"
    assert cells(lines, "invalid") == ["2", "rows"] and cells(lines, "raised") == ["2"]
    assert cells(lines, "mean")[0] == "10" and not any("36000" in line for line in lines)


def test_an_angle_is_in_degrees_and_its_probability_of_the_magnitude(printed):
    ds = with_output(linear(samples=64), "psi", np.radians(np.linspace(-20, 20, 64)), "angle")
    ds["psi"].attrs["units"] = "rad"
    lines = printed("summary", asking(ds, outputs=["psi"], thresholds={"psi": np.radians(12)}))
    assert cells(lines, "psi [°]")
    assert float(cells(lines, "P(|psi| > 12°)")[0]) == pytest.approx(0.4, abs=0.03)
    ds["psi"][:16] = np.nan
    ds["psi"].attrs["may_be_undefined"] = 1
    lines = printed("summary", asking(ds, outputs=["psi"], thresholds={"psi": "12 degrees"}))
    assert cells(lines, "P(|psi| > 12°)")[-1] == "25.0 % undefined"


def test_a_reason_stands_below_the_table_and_once(printed):
    values = 3600.0 * np.r_[np.linspace(5, 15, 50), np.full(14, 6.0)]
    censored = np.arange(64) >= 50
    ds = with_output(linear(samples=64), "life", values, "lifetime", censored)
    ds = asking(ds, outputs=["life"], thresholds={"life": ["7 hours", "8 hours"]})
    lines = [" ".join(cell.strip() for cell in line if cell) for line in printed("summary", ds)]
    block = " ".join(lines[lines.index("life [hours] meaning of life") :])
    reason = "14 of 64 rows were censored before that time"
    assert block.count(reason) == 1 and f"P(< 8 hours): {reason}" in block


def test_tolerance_bounds_that_few_rows_cannot_give_say_how_many_can(printed):
    asked = {"coverage": 0.95, "confidence": 0.95}
    ends = ("lower", "upper")
    few, enough = (linear(samples=n, analysis={"tolerance": asked}) for n in (40, 100))
    lines = printed("summary", few)
    assert [cells(lines, f"tolerance, {end}") for end in ends] == [["needs 59 rows"]] * 2
    lines = printed("summary", enough)
    lower, upper = (float(cells(lines, f"tolerance, {end}")[0]) for end in ends)
    assert lower < float(cells(lines, "quantile 0.05")[0]) < 8 < upper


def test_indices_are_ranked_and_dropped_groups_counted(printed):
    ds = linear("saltelli", samples=64, replicates=4, settings={"fail_above": 0.99})
    lost = int(np.isnan(ds["y"].values.reshape(-1, 6)).any(axis=1).sum())
    assert lost > 0
    lines = printed("sensitivity", ds)
    rows = f"of {grouped(1536 - 6 * lost)} rows, {lost} groups dropped"
    assert cells(lines, "Sensitivity by sobol") == [rows]
    assert [line[0] for line in lines if line[0][:1] == "x"] == ["x4", "x3", "x2", "x1"]
    whole = printed("sensitivity", linear("saltelli", samples=16, replicates=4))
    assert cells(whole, "Sensitivity by sobol") == ["of 384 rows"]


def test_pairs_have_a_table_of_their_own_without_an_input_without_effect(printed):
    lines = printed("sensitivity", linear(samples=600, analysis={"sensitivity": ["hdmr"]}))
    labels = [line[0] for line in lines]
    assert labels.count("(an input without effect)") == 1
    assert labels.index("S2") > labels.index("(an input without effect)")
    assert {label for label in labels if "," in label} >= {"x1,x2", "x3,x4"}


def test_of_many_pairs_the_largest_are_printed_and_the_others_counted(printed):
    tables = {
        "study": {"name": "pulse", "model": "oscillator"},
        "design": {"method": "monte-carlo", "samples": 100, "seed": 3},
        "uncertain": PARTS,
        "analysis": {"sensitivity": ["chaos"]},
    }
    lines = printed("sensitivity", computed(study_of(tables, "limit_states:OSCILLATOR")))
    pairs = [line for line in lines if "," in line[0] and len(line) > 1]
    values = [float(line[1:][-2] or line[-1].split()[0]) for line in pairs]
    assert len(pairs) == 12 and values == sorted(values, reverse=True)
    assert any(line[0].startswith("3 more pairs, none above 0.0") for line in lines)
