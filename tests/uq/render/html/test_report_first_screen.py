"""The first screen of a report has room for what to do, however tall its figure is."""

import numpy as np
from computed import asking, kinds, linear

from uq.render.html.page import page
from uq.result.result import Result


def test_a_tall_figure_leaves_room_for_what_to_do(browser, tmp_path):
    ds = kinds(samples=400)
    values = np.stack([ds["x1"].values, 2 * ds["x1"].values + ds["x2"].values], axis=1)
    attrs = {"role": "output", "kind": "value", "units": "m", "long_name": "worn depth"}
    ds = ds.assign_coords(instant=("instant", [1.0, 2.0], {"units": "h"}))
    ds = ds.assign(worn=(("row", "instant"), values, attrs | {"may_be_undefined": 0}))
    path = tmp_path / "tall.html"
    path.write_text(page(Result(asking(ds, outputs=["worn"])), "tall.nc"), encoding="utf-8")
    browser.open(path, width=1400, height=900)
    height = "document.querySelector('.first-screen figure svg').getBoundingClientRect().height"
    assert browser.value(height) <= 384


def test_the_page_says_why_there_is_no_bound_and_why_there_are_more_rows():
    crossed = linear("saltelli", samples=64, replicates=4, analysis={"outputs": ["y"]})
    shown = page(Result(crossed), "crossed.nc")
    assert "<li>No 95/95 bound: " in shown
    assert "512 runs in 1 536 rows" in shown.replace("\xa0", " ")
    event = linear("saltelli", samples=64, replicates=4, analysis={"thresholds": {"y": 5.0}})
    shown = page(Result(event), "crossed.nc").replace("\xa0", " ")
    assert "1 536 rows: 512 runs, copies with other values of some inputs" in shown
