"""The first screen of a report has room for what to do, however tall its figure is."""

import numpy as np
from computed import asking, kinds

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
