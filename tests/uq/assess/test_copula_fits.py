"""Copulas fitted to two columns: the copula they were drawn from, other scales, ties, refusals."""

import numpy as np
import openturns as ot
import pandas as pd
import pytest
import xarray as xr
from computed import computed, study_of
from input_studies import UNIFORM, tables

import uq
from uq.errors import InputError
from uq.sampling.copulas import copula_of_rank

DRAWN = {
    "normal": ("normal", {}),
    "student": ("student", {"freedom": 2.0}),
    "clayton": ("clayton", {}),
    "survival clayton": ("clayton", {"survival": True}),
    "gumbel": ("gumbel", {}),
    "survival gumbel": ("gumbel", {"survival": True}),
    "frank": ("frank", {}),
}


def columns(name, rank=0.6, n=2000, seed=1, **options):
    """Return two columns of a copula, with lognormal and exponential laws."""
    u, w = np.random.default_rng(seed).random((2, n))
    v = copula_of_rank(name, rank, **options).conditional_quantile(w, u)
    return {"a": np.exp(u / (1 - u) * 1e-2), "b": -np.log1p(-v)}


@pytest.mark.parametrize("words", DRAWN)
def test_the_copula_of_a_large_sample_has_the_lowest_aic_and_its_parameters(words):
    name, options = DRAWN[words]
    fits = uq.copula_fits(columns(name, **options), "a", "b")
    assert set(fits.index) == set(DRAWN)
    assert fits.index[0] == words and fits["aic"].is_monotonic_increasing
    copula, line = copula_of_rank(name, 0.6, **options), fits.loc[words]
    assert line["rank_correlation"] == pytest.approx(0.6, abs=0.04)
    assert line["distance"] < 0.1 < fits["distance"].max()
    lower, upper = copula.tails
    assert line[["lower_tail", "upper_tail"]].to_list() == pytest.approx([lower, upper], abs=0.06)
    if name == "student":
        assert line["degrees_of_freedom"] == pytest.approx(2.0, rel=0.25)
    conclusion = fits.attrs["conclusion"]
    assert conclusion.startswith(f"The lowest AIC is that of the copula '{words}'")
    assert fits.attrs["rank_correlation"] == pytest.approx(0.6, abs=0.04)
    assert fits["p_value"].isna().all()


def test_fits_maximise_the_likelihood_that_openturns_computes():
    data = columns("gumbel", 0.5, 300)
    fits = uq.copula_fits(data, "a", "b")
    points = pd.DataFrame(data).rank().to_numpy() / 301

    def student(line, factor):
        r = line["parameter"] * factor
        return ot.StudentCopula(line["degrees_of_freedom"], ot.CorrelationMatrix([[1, r], [r, 1]]))

    def normal(line, factor):
        r = line["parameter"] * factor
        return ot.NormalCopula(ot.CorrelationMatrix([[1.0, r], [r, 1.0]]))

    of_theta = {"clayton": ot.ClaytonCopula, "gumbel": ot.GumbelCopula, "frank": ot.FrankCopula}
    copulas = {"student": student, "normal": normal} | {
        name: lambda line, factor, copula=copula: copula(line["parameter"] * factor)
        for name, copula in of_theta.items()
    }
    for name, copula in copulas.items():
        line = fits.loc[name]
        best, less, more = (
            np.sum(np.array(copula(line, factor).computeLogPDF(points)))
            for factor in (1.0, 0.99, 1.01)
        )
        assert line["log_likelihood"] == pytest.approx(best, rel=1e-8)
        assert best > max(less, more)
        assert line["aic"] == pytest.approx((4 if name == "student" else 2) - 2 * best, rel=1e-8)
    with_freedom = fits.loc["student"].copy()
    for factor in (0.9, 1.1):
        with_freedom["degrees_of_freedom"] = fits.loc["student", "degrees_of_freedom"] * factor
        other = np.sum(np.array(student(with_freedom, 1.0).computeLogPDF(points)))
        assert other < fits.loc["student", "log_likelihood"]


def test_scales_and_sources_do_not_matter(tmp_path):
    data = columns("clayton", 0.5, 200)
    fits = uq.copula_fits(data, "a", "b")
    scaled = {"a": np.log(data["a"]), "b": 1e6 * data["b"] ** 3}
    pd.DataFrame(scaled).to_csv(tmp_path / "ab.csv", index=False)
    sources = (scaled, pd.DataFrame(scaled), xr.Dataset({k: ("n", v) for k, v in scaled.items()}))
    for source in (*sources, tmp_path / "ab.csv", str(tmp_path / "ab.csv")):
        pd.testing.assert_frame_equal(uq.copula_fits(source, "a", "b"), fits)
    # Exchanged columns: the copulas are symmetric.
    pd.testing.assert_frame_equal(uq.copula_fits(data, "b", "a"), fits, rtol=1e-6)
    # Mirrored columns: the copulas exchange their tails.
    mirrored = uq.copula_fits({name: -column for name, column in data.items()}, "a", "b")
    assert mirrored.index[0] == "survival clayton"
    assert mirrored.loc["survival clayton", "upper_tail"] == pytest.approx(
        fits.loc["clayton", "lower_tail"]
    )


def test_the_inputs_of_a_result_have_the_copula_of_their_study():
    together = {"parameters": ["x1", "x2"], "rank_correlation": [[1.0, 0.7], [0.7, 1.0]]}
    given = tables({"x1": UNIFORM, "x2": UNIFORM}, samples=1500)
    result = computed(study_of(given | {"dependence": together | {"copula": "gumbel"}}))
    fits = uq.copula_fits(result, "x1", "x2")
    assert fits.index[0] == "gumbel"
    assert fits.loc["gumbel", "rank_correlation"] == pytest.approx(0.7, abs=0.03)


def test_few_data_do_not_tell_copulas_apart():
    fits = uq.copula_fits(columns("normal", 0.3, 40), "a", "b")
    assert "the data do not tell it from" in fits.attrs["conclusion"]
    assert fits.attrs["pairs"] == 40


def test_negative_dependence_is_fitted_and_perfect_dependence_refused():
    data = columns("frank", -0.6, 500)
    fits = uq.copula_fits(data, "a", "b")
    assert fits.index[0] == "frank"
    assert fits.loc["frank", "parameter"] < 0
    assert fits.loc["frank", "rank_correlation"] == pytest.approx(-0.6, abs=0.08)
    assert fits.loc["clayton", "rank_correlation"] < 0.01  # the weakest
    for sign in (1, -1):
        with pytest.raises(InputError, match="one determines the other, which equals states"):
            uq.copula_fits({"a": data["a"], "b": sign * data["a"]}, "a", "b")


def test_equal_values_are_told_and_refused():
    data = columns("normal", 0.5, 400)
    data["b"][:40] = data["b"][0]
    assert (
        "10.0 % of the values of a column are equal"
        in uq.copula_fits(data, "a", "b").attrs["conclusion"]
    )
    data["b"][:120] = data["b"][0]
    with pytest.raises(InputError, match="copula fits: 30.0 % of the values of b are equal"):
        uq.copula_fits(data, "a", "b")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"a": np.arange(50.0)}, "no column 'b'"),
        ({"a": np.arange(50.0), "b": np.arange(40.0)}, r"\[40, 50\] values"),
        ({"a": np.arange(9.0), "b": np.arange(9.0)}, "two columns of one length, 30 or more"),
        ({"a": np.full(50, np.nan), "b": np.arange(50.0)}, "a must be a column of finite numbers"),
        ({"a": np.ones((50, 2)), "b": np.arange(50.0)}, "a must be a column of finite numbers"),
        ({"a": ["x"] * 50, "b": np.arange(50.0)}, "a must be a column of finite numbers"),
        ("nowhere.csv", "nowhere.csv: no such file"),
        (3, "int has no columns"),
    ],
)
def test_what_cannot_be_fitted_is_refused_in_one_line(data, message):
    with pytest.raises(InputError, match=message) as caught:
        uq.copula_fits(data, "a", "b")
    assert len(caught.value.lines) == 1


@pytest.mark.slow
def test_p_values_reject_other_copulas_and_keep_the_true():
    fits = uq.copula_fits(columns("clayton", 0.6, 200), "a", "b", refits=40)
    assert fits.loc["clayton", "p_value"] > 0.05
    assert fits.loc["survival clayton", "p_value"] < 0.05
    again = uq.copula_fits(columns("clayton", 0.6, 200), "a", "b", refits=40)
    pd.testing.assert_frame_equal(again, fits)
