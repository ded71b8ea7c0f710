"""How the inputs of chosen rows differ from the others', in a real browser, against Python."""

import numpy as np
import pytest
from computed import UNIFORM, asking, linear, with_output
from explored import cells, drag_handle, ranges

from uq.result.result import Result
from uq.assess.earliest import inputs_apart, ranks
from uq.assess.independent_inputs import independent_inputs
from uq.result.elements import independent_rows, replicates_of
from uq.text.literals import toml

DESIGNS = {
    "independent": {"samples": 400},
    "replicates": {"method": "sobol", "samples": 64, "replicates": 8},
    "one replicate": {"method": "sobol", "samples": 64},
    "units": {"samples": 130, "units": 3},
}
LINES = """[...document.querySelectorAll('.inputs-apart tr[data-key]')].map(line => [
  line.dataset.key.replace('input/', ''),
  ...[...line.cells].slice(1).map(cell => Number(cell.querySelector('data').value)),
  ...['low', 'high'].map(end => Number(line.cells[3].dataset[end] ?? NaN))])"""


@pytest.mark.parametrize("design", DESIGNS)
def test_inputs_of_the_brushed_rows_are_those_of_python(shown, design):
    ds = linear(**DESIGNS[design])
    browser = shown(ds)
    assert browser.value("document.querySelector('.inputs-apart').checkVisibility()") is False
    drag_handle(browser, "y", 1, 150)  # the lowest
    _, (low, high) = ranges(browser)
    rows = independent_rows(ds)
    chosen = (rows["y"].values >= low) & (rows["y"].values <= high)
    columns = independent_inputs(Result(rows))
    found = browser.value(LINES.replace("NaN", "'NaN'"))
    found = {name: np.array(numbers, dtype=float) for name, *numbers in found}
    ranked = {name: ranks(values) for name, values in columns.items()}
    apart = inputs_apart(Result(rows), np.flatnonzero(chosen), ranked, replicates_of(rows))
    for name, (median, others, mean, *_) in found.items():
        assert median == pytest.approx(np.median(columns[name][chosen]), rel=1e-12)
        assert others == pytest.approx(np.median(columns[name][~chosen]), rel=1e-12)
        assert mean == pytest.approx(ranked[name][chosen].mean(), rel=1e-12)
    if apart is None:
        assert design == "one replicate" and np.isnan([one[3:] for one in found.values()]).all()
        return
    assert [one.name for one in apart] == list(found)[: len(apart)] and apart[0].name == "x4"
    for one in apart:
        assert found[one.name][3:] == pytest.approx((one.rank.low, one.rank.high), rel=1e-9)
    heads = "[...document.querySelectorAll('.inputs-apart th[scope=col]')].map(h => h.innerText)"
    assert f"{chosen.sum()} chosen" in browser.value(heads)
    assert f"{(~chosen).sum()} others" in browser.value(heads)


def test_an_input_whose_middle_is_chosen_says_so(shown):
    ds = linear(samples=400)
    ds = with_output(ds, "far", (ds["x2"].values - 0.5) ** 2 - ds["y"].values * 1e-9)
    browser = shown(asking(ds, outputs=["far"]))
    name = browser.value("[...document.querySelectorAll('.range')].at(-1).dataset.name")
    drag_handle(browser, name, 1, 100)
    first = "document.querySelector('.inputs-apart tr[data-key]')"
    assert browser.value(f"{first}.dataset.key") == "input/x2"
    assert "near the middle" in browser.value(f"{first}.innerText")


def test_of_many_inputs_those_that_differ_most_are_in_sight(shown):
    ds = linear(samples=400)
    names = [f"z{i}" for i in range(9)]
    laws = "".join(f"{name} = {toml(UNIFORM)}, " for name in names)
    study = ds.attrs["study"].replace("uncertain = {", f"uncertain = {{{laws}")
    for i, name in enumerate(names):
        values = np.random.default_rng(i).random(400)
        ds = ds.assign({name: ("sample", values, ds["x1"].attrs)})
    browser = shown(ds.assign_attrs(study=study))
    drag_handle(browser, "y", 1, 150)
    cells(browser)
    seen = (
        "[...document.querySelectorAll('.inputs-apart tr[data-key]')]"
        ".filter(l => l.checkVisibility()).map(l => l.dataset.key)"
    )
    assert len(browser.value(seen)) == 8 and browser.value(seen)[0] == "input/x4"
    assert browser.value("document.querySelector('#explore summary').innerText") == "5 more inputs"
    browser.value("document.querySelector('#explore summary').click()")
    browser.painted()
    assert len(browser.value(seen)) == 13
    drag_handle(browser, "y", 1, 300)
    assert len(browser.value(seen)) == 13  # remains open


def test_names_and_ranks_of_inputs_are_in_sight_on_a_phone(shown):
    ds = linear(samples=400)
    ds["x4"].attrs |= {"long_name": "wear coefficient of the surface", "units": "m2 N-1"}
    ds["x4"].values[:] = 1e-15 * (1 + 20 * ds["x4"].values)
    browser = shown(ds, width=375, height=800)
    drag_handle(browser, "y", 1, 150)
    box = "document.querySelector('.inputs-apart')"
    assert browser.value(f"{box}.scrollWidth <= {box}.parentElement.clientWidth")
