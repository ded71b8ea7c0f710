"""Cumulative incidence by cause, in field data and in machines that declare causes."""

import numpy as np
import pytest
from computed import asking, linear, summarised, with_output
from lifelines import AalenJohansenFitter

import uq
from uq.assess.targets import category_targets
from uq.contract import Output, cause_name
from uq.result.result import Result
from uq.stats.intervals import binomial_interval
from uq.stats.survival_curves import aalen_johansen, incidence_interval


def competing(rng, rows):
    """Return lives, causes and no entries of rows that wear or crack, some of them censored."""
    wear, crack = rng.weibull(1.5, rows) * 2, rng.exponential(2.5, rows)
    end = rng.uniform(0.2, 3, rows)
    life = np.minimum(np.minimum(wear, crack), end)
    codes = np.where(life == end, -1, np.where(wear < crack, 0, 1))
    return life, codes, np.zeros(rows)


def test_the_published_incidence_of_breast_cancer_deaths():
    # Table 2 of doi 10.1038/sj.bjc.6602102: nine of 305 patients, the others followed longer.
    life = np.append([7.0, 10, 14, 16, 18, 23, 24, 26, 27], np.full(296, 60.0))
    codes = np.append([-1, 0, -1, 0, 1, 0, -1, 1, 0], np.full(296, -1))
    times = np.array([10.0, 16, 23, 27])
    share = aalen_johansen(life, codes, np.zeros(305), 0, times).share
    # Their table has 299 at risk at 26 and 27, one more censored row than the list of patients.
    assert (100 * share).round(1).tolist() == [0.3, 0.7, 1.0, 1.3] or (
        np.abs(100 * share - [0.3, 0.6, 0.9, 1.2]) < 0.13
    ).all()


@pytest.mark.parametrize("seed", range(3))
def test_share_and_variance_are_those_of_lifelines(seed):
    life, codes, entered = competing(np.random.default_rng(seed), 120)
    fitter = AalenJohansenFitter(calculate_variance=True).fit(life, codes + 1, event_of_interest=1)
    for time in (0.5, 1.0, 2.0):
        estimate = aalen_johansen(life, codes, entered, 0, np.array([time]))
        assert float(estimate.share[0]) == pytest.approx(fitter.predict(time), abs=1e-10)
        variance = fitter.variance_.loc[:time].iloc[-1]
        assert float(estimate.variance[0]) == pytest.approx(float(np.squeeze(variance)), rel=1e-6)


def test_the_causes_together_are_one_minus_the_survival_curve_and_less_than_each_alone():
    from uq.stats.survival_curves import kaplan_meier

    life, codes, entered = competing(np.random.default_rng(1), 300)
    times = np.linspace(0.1, 2.5, 9)
    shares = [aalen_johansen(life, codes, entered, cause, times).share for cause in (0, 1)]
    assert sum(shares) == pytest.approx(1 - kaplan_meier(life, codes < 0, times).share)
    alone = 1 - kaplan_meier(life, codes != 0, times).share
    assert (shares[0][3:] < alone[3:]).all()


@pytest.mark.slow
@pytest.mark.parametrize("rows", [40, 100, 400])
def test_the_interval_of_an_incidence_covers(rows):
    times = np.array([0.5, 1.0, 2.0])
    rng = np.random.default_rng(9)
    wear, crack = rng.weibull(1.5, 10**6) * 2, rng.exponential(2.5, 10**6)
    truth = np.array([((wear < crack) & (wear <= time)).mean() for time in times])
    held = np.zeros(3)
    for seed in range(1000):
        low, high = incidence_interval(*competing(np.random.default_rng(seed), rows), 0, times)
        held += (low <= truth) & (truth <= high)
    print(rows, held / 1000)
    assert ((held / 1000 >= 0.925) & (held / 1000 <= 0.99)).all()


PAD = """\
import uq

@uq.machine(returns={'life': uq.Returned('s', life=True%s)})
def pad(rate: float = 1e-9, depth: float = 2.5e-4):
    return {'life': %s}
"""
INSPECTED = "uq.between(1e5 * (depth / rate // 1e5), 1e5 * (depth / rate // 1e5) + 1e5)"


def machine(folder, life, declared=", between=True"):
    path = folder / f"pad_{folder.name}.py"  # a module of its own name
    path.write_text(PAD % (declared, life))
    return str(path)


def test_a_machine_returns_lives_between_two_times(tmp_path):
    row = uq.simulate(machine(tmp_path, INSPECTED), {"rate": 1e-9})
    assert row["life"].item() == 2e5
    assert row["life_high"].item() == 3e5
    assert row["life_censored"].item() == 1


def test_a_censored_life_has_no_upper_bound(tmp_path):
    row = uq.simulate(machine(tmp_path, "uq.censored(5e5)"))
    assert row["life"].item() == 5e5
    assert np.isposinf(row["life_high"].item())


def test_an_interval_must_be_declared(tmp_path):
    row = uq.simulate(machine(tmp_path, "uq.between(1, 2)", ""))
    assert "between=True" in row["status"].attrs["example_bad_shape"]


def test_the_ends_of_an_interval_are_in_order():
    with pytest.raises(ValueError, match="low must be at least 0 and below high"):
        uq.between(3.0, 2.0)


def test_a_life_with_causes_has_their_category():
    from dataclasses import replace

    from uq.study.installed_models import find_model

    model = find_model("exponential-wear")
    life = replace(model.outputs["life"], causes=("wear", "crack"))
    named = replace(model, outputs={"life": life})
    assert named.outputs[cause_name("life")].categories == ("wear", "crack")
    assert named.outputs[cause_name("life")].may_be_undefined
    assert Output("s", "a life", "lifetime").causes == ()


def test_a_negative_life_is_a_failed_row_with_a_sentence(tmp_path):
    row = uq.simulate(machine(tmp_path, "-1.0"))
    assert "a life cannot be negative" in row["status"].attrs["example_non_finite"]


def test_a_study_of_a_machine_with_intervals_says_what_inspections_leave_open(tmp_path):
    study = tmp_path / "pad.toml"
    study.write_text(
        '[study]\nname = "pad"\nmodel = "pad"\n'
        '[design]\nmethod = "monte-carlo"\nsamples = 200\nseed = 1\n'
        '[uncertain.rate]\ndistribution = "lognormal"\nmedian = 1e-9\nsigma = 0.4\n'
    )
    loaded = uq.load_study(study, machine(tmp_path, INSPECTED))
    ds = uq.run(loaded, tmp_path / "pad.nc", workers=0)
    assert Result(ds).outputs["life"].may_be_between
    # The median life is 2.5e5 s, in the middle between two inspections.
    table = uq.summary(ds).loc["life"]
    assert table["B50"] == pytest.approx(2.5e5, abs=1e3)
    assert table["B50_low"] <= 2e5 and table["B50_high"] >= 3e5
    curve = uq.survival(ds, "life")
    below, after = (float(curve["survival"].sel(time=time)) for time in (2e5, 3e5))
    assert below > 0.5 > after


def test_lives_that_end_at_once_are_at_risk():
    values = np.array([0.0, 0.0, 1.0, 2.0, 3.0])
    causes = np.array([0, 1, 0, 0, 1])
    share, variance = aalen_johansen(values, causes, np.zeros(5), 0, np.array([0.0, 1.5, 3.0]))
    assert share == pytest.approx([0.2, 0.4, 0.6], rel=1e-15)
    assert np.isfinite(variance).all()


def test_a_cause_that_ends_no_row_is_rare_also_when_few_rows_are_left():
    values, causes = np.arange(1.0, 1001.0), np.zeros(1000, int)
    low, high = incidence_interval(values, causes, np.zeros(1000), 1, np.array([500.0, 999.0]))
    assert (low == 0).all()
    assert high == pytest.approx(1 - 0.025 ** (1 / 1000), rel=1e-9)


def caused(values, codes, censored=None, **analysis):
    """Return a result whose life has the causes arrival and refusal."""
    ds = with_output(
        linear("monte-carlo", samples=len(values)), "life", values, "lifetime", censored
    )
    attrs = ds["life"].attrs | {"kind": "category", "units": "1", "may_be_undefined": 1}
    attrs |= {"flag_values": np.array([-1, 0, 1], np.int8), "flag_meanings": "none arrival refusal"}
    ds["life_cause"] = ("row", np.array(codes, np.int8), attrs)
    return asking(ds, outputs=["life"], **analysis)


def test_a_cause_that_keeps_lives_from_ending_has_the_share_that_never_ends():
    values = np.r_[np.arange(1.0, 91.0), np.full(10, np.inf)]
    ds = caused(values, np.r_[np.zeros(90), np.ones(10)], thresholds={"life": [50.0]})
    causes = summarised(ds)["outputs"]["life"]["causes"]
    assert causes["refusal"]["never"]["value"] == 0.1
    low, high = binomial_interval(0.1, 100)
    assert causes["refusal"]["never"]["low"] == pytest.approx(low, abs=0.01)
    assert causes["refusal"]["never"]["high"] == pytest.approx(high, abs=0.01)
    assert "never" not in causes["arrival"] and causes["arrival"]["50.0"]["value"] == 0.5
    # Causes of ended lives alone have their incidences, as before.
    ds = caused(values, np.r_[np.zeros(90), np.full(10, -1)], thresholds={"life": [50.0]})
    assert summarised(ds)["outputs"]["life"]["causes"]["refusal"]["50.0"]["value"] == 0.0


def test_what_decides_the_cause_is_an_index_unless_a_row_is_censored():
    ds = caused(np.arange(1.0, 201.0), np.zeros(200))
    ds["life_cause"].values[ds["x4"].values > 0.5] = 1
    arrays = uq.sensitivity(asking(ds, outputs=["life_cause"]), "first-order")
    decided = arrays["S1"].sel(output="P(life_cause=refusal)")
    assert decided.sel(parameter="x4") > 0.8 > 0.2 > decided.sel(parameter="x1")
    cut = caused(np.arange(1.0, 201.0), np.zeros(200), np.arange(200) == 7)
    (target,) = category_targets(Result(cut), "life_cause")
    assert "1 row is censored, and what would end it" in target.refused
