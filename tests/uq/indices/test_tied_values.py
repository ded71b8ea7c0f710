"""Inputs with equal values: sliced by value, whatever the values are, or refused."""

import numpy as np
import pytest
from asked_indices import indices, of_plain_sample
from computed import asking, linear, with_output

from uq import open_result
from uq.indices.index import RefusedError
from uq.indices.measures import first_order, slice_of
from uq.plots import index_bars

N = 3000
QUANTILES = {"Q0.5": 0.5}


def rows(share=0.03, seed=1):
    """Return a binary input, a continuous one and an output of both."""
    rng = np.random.default_rng(seed)
    binary = (rng.random(N) < share).astype(float)
    x1 = rng.random(N)
    return binary, x1, x1 + 0.8 * binary


def estimated(method, y, quantiles=QUANTILES, **x):
    result = of_plain_sample(method, x, y, quantiles)
    kind = next(iter(result.values))
    return {name: index.value for name, index in result.values[kind].items()}, result


@pytest.mark.parametrize("method", ["pawn", "delta", "quantile"])
@pytest.mark.parametrize("share", [0.03, 0.5])
def test_a_binary_input_has_the_same_index_whatever_its_values_are(method, share):
    binary, x1, y = rows(share)
    once, _ = estimated(method, y, x1=x1, x2=binary)
    for other in (1 - binary, 7.0 - 3 * binary):
        again, _ = estimated(method, y, x1=x1, x2=other)
        assert again["x1"] == once["x1"]
        assert again["x2"] == pytest.approx(once["x2"], abs=0.004 if method == "quantile" else 1e-9)


def test_pawn_of_a_binary_input_is_the_median_distance_of_its_two_laws():
    binary, x1, y = rows()
    values_by_input, _ = estimated("pawn", y, x1=x1, x2=binary)
    p = binary.mean()
    # F(y | 0) = y, F(y | 1) = y - 0.8: 0.8 apart, of which p and 1 - p to the law of all rows.
    assert values_by_input["x2"] == pytest.approx(np.median([0.8 * p, 0.8 * (1 - p)]), abs=0.04)


def test_delta_of_a_binary_input_is_the_area_between_its_two_laws():
    binary, x1, _ = rows(0.5)
    values_by_input, _ = estimated("delta", x1 + 5.0 * binary, x1=x1, x2=binary)
    assert values_by_input["x2"] == pytest.approx(0.5, abs=0.05)  # two laws that do not meet
    four = np.random.default_rng(2).integers(0, 4, N).astype(float)
    values_by_input, _ = estimated("delta", x1 + 5.0 * four, x1=x1, x2=four)
    assert values_by_input["x2"] == pytest.approx(0.75, abs=0.07)


@pytest.mark.parametrize("method", ["pawn", "delta", "quantile"])
def test_a_rare_value_without_effect_is_recognised_by_its_own_shuffled_rows(method):
    binary, x1, _ = rows(0.02)
    values_by_input, indices_ = estimated(method, x1, x1=x1, x2=binary)
    (note,) = indices_.notes
    assert note.startswith("x2 has many equal values: shuffled")
    reached = float(note.partition(" = ")[2].split()[0])
    assert values_by_input["x2"] < max(3 * reached, 0.02)


@pytest.mark.parametrize("method", ["pawn", "delta", "quantile"])
def test_an_input_whose_rare_values_fill_no_slice_has_no_index(method):
    _, x1, _ = rows()
    rare = np.zeros(N)
    rare[::500] = 1.0  # six rows, which hold nearly all the variance
    values_by_input, indices_ = estimated(method, x1 + 100 * rare, x1=x1, x2=rare)
    assert np.isnan(values_by_input["x2"]) and values_by_input["x1"] > 0.1
    kind = next(iter(indices_.values))
    assert indices_.notes == (f"x2 has too few rows of any value but one: no {kind.key}",)
    with pytest.raises(RefusedError, match="x2 has too few rows of any value but one"):
        of_plain_sample(method, {"x2": rare}, x1, QUANTILES)


def test_regional_distance_of_a_choice_is_the_same_whatever_its_values_are():
    rng = np.random.default_rng(5)
    choice, happens = rng.integers(0, 4, N), rng.random(N)
    event = (happens < np.array([0.2, 0.7, 0.1, 0.5])[choice]).astype(float)
    with_, without = (np.bincount(choice[event == side], minlength=4) for side in (1, 0))
    apart = np.abs(with_ / with_.sum() - without / without.sum()).sum() / 2
    for labels in ([0.0, 1.0, 2.0, 3.0], [3.0, 0.0, 2.0, 1.0], [10.0, -5.0, 1e3, 0.1]):
        values_by_input, _ = estimated(
            "regional", event, x1=rng.random(N), x2=np.array(labels)[choice]
        )
        assert values_by_input["x2"] == pytest.approx(apart), labels


def test_quantile_indices_of_few_values_are_not_corrected_for_many_slices():
    rng = np.random.default_rng(3)
    values = []
    for _ in range(10):
        idle, y = rng.integers(0, 2, N).astype(float), rng.random(N)
        values.append(estimated("quantile", y, x1=rng.random(N), x2=idle)[0]["x2"])
    assert np.mean(values) == pytest.approx(0, abs=5e-4)


def test_slices_part_no_equal_values_and_hold_all_rows():
    rng = np.random.default_rng(4)
    cuts = np.arange(100, 1000, 100)
    few = rng.integers(0, 25, 1000).astype(float)
    number = slice_of(few, cuts)
    assert all(len(np.unique(number[few == value])) == 1 for value in np.unique(few))
    counts = np.bincount(number)
    assert 8 <= len(counts) <= 10 and counts.min() > 0 and counts.sum() == 1000
    continuous = rng.random(1000)
    assert np.bincount(slice_of(continuous, cuts)).tolist() == [100] * 10
    heavy = np.where(rng.random(1000) < 0.6, 1.0, continuous)  # the largest value in most rows
    number = slice_of(heavy, cuts)
    assert len(np.unique(number[heavy == 1.0])) == 1 and number.min() == 0
    assert (slice_of(np.ones(50), np.arange(5, 50, 5)) == 0).all()
    # Values of fewer than ten rows share a slice.
    rare = np.repeat([1.0, 2.0, 3.0, 4.0], [3, 480, 4, 513])
    assert np.bincount(slice_of(rare, cuts)).tolist() == [487, 513]
    rare = np.repeat([1.0, 2.0, 3.0, 4.0], [6, 480, 5, 509])
    assert sorted(np.bincount(slice_of(rare, cuts))) == [11, 480, 509]


@pytest.mark.parametrize("values", [2, 4])
def test_the_first_order_index_of_an_input_with_equal_values_is_the_known_one(values):
    rng = np.random.default_rng(3)
    for effect in (0.0, 0.3, 3.0):
        estimates = []
        for _ in range(20):
            x1, x2 = rng.random(N), rng.integers(0, values, N) / (values - 1)
            y = x1 + effect * (x2 - 0.5) ** 3 + 0.2 * (x2 - 0.5) * (x1 - 0.5)
            first, indices_ = estimated("rbd-fast", y, x1=x1, x2=x2)
            estimates.append([first["x1"], first["x2"]])
        level = np.arange(values) / (values - 1) - 0.5
        variances = np.array([1 / 12, np.var(effect * level**3), 0.04 / 12 * np.mean(level**2)])
        assert np.mean(estimates, axis=0) == pytest.approx(
            variances[:2] / variances.sum(), abs=0.006
        )
        assert indices_.notes[0].startswith("x2 has many equal values: shuffled 19 times")


def test_elements_share_the_first_order_index_of_an_input_with_equal_values():
    binary, x1, y = rows(0.4)
    x = np.column_stack([x1, binary])
    both = first_order(x, np.column_stack([y, 2 * x1]))
    each = [first_order(x, y)[1], first_order(x, x1)[1]]
    assert both[1] == pytest.approx(np.average(each, weights=[y.var(), 4 * x1.var()]))


def test_an_index_that_is_not_given_stands_as_a_dash_and_in_no_bar(uq, folder):
    text = """
[study]
name = "mixed"
model = "linear"
[design]
method = "monte-carlo"
samples = 256
[uncertain]
x1 = {distribution = "uniform", lower = 0.0, upper = 1.0}
x2 = {distribution = "discrete-choice", values = [0.0, 1.0], weights = [0.99, 0.01]}
"""
    (folder / "mixed.toml").write_text(text)
    assert uq("run", "mixed.toml", "-o", "mixed.nc", "--workers", 0).code == 0
    shown = uq("sensitivity", "mixed.nc", "--method", "rbd-fast")
    assert shown.code == 0 and "x2 has too few rows of any value but one" in " ".join(
        shown.out.split()
    )
    (axes,) = index_bars(open_result("mixed.nc"), "y", method="rbd-fast").axes
    assert sum(bar.get_width() > 0 for bar in axes.patches) == 1
    assert uq("report", "mixed.nc", "-o", "mixed.html").code == 0


def test_hdmr_takes_few_values_at_the_degree_that_they_allow():
    rng = np.random.default_rng(1)
    x1, x2 = rng.random(N), rng.integers(0, 2, N).astype(float)
    y = x1 + 2 * x2 + x1 * x2
    values_by_input, indices_ = estimated("hdmr", y, x1=x1, x2=x2)
    truth = np.array([1.5**2 / 12, 2.5**2 / 4, 1 / 48])
    assert [values_by_input["x1"], values_by_input["x2"]] == pytest.approx(
        list(truth[:2] / truth.sum()), abs=0.03
    )
    assert "polynomials of degree 1 " in indices_.notes[0]
    three = rng.integers(0, 3, N).astype(float)
    _, indices_ = estimated("hdmr", np.exp(x1) + three**2, x1=x1, x2=three)
    assert "polynomials of degree 2 " in indices_.notes[0]


@pytest.mark.parametrize(
    "labels", [[0.0, 1.0, 2.0, 3.0], [1.0, 3.0, 0.0, 2.0], [0.0, 9.0, 1.0, 10.0]]
)
def test_hdmr_of_a_choice_does_not_depend_on_what_its_values_are_called(labels):
    rng = np.random.default_rng(6)
    x1, choice = rng.random(N), rng.integers(0, 4, N)
    moved = np.array([0.0, 2.0, -1.0, 0.5])[choice]
    values_by_input, indices_ = estimated(
        "hdmr", moved + 3 * x1, x1=x1, x2=np.array(labels)[choice]
    )
    share = moved.var() / (moved.var() + 0.75)
    assert [values_by_input["x1"], values_by_input["x2"]] == pytest.approx(
        [1 - share, share], abs=0.03
    )
    assert "polynomials of degree" in indices_.notes[0]


def test_hdmr_says_which_input_keeps_it_from_a_higher_degree():
    binary, x1, _ = rows(0.5)
    with pytest.raises(RefusedError, match="x2 has 2 values, which allow no degree above 1"):
        of_plain_sample("hdmr", {"x1": x1, "x2": binary}, np.cos(7 * x1) + 0.1 * binary, {})
    with pytest.raises(RefusedError, match="x2 has the same value in all of 1024 rows"):
        of_plain_sample("hdmr", {"x1": x1, "x2": np.ones(N)}, x1, {})


@pytest.mark.parametrize("method", ["pawn", "delta", "quantile", "regional"])
def test_an_input_of_one_value_has_no_effect(method):
    ds = linear(samples=1000)
    ds = with_output(ds, "z", ds["x1"].values > 0.5 if method == "regional" else ds["x1"].values)
    x = {"x1": ds["x1"].values, "x2": np.ones(1000)}
    result = of_plain_sample(method, x, ds["z"].values, QUANTILES)
    for by_input in result.values.values():
        assert by_input["x2"].value == pytest.approx(0, abs=1e-12)


def test_an_imported_column_with_many_ties_is_judged_whatever_the_order_of_its_rows():
    ds = asking(linear(samples=600), outputs=["y"])
    rounded = ds.assign(x4=("row", np.round(ds["x4"].values * 12), ds["x4"].attrs))
    order = np.random.default_rng(0).permutation(600)
    for method in ("pawn", "delta"):
        once = indices(rounded, method)["outputs"]["y"][method]["x4"]["value"]
        again = indices(rounded.isel(row=order), method)["outputs"]["y"][method]["x4"]["value"]
        assert again == pytest.approx(once, rel=1e-9)
