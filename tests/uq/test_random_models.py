"""Models whose rows depend on their seed: noise is never counted as an input's."""

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import computed, summarised, with_seed, with_status
from noisy_studies import noisy

from uq.result.result import Result
from uq.assess.comparison import compare
from uq.assess.convergence import running_estimates
from uq.assess.expected_widths import expected_widths
from uq.assess.sensitivity_table import sensitivity
from uq.errors import InputError
from uq.files.whole_files import write_result

# The indices


def test_sobol_indices_leave_the_noise_out_and_tell_its_share():
    # y = x1 + noise: half the variance each, and x2 idle.
    entry = sensitivities(computed(noisy(samples=256)))["outputs"]["y"]
    assert entry["ST"]["x2"]["value"] == entry["S1"]["x2"]["value"] == 0
    for name, truth in (("S1", 0.5), ("ST", 0.5)):
        one = entry[name]["x1"]
        assert one["value"] == pytest.approx(truth, abs=0.06)
        assert one["low"] <= truth <= one["high"]
    noise = entry["noise"]
    assert noise["low"] <= 0.5 <= noise["high"]
    assert noise["high"] - noise["low"] < 0.1
    assert any("share a seed" in note and "noise" in note for note in entry["notes"])


def test_total_indices_hold_what_noise_does_together_with_an_input():
    # crossed = x1 + 2 x2 e: Var x1 = 1/12; E (2 x2 e)^2 = 4/3/12, a quarter of it through x2.
    whole = 1 + 4 / 3
    study = noisy(samples=1024, second_order=True)
    entry = sensitivities(computed(study), output="crossed")["outputs"]["crossed"]
    truth = {"S1": (1 / whole, 0.0), "ST": (1 / whole, (1 / 3) / whole)}
    for kind, values in truth.items():
        for name, value in zip(("x1", "x2"), values, strict=True):
            assert entry[kind][name]["value"] == pytest.approx(value, abs=0.04), (kind, name)
    assert entry["noise"]["value"] == pytest.approx(4 / 3 / whole, abs=0.03)
    assert entry["S2"]["x1,x2"]["value"] == pytest.approx(0.0, abs=0.04)


def test_shapley_effects_of_an_idle_input_are_zero():
    for seed in (0, 1, 2):
        ds = computed(with_seed(noisy("shapley", 256, 1), seed))
        entry = sensitivities(ds)["outputs"]["y"]
        assert entry["shapley"]["x2"]["value"] == 0
        assert entry["shapley"]["x1"]["value"] == pytest.approx(1)
        assert entry["shapley"]["x1"]["low"] is None  # the whole of it, but for rounding
        assert any("share a seed" in note for note in entry["notes"])


def test_effects_of_morris_hold_no_noise():
    entry = sensitivities(computed(noisy("morris", 16, 4)))["outputs"]["y"]
    assert entry["mu_star"]["x2"]["value"] == 0
    assert entry["mu_star"]["x1"]["value"] == pytest.approx(1)
    assert entry["sigma"]["x1"]["value"] == pytest.approx(0, abs=1e-12)


def test_fast_leaves_the_noise_out():
    entry = sensitivities(computed(noisy("fast", 257, 4)))["outputs"]["y"]
    assert entry["ST"]["x2"]["value"] == pytest.approx(0, abs=0.01)
    assert entry["S1"]["x1"]["value"] == pytest.approx(1, abs=0.01)


def test_shares_of_fast_are_those_of_the_mean_variance_at_one_seed():
    # x1 + 20 x2 e at one seed: 1 and 400 e^2 twelfths, on average 1 and 33.3. The mean of the
    # shares at each seed would be 0.147 and 0.853.
    ds = computed(noisy("fast", 65, 200))
    ds["crossed"].values[:] += 9 * (ds["crossed"] - ds["x1"]).values
    entry = sensitivities(ds, output="crossed")["outputs"]["crossed"]
    assert entry["S1"]["x1"]["value"] == pytest.approx(0.029, abs=0.02)
    assert entry["S1"]["x2"]["value"] == pytest.approx(0.971, abs=0.05)


def test_what_only_the_seed_moves_has_no_shares():
    for method in ("shapley", "fast"):
        ds = computed(noisy(method, 65, 4))
        y = ds["y"].copy(data=ds["y"].values - ds["x1"].values)
        moved = sensitivities(ds.assign(y=np.round(y, 6)), output="y")["outputs"]["y"]
        assert moved["refused"] == "no input changes it at one seed: all of its variance is noise"


def test_a_curve_at_whose_seed_nothing_moves_leaves_fast_the_others():
    ds = computed(noisy("fast", 65, 8))
    still = (ds["replicate"] == 3) & (ds["block"] == 0)
    entry = sensitivities(ds.assign(y=ds["y"].where(~still, 7.0)), output="y")["outputs"]["y"]
    assert entry["S1"]["x1"]["value"] == pytest.approx(1, abs=0.01)


def test_rows_of_their_own_have_the_noise_in_them_and_say_nothing_of_it():
    entry = sensitivities(computed(noisy("monte-carlo", 1024, 1)))["outputs"]["y"]
    assert entry["S1"]["x1"]["value"] == pytest.approx(0.5, abs=0.08)
    assert "noise" not in entry and not entry["notes"]


def test_a_model_that_is_not_random_has_no_share_of_noise():
    ds = computed(noisy(model="SOMETIMES", fixed={"x2": 0.0}))
    assert "noise" not in sensitivities(ds)["outputs"]["y"]
    assert "random" not in ds.attrs and "noise" not in sensitivity(ds)


@pytest.mark.slow
def test_share_of_noise_covers_its_truth():
    study = noisy(samples=32)
    held = []
    for seed in range(60):
        noise = sensitivities(computed(with_seed(study, seed)))["outputs"]["y"]["noise"]
        held.append(noise["low"] <= 0.5 <= noise["high"])
    assert np.mean(held) >= 0.87  # three standard errors below 0.95


# What else reads such rows


def test_plain_statistics_use_a_and_b_alone():
    ds = computed(noisy(samples=64, replicates=4))
    found = summarised(ds)
    assert (found["samples"], found["rows_used"]) == (64 * 4 * 5, 64 * 4 * 2)
    ends = np.isin(ds["block"].values, [0, 3])
    assert found["outputs"]["y"]["mean"] == pytest.approx(ds["y"].values[ends].mean())


def test_curves_of_one_seed_give_no_plain_statistics(uq, folder):
    # 1040 rows of 16 seeds: of an event of the noise they would tell far too much.
    ds = computed(noisy("fast", 65, 8))
    found = summarised(ds)
    assert found["rows_used"] == 0 and found["outputs"]["y"]["mean"] is None
    reason = "share seeds along a curve, as the model is random"
    assert found["notes"][0].startswith(f"no statistics: the rows of a 'fast' design {reason}")
    with pytest.raises(InputError, match=f"the rows of the first, a 'fast' design, {reason}"):
        compare(ds, ds)
    plain = summarised(computed(noisy("fast", 65, 8, model="PLAIN")))
    assert plain["rows_used"] == 1040 and plain["outputs"]["y"]["mean"] == pytest.approx(0.5, 0.1)
    (folder / "noisy.toml").write_text(noisy("fast", 65, 2).text)
    assert (
        uq("run", "noisy.toml", "-o", "n.nc", "--model", "sample_models:NOISY", "--workers", 0).code
        == 0
    )
    for verb in (("summary",), ("plot", "-o", "figures"), ("report", "-o", "n.html")):
        shown = uq(verb[0], "n.nc", *verb[1:])
        assert shown.code == 0, shown.err


def test_a_failed_row_of_the_noise_block_drops_its_group():
    ds = computed(noisy(samples=16, replicates=4))
    row = int(np.flatnonzero(ds["block"].values == 4)[3])
    y = ds["y"].copy()
    y[row] = np.nan
    found = sensitivities(with_status(ds.assign(y=y), [row], 2), output="y")
    assert found["groups_dropped"] == 1 and found["rows_used"] == 63 * 5


def test_arrays_have_the_share_of_noise():
    found = sensitivity(computed(noisy(samples=64)))
    share = [float(found[name].sel(output="y")) for name in ("noise_low", "noise", "noise_high")]
    assert share == sorted(share) and share[1] == pytest.approx(0.5, abs=0.1)


def test_widths_and_convergence_take_such_rows():
    ds = computed(noisy(samples=64))
    assert expected_widths(Result(ds))["y"].indices["ST"] > 0
    assert "S1 x1" in set(running_estimates(ds, "y")["estimate"])
    assert not expected_widths(Result(computed(noisy("shapley", 64))))["y"].indices


def test_tables_show_the_share_of_noise(uq, folder):
    (folder / "noisy.toml").write_text(noisy(samples=16).text)
    text = " ".join(uq("check", "noisy.toml", "--model", "sample_models:NOISY").out.split())
    assert "5 rows each" in text and "the model is random: rows that are compared share" in text
    run = uq(
        "run", "noisy.toml", "-o", "noisy.nc", "--model", "sample_models:NOISY", "--workers", 0
    )
    assert run.code == 0
    more = ("--samples", "32", "--model", "sample_models:NOISY", "--workers", 0)
    assert uq("extend", "noisy.nc", *more).code == 0
    shown = uq("sensitivity", "noisy.nc").out
    assert "noise" in shown and "share of variance" in shown


@pytest.mark.slow
def test_the_report_and_figures_show_the_share_of_noise(uq, folder):
    write_result(computed(noisy(samples=16)), folder / "noisy.nc")
    assert uq("report", "noisy.nc", "-o", "noisy.html").code == 0
    assert "Share of noise" in (folder / "noisy.html").read_text()
    assert uq("plot", "noisy.nc", "-o", "figures").code == 0
