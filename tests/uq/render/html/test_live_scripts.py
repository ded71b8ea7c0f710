"""What the scripts of a page write and count, one by one, against Python."""

import json

import numpy as np
import pytest
from computed import linear
from report_scripts import scripts

from uq.assess.findings import Findings
from uq.render.html.embedded_columns import axis_of, common_digits, encoded
from uq.render.html.embedded_rows import rows_inside
from uq.result.result import Result


@pytest.fixture(scope="module")
def asked(browser, tmp_path_factory):
    """Return a function that evaluates an expression with the scripts of a page."""
    path = tmp_path_factory.mktemp("scripts") / "scripts.html"
    path.write_text(f"<meta charset=utf-8><script>{scripts()}</script>", encoding="utf-8")
    browser.open(path)
    assert browser.complaints() == []
    return browser.value


VALUES = [
    [1e6, 1e6 + 4e-4, 1e6 + 1e-3],
    [1e-200, 1.0, 1e200],
    [3.0, 3.0],
    [1e16, 1e16 + 4],
    [0.0, 5e-324],
    [-1e308, 1e308],
]


@pytest.mark.parametrize("values", VALUES, ids=str)
def test_different_values_are_written_differently(asked, values):
    axis = axis_of(np.array(values), 1.0)
    plain = {"values": encoded(values, "<f8"), "per": 1, "after": " m"}
    column = f"new Column({json.dumps(plain | {'common': common_digits(axis)})})"
    ticks = asked(f"{json.dumps(axis['ticks'])}.map(value => {column}.digits(value))")
    words = asked(f"{json.dumps(values)}.map(value => {column}.words(value))")
    assert len(set(words)) == len(set(values))
    assert 2 <= len(ticks) == len(set(ticks)) < 12


@pytest.mark.parametrize("half", [0.4986, 0.5, 0.94, 1.7, 9.99, 40.0])
@pytest.mark.parametrize("per", [1e-3, 1.0, 3600.0])
def test_an_axis_has_some_round_ticks(half, per):
    axis = axis_of(np.array([-half * per, half * per]), per)
    ticks = np.array(axis["ticks"]) / per
    assert 3 <= len(ticks) <= 8 and 0.0 in np.round(ticks, 12)
    assert all(len(f"{abs(tick):.4g}") <= 4 for tick in ticks)


def test_a_logarithmic_axis_has_round_ticks():
    axis = axis_of(np.geomspace(0.07, 58.0, 50), 1.0)
    assert axis["wide"] and axis["ticks"] == pytest.approx([0.1, 0.3, 1.0, 3.0, 10.0, 30.0])


def test_shares_above_values_are_counted(asked):
    rng = np.random.default_rng(0)
    values, weights = rng.lognormal(size=300), rng.random(300)
    axis = axis_of(values, 1.0)
    plain = json.dumps({"values": encoded(values, "<f8"), "axis": axis})
    column = f"const column = new Column({plain});"
    curve = asked(
        f"(() => {{ {column} return sharesAbove(column, new Scale(column),"
        f" {json.dumps(weights.tolist())}) }})()"
    )
    for at, share in list(zip(curve["at"], curve["share"], strict=True))[1:-1]:
        assert share == pytest.approx(np.average(values > at, weights=weights), abs=1e-9)
    assert curve["share"][-1] == 0 and len(curve["at"]) == 201


def test_a_curve_ends_where_rows_are_censored(asked):
    values, states = np.arange(1.0, 11.0), np.zeros(10)
    states[6], states[9] = 1, 2  # censored at 7; one that never ends
    values[9] = np.inf
    plain = {"values": encoded(values, "<f8"), "states": encoded(states, "u1")}
    plain["axis"] = axis_of(values[:9], 1.0)
    curve = asked(
        f"(() => {{ const column = new Column({json.dumps(plain)});"
        " return sharesAbove(column, new Scale(column), new Float64Array(10).fill(1)) })()"
    )
    assert 6.9 < curve["at"][-1] < 7.0 and curve["share"][-1] == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("unit", "words"), [("rad", "3\u00b0"), ("1", "3"), ("N", "3 N"), ("kg", "3 kg")]
)
def test_units_stand_beside_numbers(asked, unit, words):
    ds = linear(samples=20)
    ds["y"].attrs["units"] = unit
    column = rows_inside(Findings(Result(ds)), "a.nc")["columns"][-1]
    plain = {"values": "", "per": 1, "common": 0, "after": column["after"]}
    assert asked(f"new Column({json.dumps(plain)}).words(3)") == words
