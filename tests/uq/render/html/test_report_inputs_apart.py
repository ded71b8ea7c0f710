"""How the inputs of chosen rows differ from the others', in a real browser, against Python."""

import numpy as np
import pytest
from computed import UNIFORM, asking, linear, with_output
from explored import cells, drag_handle, ranges

from uq.assess.row_inputs import independent_inputs
from uq.result.elements import independent_rows
from uq.result.result import Result
from uq.text.literals import toml

DESIGNS = {
    "independent": {"samples": 400},
    "replicates": {"method": "sobol", "samples": 64, "replicates": 8},
    "one replicate": {"method": "sobol", "samples": 64},
    "units": {"samples": 130, "units": 3},
}
LINES = """[...document.querySelectorAll('.quarters tr[data-key]')].map(line => [
  line.dataset.key.replace('input/', ''),
  [...line.cells].slice(1).map(cell => Number(cell.querySelector('data').value))])"""


@pytest.mark.parametrize("design", DESIGNS)
def test_chosen_rows_are_counted_in_quarters_of_all(shown, design):
    ds = linear(**DESIGNS[design])
    browser = shown(ds)
    assert browser.value("document.querySelector('.quarters').checkVisibility()") is False
    drag_handle(browser, "y", 1, 150)  # the lowest
    _, (low, high) = ranges(browser)
    rows = independent_rows(ds)
    chosen = (rows["y"].values >= low) & (rows["y"].values <= high)
    columns = independent_inputs(Result(rows))
    lines = browser.value(LINES)
    assert [name for name, _ in lines][0] == "x4" and len(lines) == len(columns)
    for name, shares in lines:
        quarter = np.searchsorted(np.quantile(columns[name], (0.25, 0.5, 0.75)), columns[name])
        expected = [(quarter[chosen] == place).mean() for place in range(4)]
        assert shares == pytest.approx(expected, rel=1e-12)
        assert sum(shares) == pytest.approx(1)


def test_an_input_whose_middle_is_chosen_says_so(shown):
    ds = linear(samples=400)
    ds = with_output(ds, "far", (ds["x2"].values - 0.5) ** 2 - ds["y"].values * 1e-9)
    browser = shown(asking(ds, outputs=["far"]))
    name = browser.value(
        "[...document.querySelectorAll('.range:not([hidden])')].at(-1).dataset.name"
    )
    drag_handle(browser, name, 1, 100)
    name, (first, second, third, last) = browser.value(LINES)[0]
    assert name == "x2" and second + third > 0.9 > 0.1 > first + last


def test_of_many_inputs_those_that_differ_most_are_in_sight(shown):
    ds = linear(samples=400)
    names = [f"z{i}" for i in range(9)]
    laws = "".join(f"{name} = {toml(UNIFORM)}, " for name in names)
    study = ds.attrs["study"].replace("uncertain = {", f"uncertain = {{{laws}")
    for i, name in enumerate(names):
        values = np.random.default_rng(i).random(400)
        ds = ds.assign({name: ("row", values, ds["x1"].attrs)})
    browser = shown(ds.assign_attrs(study=study))
    drag_handle(browser, "y", 1, 150)
    cells(browser)
    box = "document.querySelector('.by-quarters .wide')"
    lines = f"[...{box}.querySelectorAll('tr[data-key]')]"
    bottom = f"{box}.getBoundingClientRect().bottom"
    seen = f"{lines}.filter(line => line.getBoundingClientRect().bottom <= {bottom})"
    keys = browser.value(f"{seen}.map(line => line.dataset.key)")
    assert keys[0] == "input/x4" and 5 <= len(keys) < browser.value(f"{lines}.length") == 13
    browser.value(f"{box}.scrollTo(0, 1e4)")
    browser.painted()
    assert browser.value(f"{seen}.length") == 13


def test_names_and_ranks_of_inputs_are_in_sight_on_a_phone(shown):
    ds = linear(samples=400)
    ds["x4"].attrs |= {"long_name": "wear coefficient of the surface", "units": "m2 N-1"}
    ds["x4"].values[:] = 1e-15 * (1 + 20 * ds["x4"].values)
    browser = shown(ds, width=375, height=800)
    drag_handle(browser, "y", 1, 150)
    box = "document.querySelector('.quarters')"
    assert browser.value(f"{box}.scrollWidth <= {box}.parentElement.clientWidth")
