"""What a page says of chosen rows, in a real browser, against what Python finds for them."""

import numpy as np
import pytest
from computed import kinds, linear
from explored import cells, drag_handle, place_of_a_point, ranges

from uq.result.elements import elements_of

ASKED = {"thresholds": {"y": 6.0}}


DESIGNS = {
    "independent": {"samples": 400},
    "replicates": {"method": "sobol", "samples": 64, "replicates": 8},
    "one replicate": {"method": "sobol", "samples": 64},
    "units": {"samples": 130, "units": 3},
    "units and replicates": {"method": "sobol", "samples": 32, "replicates": 8, "repeats": 2},
}


@pytest.mark.parametrize("design", DESIGNS)
def test_a_brush_gives_what_python_finds_for_its_rows(shown, design):
    ds = linear(**DESIGNS[design], analysis=ASKED)
    browser = shown(ds)
    hits, x4 = ds["y"].values > 6.0, ds["x4"].values
    drag_handle(browser, "x4", 0, 200)
    drag_handle(browser, "x4", 1, 430)
    (low, high), *_ = ranges(browser)
    chosen = (x4 >= low) & (x4 <= high)
    assert 0 < chosen.sum() < len(x4)
    (among, *_), (everywhere, *_) = cells(browser)["y/6"]
    assert (among, everywhere) == (hits[chosen].mean(), hits.mean())
    for rows, (_, *ends) in zip((chosen, hits | True), cells(browser)["extremes"], strict=True):
        assert ends == [ds["y"].values[rows].min(), ds["y"].values[rows].max()]
    counts = "document.querySelector('tr[data-key=\\'y/6\\'] small').innerText"
    assert browser.value(counts) == f"{hits[chosen].sum()} of {chosen.sum()}"
    status = browser.value("document.querySelector('.status').textContent")
    assert status.startswith(f"{chosen.sum()} of {len(x4)} rows, chosen after the fact")


def test_a_brush_by_the_mouse_chooses_a_rectangle(shown):
    browser = shown(linear(samples=400, analysis=ASKED))
    x, y = place_of_a_point(browser)
    browser.drag((x + 20, y - 5), (x - 120, y + 90))
    browser.painted()
    (x_low, x_high), (y_low, y_high) = ranges(browser)
    ds = linear(samples=400, analysis=ASKED)
    x4, values = ds["x4"].values, ds["y"].values
    chosen = (x4 >= x_low) & (x4 <= x_high) & (values >= y_low) & (values <= y_high)
    assert chosen.sum() == browser.value("Number(document.querySelector('.status data').value)") > 0


def test_lives_that_never_end_or_are_censored_lie_beyond_the_brush(shown):
    ds = kinds(samples=400, analysis={"thresholds": {"life": 1.0}})
    browser = shown(ds)
    life, censored = ds["life"].values[:, 0, 0], ds["life_censored"].values[:, 0, 0] == 1
    present = ~np.isnan(life)
    drag_handle(browser, "life[side=left,depth=0.5]", 0, 1)
    (low, high) = ranges(browser)[1]
    count = "Number(document.querySelector('.status data').value)"
    assert (life[present] >= low).sum() == browser.value(count) and high == np.inf
    drag_handle(browser, "life[side=left,depth=0.5]", 1, 499)
    (low, high) = ranges(browser)[1]
    ended = present & ~censored & (life >= low) & (life <= high)
    assert ended.sum() == browser.value(count)


def test_rows_censored_before_a_time_leave_its_share_unknown(shown):
    ds = kinds(samples=400, analysis={"thresholds": {"life": [0.2, 1.4]}})
    displayed = cells(browser := shown(ds))
    element = next(elements_of(ds, ["life"]))
    for time in (0.2, 1.4):
        ((share, *_),) = displayed[f"{element.name}/{time:g}"]
        unknown = element.unknown_sides(time).sum()
        assert np.isnan(share) == (unknown > 0)
        if not unknown:
            assert share == element.below(time)[~element.failed].mean()
        else:
            assert f"{unknown} rows were censored" in browser.value("document.body.innerText")


def test_chips_leave_out_a_regime(shown):
    ds = kinds(samples=100)
    browser = shown(ds)
    browser.value(
        "[...document.querySelectorAll('.chip')].find(c => c.innerText.startsWith('fast')).click()"
    )
    shown_cells = cells(browser)
    assert shown_cells["regime/fast"][0][0] == 0 and shown_cells["regime/slow"][0][0] == 1
    slow = (ds["regime"].values == 0).sum()
    assert browser.value("Number(document.querySelector('.status data').value)") == slow
    browser.value("document.querySelector('.clear').click()")
    assert len(cells(browser)["regime/fast"]) == 1
