"""Given-data methods against closed forms, brute force and OpenTURNS, a second implementation."""

from dataclasses import replace

import numpy as np
import openturns as ot
import pytest
from asked_indices import sensitivities, values
from computed import UNIFORM, asking, computed, linear, study_of, with_output
from SALib.analyze import enhanced_hdmr
from scipy import stats

from uq.assess import sensitivities as module
from uq.assess.sensitivity_table import sensitivity
from uq.errors import InputError
from uq.indices import expansions
from uq.indices.given_data import quantile_indices
from uq.indices.index import RefusedError
from uq.indices.measures import even_cuts, slice_of
from uq.indices.method import DesignSample
from uq.indices.methods import METHODS
from uq.result.result import Result

ISHIGAMI = {"distribution": "uniform", "lower": -np.pi, "upper": np.pi}
CASES = {
    "ishigami": (("x1", "x2", "x3"), ISHIGAMI),
    "g-function": (tuple(f"x{i}" for i in range(1, 9)), UNIFORM),
    "linear": (tuple(f"x{i}" for i in range(1, 5)), UNIFORM),
}
_V = np.array([1 / (3 * (1 + a) ** 2) for a in (0, 1, 4.5, 9, 99, 99, 99, 99)])
_ALL = np.prod(1 + _V) - 1
FIRST = {
    "ishigami": (0.3139, 0.4424, 0.0),
    "g-function": tuple(_V / _ALL),
    "linear": tuple(i**2 / 30 for i in range(1, 5)),
}
TOTAL = {
    "ishigami": (0.5576, 0.4424, 0.2437),
    "g-function": tuple(_V / (1 + _V) * (1 + _ALL) / _ALL),
    "linear": FIRST["linear"],
}


def plain(model, samples=1024, seed=1):
    names, law = CASES[model]
    return computed(
        study_of(
            {
                "study": {"name": "given", "model": model},
                "design": {"method": "monte-carlo", "samples": samples, "seed": seed},
                "uncertain": dict.fromkeys(names, law),
            }
        )
    )


def entry_of(ds, method, output="y"):
    return sensitivities(ds, method, output)["outputs"][output]


def columns(ds, names):
    return ot.Sample(np.column_stack([ds[name].values for name in names]))


@pytest.mark.parametrize("model", CASES)
def test_first_order_indices_by_rbd_fast_are_the_known_ones_and_openturns(model):
    ds = plain(model, 2048)
    first_order_values = values(entry_of(ds, "rbd-fast"), "S1")
    assert first_order_values == pytest.approx(FIRST[model], abs=0.05)
    rank = ot.RankSobolSensitivityAlgorithm(
        columns(ds, CASES[model][0]), ot.Sample(ds["y"].values[:, None])
    )
    # Chatterjee's ranks, a noisier estimate of the same number.
    assert first_order_values == pytest.approx(list(rank.getFirstOrderIndices()), abs=0.1)


@pytest.mark.parametrize(
    "model", [pytest.param(case, marks=[pytest.mark.slow] * (case != "linear")) for case in CASES]
)
def test_expansion_gives_the_known_indices_and_those_of_openturns(model):
    ds = plain(model)
    entry = entry_of(ds, "hdmr")
    assert values(entry, "S1") == pytest.approx(FIRST[model], abs=0.08)
    assert values(entry, "ST") == pytest.approx(TOTAL[model], abs=0.08)
    assert sum(values(entry, "shapley")) == pytest.approx(1.0, abs=0.1)
    assert all(abs(value) < 0.05 for value in entry["dummy"].values())
    assert "held out" in entry["notes"][0]
    if model == "ishigami":
        # Shapley effects where pairs alone interact: S1 and half of each S2; S13 = 0.2437.
        expected = (0.3139 + 0.2437 / 2, 0.4424, 0.2437 / 2)
        assert values(entry, "shapley") == pytest.approx(expected, abs=0.04)
        assert values(entry, "S2") == pytest.approx((0.0, 0.2437, 0.0), abs=0.04)
        law = ot.JointDistribution([ot.Uniform(-np.pi, np.pi)] * 3)
        basis = ot.OrthogonalProductPolynomialFactory([ot.LegendreFactory()] * 3)
        chaos = ot.FunctionalChaosAlgorithm(
            columns(ds, CASES[model][0]),
            ot.Sample(ds["y"].values[:, None]),
            law,
            ot.FixedStrategy(basis, basis.getEnumerateFunction().getBasisSizeFromTotalDegree(9)),
            ot.LeastSquaresStrategy(),
        )
        chaos.run()
        second = ot.FunctionalChaosSobolIndices(chaos.getResult())
        for i, name in enumerate(CASES[model][0]):
            assert entry["S1"][name]["value"] == pytest.approx(second.getSobolIndex(i), abs=0.04)
            total = second.getSobolTotalIndex(i)
            assert entry["ST"][name]["value"] == pytest.approx(total, abs=0.04)


def test_expansion_is_refused_where_it_explains_too_little():
    ds = plain("linear", 700)
    rng = np.random.default_rng(0)
    ds = with_output(ds, "noise", ds["y"].values + rng.normal(size=700) * 3)
    assert "held out" in entry_of(ds, "hdmr", "noise")["refused"]
    ds = with_output(ds, "step", ds["y"].values > 5)
    assert "polynomials cannot" in entry_of(ds, "hdmr", "step")["refused"]
    few = plain("linear", 500)
    assert "600 are needed" in entry_of(few, "hdmr")["refused"]
    few = with_output(few, "step", few["y"].values > 5)  # more rows would not help
    assert "polynomials cannot" in entry_of(few, "hdmr", "step")["refused"]


def test_the_method_that_a_refusal_names_accepts_what_was_refused():
    rng = np.random.default_rng(0)
    level = rng.integers(0, 5, 700).astype(float)
    continuous = {name: rng.random(700) for name in ("x1", "x2")}
    for method, inputs, y in (
        ("delta", continuous, level),
        ("hdmr", continuous, level),
    ):
        with pytest.raises(RefusedError, match="use pawn$"):
            METHODS[method].indices(DesignSample.plain(y, inputs))
        result = METHODS["pawn"].indices(DesignSample.plain(y, inputs))
        assert all(
            np.isfinite(index.value)
            for indices_of_kind in result.values.values()
            for index in indices_of_kind.values()
        )


@pytest.mark.slow
@pytest.mark.parametrize("model", CASES)
def test_delta_and_pawn_are_those_of_brute_force(model):
    ds, big = plain(model, 2048), plain(model, 400_000, seed=2)
    names, y = CASES[model][0], big["y"].values
    for method, distance, tolerance in (("delta", _area, 0.1), ("pawn", _ks_median, 0.08)):
        value_by_name = dict(zip(names, values(entry_of(ds, method), method), strict=True))
        dummy = entry_of(ds, method)["dummy"][method]
        for name in names[:4]:
            order = np.argsort(big[name].values)
            expected = distance(y, [y[part] for part in np.array_split(order, 50)])
            # An index of an input that plays no part is not zero in slices of few rows.
            assert value_by_name[name] == pytest.approx(expected, abs=max(tolerance, dummy)), name


def _area(y, slices):
    edges = np.quantile(y, np.linspace(0, 1, 101))
    whole = np.histogram(y, edges)[0] / len(y)
    areas = [abs(np.histogram(part, edges)[0] / len(part) - whole).sum() / 2 for part in slices]
    return np.mean(areas)


def _ks_median(y, slices):
    return np.median([stats.ks_2samp(part, y[::40], method="asymp").statistic for part in slices])


def test_quantile_indices_of_a_normal_sum_are_the_closed_form():
    # The contrast of a normal law is proportional to its deviation: the index is 1 - the ratio of
    # the deviation that remains to the whole one, for every quantile.
    ds = linear(samples=8000)
    weights = np.array([1.0, 2.0, 3.0, 0.0])
    z = stats.norm.ppf([ds[f"x{i}"].values for i in range(1, 5)])
    ds = asking(with_output(ds, "sum", weights @ z), outputs=["sum"], quantiles=[0.1, 0.5, 0.9])
    entry = entry_of(ds, "quantile", "sum")
    expected = 1 - np.sqrt(1 - weights**2 / 14)
    for kind in ("Q0.1", "Q0.5", "Q0.9"):
        assert values(entry, kind) == pytest.approx(expected, abs=0.025)
        assert entry["dummy"][kind] < 0.02


def test_quantile_indices_are_means_of_the_least_contrast_of_each_slice():
    rng = np.random.default_rng(2)
    x, y = rng.random((5, 3001)), rng.normal(size=3001)
    x[1] = np.floor(4 * x[1])  # a slice for each of few values
    sample = DesignSample.plain(y, {}, quantiles={"rare": 0.1, "median": 0.5})
    raw, _ = quantile_indices(x.T, sample)

    def contrast(part, p):
        rest = part - np.quantile(part, p, method="inverted_cdf")
        return np.mean(rest * (p - (rest < 0)))

    for kind, p in zip(raw, (0.1, 0.5), strict=True):
        count = min(len(y) // max(30, int(np.ceil(5 / p))), 48)
        for i, column in enumerate(x):
            number = slice_of(column, even_cuts(len(y), count))
            parts = [y[number == k] for k in range(number.max() + 1)]
            left = sum(len(part) * contrast(part, p) for part in parts) / len(y)
            assert raw[kind][i] == 1 - left / contrast(y, p)


def test_indices_of_an_output_do_not_depend_on_those_computed_before():
    ds = plain("linear")
    ds = with_output(ds, "other", ds["x1"].values ** 2 + ds["x4"].values)
    for method in ("hdmr", "first-order", "quantile"):
        together = sensitivities(ds, method)["outputs"]
        for name in ("other", "y"):
            assert sensitivities(ds, method, name)["outputs"][name] == together[name]


def test_the_expansion_is_that_of_salib():
    ds = plain("ishigami", samples=1200)
    x, y = np.array(columns(ds, CASES["ishigami"][0])), ds["y"].values
    problem = {"num_vars": 3, "names": ["0", "1", "2"]}
    options = {"poly_order": 6, "bootstrap": 1, "subset": len(y), "return_emulator": True}
    theirs = enhanced_hdmr.analyze(problem, x, y, **options)
    for _ in range(2):  # computed, then kept
        ours = expansions._expansion(x, y, 6)
        np.testing.assert_array_equal(ours["S"], theirs["S"])
        np.testing.assert_array_equal(ours.emulate(x), theirs.emulate(x))


def test_quantile_indices_of_a_lifetime_are_those_of_the_rows_that_end_first():
    sigma, spread = 0.5, 0.2
    ds = computed(
        study_of(
            {
                "study": {"name": "wear", "model": "exponential-wear"},
                "design": {"method": "monte-carlo", "samples": 8000},
                "uncertain": {
                    "rate": {"distribution": "lognormal", "median": 2.5e-10, "sigma": sigma},
                    "depth": {"distribution": "lognormal", "median": 2.5e-4, "sigma": spread},
                },
            }
        )
    )
    entry = entry_of(ds, "quantile", "log(life)")  # a normal sum
    deviation = np.hypot(sigma, spread)
    for kind in ("B10", "B50"):
        expected = [1 - rest / deviation for rest in (spread, sigma)]
        assert values(entry, kind) == pytest.approx(expected, abs=0.04)
    entry = entry_of(ds, "quantile", "rate(life)")

    def contrast(p, s):  # of a lognormal law, over its mean
        return p - stats.norm.cdf(stats.norm.ppf(p) - s)

    for kind, p in {"B10": 0.9, "B50": 0.5}.items():
        whole = contrast(p, deviation)
        expected = [1 - contrast(p, rest) / whole for rest in (spread, sigma)]
        assert values(entry, kind) == pytest.approx(expected, abs=0.04)


def test_arrays_hold_indices_of_other_names_side_by_side():
    ds = linear(samples=2000)
    ds = with_output(ds, "life", 1.0 + ds["x1"].values, kind="lifetime")
    ds = with_output(ds, "late", np.where(ds["x2"] > 0.9, np.inf, 1 + ds["x2"]), kind="lifetime")
    arrays = sensitivity(asking(ds, quantiles=[0.5]), "quantile")
    plain = sensitivities(asking(ds, quantiles=[0.5]), "quantile")["outputs"]
    assert {"Q0.5", "B10", "B50"} <= {kind for entry in plain.values() for kind in entry}
    for name, entry in plain.items():
        for kind in ("Q0.5", "B10", "B50"):
            row = arrays[kind].sel(output=name)
            expected = values(entry, kind) if kind in entry else np.full(4, np.nan)
            np.testing.assert_array_equal(row, expected)
            dummy = entry["dummy"].get(kind, np.nan)
            np.testing.assert_array_equal(arrays[f"dummy_{kind}"].sel(output=name), dummy)


def test_quantiles_without_rows_enough_are_left_out_with_a_note():
    ds = asking(linear(samples=300), quantiles=[0.01, 0.5])
    entry = entry_of(ds, "quantile")
    assert "Q0.5" in entry and "Q0.01" not in entry
    assert "Q0.01 needs 2500" in entry["notes"][0]
    assert "Q0.01" in entry_of(asking(ds, quantiles=[0.01]), "quantile")["refused"]


def test_dependent_inputs_are_refused_by_methods_that_assume_independence(monkeypatch):
    ds = linear(samples=128)
    why = "the inputs of this study depend on each other"
    monkeypatch.setattr(module, "why_dependent", lambda ds: why)
    assert module.methods(Result(ds)) == ("delta",)
    assert sensitivities(ds)["method"] == "delta"
    for method in ("rbd-fast", "hdmr"):
        with pytest.raises(InputError, match="inputs of this study depend on each other"):
            sensitivities(ds, method)
    with pytest.raises(InputError, match="delta, pawn, quantile, regional"):
        sensitivities(linear("saltelli", 16), "sobol")


@pytest.mark.parametrize("model", ["ishigami", "g-function"])
def test_sobol_indices_are_those_of_openturns(model):
    names, law = CASES[model]
    ds = computed(
        study_of(
            {
                "study": {"name": "sobol", "model": model},
                "design": {"method": "saltelli", "samples": 1024},
                "uncertain": dict.fromkeys(names, law),
            }
        )
    )
    blocks = ds["y"].values.reshape(1024, len(names) + 2)
    order = [0, len(names) + 1, *range(1, len(names) + 1)]  # OpenTURNS has A, B, then the mixed
    inputs = np.stack([ds[name].values.reshape(1024, -1) for name in names], axis=-1)
    x = np.concatenate([inputs[:, i] for i in order])
    y = np.concatenate([blocks[:, i] for i in order])
    second = ot.JansenSensitivityAlgorithm(ot.Sample(x), ot.Sample(y[:, None]), 1024)
    entry = entry_of(ds, "sobol")
    assert values(entry, "ST") == pytest.approx(list(second.getTotalOrderIndices()), abs=0.02)
    saltelli = ot.SaltelliSensitivityAlgorithm(ot.Sample(x), ot.Sample(y[:, None]), 1024)
    assert values(entry, "S1") == pytest.approx(list(saltelli.getFirstOrderIndices()), abs=0.03)


@pytest.mark.parametrize("method", ["rbd-fast", "delta", "pawn", "quantile", "regional"])
def test_inputs_without_effect_are_estimated_only_where_they_are_wanted(method):
    rng = np.random.default_rng(5)
    x, listed = rng.random(200), rng.integers(0, 3, 200).astype(float)
    values = x + listed if METHODS[method].takes_numbers else (x > 0.5).astype(float)
    quantiles = {"q0.5": 0.5} if method == "quantile" else {}
    sample = DesignSample.plain(values, {"x": x, "listed": listed}, quantiles=quantiles)
    compared = METHODS[method].indices(sample)
    alone = METHODS[method].indices(replace(sample, nulls=False))
    assert compared.nulls
    corrected = method == "quantile"  # by the inputs without effect themselves
    assert bool(alone.nulls) == corrected
    for kind, index_of_inputs in compared.values.items():
        for name, index in index_of_inputs.items():
            assert alone.values[kind][name].value == pytest.approx(index.value, nan_ok=True, abs=0)
