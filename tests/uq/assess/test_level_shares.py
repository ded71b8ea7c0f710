"""Shares of the variance by level: values, what cannot be told apart, and every reader."""

import numpy as np
import pytest
from command_line import strict_json
from computed import asking, computed, with_output
from nested_studies import CHANCE, LEVELS, OWN, SHARED, VARIANCES, nested, nested_result
from noisy_studies import noisy

import uq as api
from uq.assess.components_by_level import by_level
from uq.errors import InputError
from uq.result.result import Result
from uq.result.variables import error_name


def test_shares_of_the_linear_function():
    ds = nested_result(samples=2000, units=3, repeats=3)
    entry = by_level(Result(ds)).outputs["y"]
    assert entry.variance == pytest.approx(14 / 12, rel=0.05)
    for level, variance in VARIANCES.items():
        share = entry.shares[level]
        assert share.value == pytest.approx(variance / 14, abs=0.02)
        assert share.low < share.value < share.high < share.low + 0.08
    assert sum(entry.shares[level].value for level in VARIANCES) == pytest.approx(1.0)
    assert entry.shares["solver"].reason == "the model states no numerical error for it"


def test_the_solver_has_the_share_of_its_stated_error():
    ds = nested_result(samples=200)
    scale = 1e-2
    with_error = with_output(ds, error_name("y"), np.full(ds.sizes["row"], scale))
    outputs = by_level(Result(with_error)).outputs
    assert list(outputs) == ["y"]
    assert outputs["y"].shares["solver"].value == pytest.approx(scale**2 / outputs["y"].variance)


def test_lives_are_apportioned_by_their_logarithm():
    ds = nested_result(samples=100)
    life = np.exp(3 * ds["y"].values)
    lives = with_output(ds, "life", life, "lifetime", np.zeros(len(life)))
    error = with_output(lives, error_name("life"), 0.1 * life)
    outputs = by_level(Result(asking(error, thresholds={"life": [1e6]}, outputs=["life"]))).outputs
    assert list(outputs) == ["log(life)", "P(life<1000000.0)"]
    expected = by_level(Result(ds)).outputs["y"].shares
    for level in VARIANCES:
        assert outputs["log(life)"].shares[level].numbers == pytest.approx(expected[level].numbers)
    assert outputs["log(life)"].shares["solver"].value == pytest.approx(
        0.01 / outputs["log(life)"].variance
    )
    endless = with_output(ds, "life", np.where(life > 1e6, np.inf, life), "lifetime", life < 0)
    assert list(by_level(Result(endless), "life").outputs) == ["rank(life)"]


def test_a_heavy_tail_is_replaced_and_the_note_promises_nothing_else():
    ds = nested_result(samples=100)
    heavy = with_output(ds, "w", np.exp(12 * ds["y"].values))
    (name, entry), *_ = by_level(Result(heavy), "w").outputs.items()
    assert name == "log(w)"
    assert entry.sentences[0].endswith(": shares are of the variance of the logarithm")


def test_a_random_model_differs_by_chance():
    ds = computed(noisy("monte-carlo", 400, 1, units=2, repeats=2))
    shares = by_level(Result(ds), "y").outputs["y"].shares
    assert shares[SHARED].numbers == (0.0, 0.0, 0.0)
    assert shares[OWN].low < 0.5 < shares[OWN].high
    assert shares[CHANCE].low < 0.5 < shares[CHANCE].high
    plain = computed(noisy("monte-carlo", 400, 1))
    assert "set repeats = 2" in by_level(Result(plain), "y").outputs["y"].shares[CHANCE].reason


def test_rows_that_do_not_follow_the_laws_have_no_shares():
    ds = computed(nested(method="morris", units=1, repeats=1))
    with pytest.raises(InputError, match="no shares: the rows of a 'morris' design do not follow"):
        by_level(Result(ds))


def test_python_terminal_json_and_report_agree(uq, tmp_path, no_other_figures):
    path, result = tmp_path / "nested.toml", tmp_path / "nested.nc"
    path.write_text(nested(samples=20).text)
    assert uq("run", path, "-o", result, "--workers", "0").code == 0
    shares = by_level(Result(api.open_result(result))).outputs["y"].shares
    table = api.levels(api.open_result(result))
    assert dict(table.sizes) == {"output": 1, "level": 4}
    document = strict_json(uq("levels", result, "--json").out)
    assert document["inputs"] == LEVELS
    assert (document["samples"], document["units"], document["repeats"]) == (20, 3, 2)
    for level, share in shares.items():
        cells = [
            float(table[name].sel(level=level, output="y"))
            for name in ("share", "share_low", "share_high")
        ]
        assert cells == pytest.approx(share.numbers, nan_ok=True)
        entry = document["outputs"]["y"][level]
        if level != "solver":
            assert (entry["value"], entry["low"], entry["high"]) == share.numbers
    assert document["outputs"]["y"]["solver"]["value"] is None
    assert document["outputs"]["y"]["solver"]["reason"]
    shown = uq("levels", result).out
    assert f"{shares[OWN].value:.3f}" in shown and "20 samples of 3 units" in shown
    assert uq("report", result, "-o", tmp_path / "page.html").code == 0
    page = (tmp_path / "page.html").read_text()
    section = page.partition('<section id="levels">')[2].partition("</section>")[0]
    assert f"{shares[SHARED].value:.3f}" in section and "20 samples of 3 units" in section


def test_an_unknown_output_is_one_line(uq, tmp_path):
    path, result = tmp_path / "nested.toml", tmp_path / "nested.nc"
    path.write_text(nested(samples=8).text)
    uq("run", path, "-o", result, "--workers", "0")
    ended = uq("levels", result, "--output", "yy")
    assert ended.code == 2 and ended.err.count("\n") == 1 and "did you mean 'y'?" in ended.err


def test_errors_are_no_outputs_of_their_own():
    ds = nested_result()
    with_error = with_output(ds, error_name("y"), np.zeros(ds.sizes["row"]))
    assert list(by_level(Result(with_error)).outputs) == ["y"]
