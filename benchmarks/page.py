"""Size and times of the report of many rows: ``python -m benchmarks.page``.

100,000 rows of 12 columns, of lives that scatter over decades. In Chromium: from the request to the
page drawn, a brush from the move of a handle to the page drawn, and the same for a tolerance.
"""

import tempfile
import time
from pathlib import Path

import numpy as np

from uq.render.html.page import page
from uq.result import result_file
from uq.result.result import Result
from uq.study import row_sampling
from uq.study.definition import study_from_text
from uq.study.evaluate import evaluate

ROWS = 100_000
REPEAT = 9
STUDY = f"""
[study]
name = "wear"
model = "exponential-wear"
[design]
method = "monte-carlo"
samples = {ROWS}
seed = 2026
[uncertain]
rate = {{distribution = "lognormal", median = 2e-9, sigma = 0.5}}
depth = {{distribution = "normal", mean = 2.5e-4, sd = 2.5e-5}}
[analysis]
thresholds = {{life = 86400.0}}
"""
MOVE = """(() => {{ const handle = document.querySelectorAll("{0} input[type=range]")[{1}];
  const began = performance.now();
  handle.value = {2};
  handle.dispatchEvent(new Event("input"));
  return new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(() =>
    drawn(performance.now() - began)))); }})()"""


def result():
    """Return a result of 2 inputs and 10 outputs."""
    study = study_from_text(STUDY)
    rows = row_sampling.row_block(study, 0, row_sampling.rows(study))
    chunk = evaluate(study.model, study.settings, rows.x, rows.seed)
    ds = result_file.build(study, rows, chunk.columns, chunk.status, {})
    rng = np.random.default_rng(0)
    for i in range(9):
        ds[f"more{i}"] = ds["life"].copy(data=ds["life"].values * rng.lognormal(size=ROWS))
    return ds


def moved(browser, selector, handle, steps):
    """Return the time from the move of a handle to the page drawn [ms]."""
    reply = browser.do(
        "Runtime.evaluate",
        expression=MOVE.format(selector, handle, steps),
        awaitPromise=True,
        returnByValue=True,
    )
    return reply["result"]["value"]


def main():
    """Print size and times."""
    from tests.support.pages.browser import tab

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / "page.html"
        began = time.perf_counter()
        path.write_text(page(Result(result()), "wear.nc"), encoding="utf-8")
        print(f"written in {time.perf_counter() - began:.1f} s, {path.stat().st_size / 1e6:.2f} MB")
        (folder / "browser").mkdir()
        with tab(folder / "browser") as browser:
            times = []
            for _ in range(REPEAT):
                began = time.perf_counter()
                browser.open(path)
                browser.painted()
                times.append(time.perf_counter() - began)
            print(f"opened and drawn in {np.median(times):.2f} s (best {min(times):.2f} s)")
            for name, action, steps in (
                ("#explorer", "a brush", range(20, 20 + REPEAT)),
                ("#tolerances", "a tolerance", [i % 2 for i in range(REPEAT)]),
            ):
                moves = [moved(browser, name, 0, step) for step in steps]
                print(f"{action} in {np.median(moves):.0f} ms (best {min(moves):.0f} ms)")


if __name__ == "__main__":
    main()
