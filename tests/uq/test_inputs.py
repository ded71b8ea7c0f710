"""Inputs that follow each other, are cut, or come from files: what rows they give, what is said."""

import numpy as np
import pytest
import xarray as xr
from computed import as_text, asking, computed, study_of
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from uq.analysis.realised import compare, realised_inputs, realised_ranks
from uq.analysis.statistics import summarise
from uq.errors import InputError
from uq.indices.sensitivities import sensitivities
from uq.inputs.dependence import correlated, matrix_problem
from uq.rows.sampling import row_block, rows
from uq.study.definition import load_study, study_from_text
from uq.study.file import LAW

UNIFORM = {"distribution": "uniform", "lower": 0.1, "upper": 0.9}
BELL = {"distribution": "normal", "mean": 0.5, "sd": 0.05}


def tables(uncertain, method="monte-carlo", samples=4096, model="linear", **more):
    return {
        "study": {"name": "inputs", "model": model},
        "design": {"method": method, "samples": samples, **more.pop("design", {})},
        "uncertain": uncertain,
        **more,
    }


def inputs_of(study):
    x = row_block(study, 0, rows(study)).x
    return dict(zip(study.model.parameter_names, x.T, strict=True))


def refusal(given, folder=None):
    with pytest.raises(InputError) as caught:
        study_from_text(as_text(given), "x.toml", folder=folder)
    (line,) = caught.value.lines
    return line.removeprefix("x.toml: ")


# --- laws that are cut, discrete or measured


@pytest.mark.parametrize(
    "entry",
    [
        BELL | {"truncate": [0.48, 0.7]},
        {"distribution": "gumbel", "mode": 0.5, "scale": 0.1, "truncate": [0.4, 0.8]},
        {"distribution": "weibull", "shape": 2.0, "scale": 0.5, "truncate": [0.4, 1.0]},
        {"distribution": "truncated-normal", "mean": 0.5, "sd": 1.0, "lower": 0.2, "upper": 0.9}
        | {"truncate": [0.0, 0.6]},
    ],
    ids=lambda entry: entry["distribution"],
)
def test_a_truncated_law_is_the_law_given_that_it_falls_between(entry):
    x = inputs_of(study_of(tables({"x1": entry}, "sobol")))["x1"]
    plain = LAW.validate_python({k: v for k, v in entry.items() if k != "truncate"}).frozen()
    low, high = entry["truncate"]
    low = max(low, entry.get("lower", low))
    share = (plain.cdf(x) - plain.cdf(low)) / (plain.cdf(high) - plain.cdf(low))
    assert low <= x.min() and x.max() <= high
    assert stats.kstest(share, "uniform").statistic < 2 / 4096


def test_discrete_laws_take_their_values_with_their_weights():
    entries = {
        "x1": {"distribution": "discrete-choice", "values": [0.5, 0.1], "weights": [3.0, 1.0]},
        "x2": {"distribution": "integer-range", "lower": 0, "upper": 1},
        "x3": {"distribution": "empirical", "values": [0.2, 0.4, 0.4, 0.9, 7.0]}
        | {"truncate": [0.0, 1.0]},
    }
    found = inputs_of(study_of(tables(entries, "sobol")))
    expected = {
        "x1": {0.1: 0.25, 0.5: 0.75},
        "x2": {0.0: 0.5, 1.0: 0.5},
        "x3": {0.2: 0.25, 0.4: 0.5, 0.9: 0.25},
    }
    for name, shares in expected.items():
        values, counts = np.unique(found[name], return_counts=True)
        assert dict(zip(values, counts / 4096, strict=True)) == pytest.approx(shares, abs=1e-3)


@given(
    values=st.lists(st.floats(0, 1), min_size=2, max_size=6, unique=True),
    ends=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    u=st.lists(st.floats(2.0**-54, 1 - 2.0**-53), min_size=1, max_size=5),
)
def test_a_discrete_law_gives_none_but_its_values(values, ends, u):
    from uq.inputs.conditioning import ppf_within

    law = LAW.validate_python({"distribution": "discrete-choice", "values": values})
    low, high = sorted(ends)
    inside = [value for value in values if low <= value <= high]
    if inside:
        assert set(ppf_within(law, np.array(u), (low, high))) <= set(inside)


def test_a_histogram_fills_its_bins_as_counted():
    entry = {"distribution": "histogram", "edges": [0.0, 0.2, 1.0], "counts": [3, 1]}
    x = inputs_of(study_of(tables({"x1": entry}, "sobol")))["x1"]
    assert (x < 0.2).mean() == pytest.approx(0.75, abs=1e-3)
    assert (x < 0.1).mean() == pytest.approx(0.375, abs=1e-3)


def test_values_outside_the_bounds_are_refused_with_a_remedy():
    entry = {"distribution": "discrete-choice", "values": [0.5, 2.0]}
    said = "has 0.5 of its probability outside the parameter's bounds, 0.0 to 1.0 [1]"
    remedy = "add truncate = [lower, upper] within them, or use other numbers"
    assert said in refusal(tables({"x1": entry})) and remedy in refusal(tables({"x1": entry}))
    wrong = entry | {"values": [2.0, 3.0]}
    assert "has no value within the parameter's bounds" in refusal(tables({"x1": wrong}))
    cut = BELL | {"truncate": [-1.0, 0.45]}
    assert study_of(tables({"x1": cut})).uncertain["x1"].truncate == (-1.0, 0.45)
    far = BELL | {"truncate": [80.0, 90.0]}
    assert "too extreme" in refusal(tables({"x1": far}))
    both = refusal(tables({"x1": BELL | {"truncate": [2.0, 1.0]}}))
    assert both.startswith("[uncertain.x1]: truncate must have lower < upper: [2.0, 1.0]")


# --- parameters that follow each other


def test_a_tied_parameter_has_the_value_of_the_other_and_no_column():
    study = study_of(tables({"x2": {"equals": "x1"}, "x1": UNIFORM}, "saltelli", 64))
    found = inputs_of(study)
    np.testing.assert_array_equal(found["x1"], found["x2"])
    assert rows(study) == 64 * 3
    ds = computed(study)
    assert ds["x2"].attrs["role"] == "input"
    # y = x1 + 2 x2 = 3 x1: all the variance is x1's.
    (entry,) = sensitivities(ds)["outputs"].values()
    assert entry["S1"].keys() == {"x1"} and entry["S1"]["x1"]["value"] == pytest.approx(1, abs=0.1)
    assert "x2 equals x1: the index of x1 is of both" in entry["notes"]


def test_a_scaled_parameter_is_the_other_times_a_factor_of_its_own():
    factor = {"distribution": "uniform", "lower": 0.4, "upper": 0.6, "times": "x1"}
    study = study_of(tables({"x2": factor, "x1": UNIFORM}, "saltelli", 1024))
    found = inputs_of(study)
    share = found["x2"] / found["x1"]
    assert 0.4 <= share.min() and share.max() <= 0.6
    assert abs(stats.spearmanr(share, found["x1"]).statistic) < 0.05
    # y = x1 (1 + 2 f): E(y|x1) = 2 x1, E(y|f) = (1 + 2 f)/2.
    (entry,) = sensitivities(computed(study))["outputs"].values()
    vx, vf = 0.8**2 / 12, 0.2**2 / 12
    total = (vx + 0.25) * (4 * vf + 4) - 1
    assert entry["S1"]["x1"]["value"] == pytest.approx(4 * vx / total, abs=0.02)
    assert entry["S1"]["x2"]["value"] == pytest.approx(4 * vf / 4 / total, abs=0.02)


def test_no_product_leaves_the_bounds():
    factor = {"distribution": "lognormal", "median": 1.0, "sigma": 0.02, "times": "x1"}
    study = study_of(tables({"x1": UNIFORM, "x2": factor}))
    assert inputs_of(study)["x2"].max() <= 1.0
    wide = refusal(tables({"x1": UNIFORM, "x2": factor | {"sigma": 0.1}}))
    # P(f > 1/x) for a lognormal f, averaged over x uniform on [0.1, 0.9].
    x = np.linspace(0.1, 0.9, 100_001)
    outside = stats.lognorm.sf(1 / x, 0.1).mean()
    assert wide.startswith(f"[uncertain.x2]: the product has {outside:.2g} of its probability")


@pytest.mark.parametrize(
    ("uncertain", "said"),
    [
        (
            {"x1": UNIFORM, "x2": {"equals": "x11"}},
            '[uncertain.x2] equals = "x11": is no uncertain parameter with its own law;'
            " did you mean 'x1'? (allowed: x1)",
        ),
        ({"x1": UNIFORM, "x2": {"equals": "x2"}}, "is the parameter itself"),
        (
            {"x1": UNIFORM, "x2": {"equals": "x1", "distribution": "normal"}},
            '[uncertain.x2] distribution = "normal": no such argument of x2\'s law'
            " (allowed: equals, source)",
        ),
        ({"x1": UNIFORM, "x2": {"equals": "x1"}, "x3": {"equals": "x2"}}, "(allowed: x1)"),
        ({"x1": UNIFORM, "x2": UNIFORM | {"times": "x3"}}, "(allowed: x1)"),
        (
            {"x1": {"distribution": "integer-range", "lower": 0, "upper": 1}}
            | {"x2": UNIFORM | {"times": "x1"}},
            '[uncertain.x2] times = "x1": must not change sign or be zero: lies within 0 to 1',
        ),
    ],
)
def test_what_cannot_be_followed_is_told(uncertain, said):
    assert said in refusal(tables(uncertain))


def test_what_is_tied_must_have_the_same_unit():
    depth = {"distribution": "uniform", "lower": 1e-5, "upper": 1e-4}
    entries = {"depth": depth, "rate": {"equals": "depth"}}
    said = refusal(tables(entries, model="exponential-wear"))
    assert "is in another unit, m, than 'rate', m s-1" in said


# --- rank correlations

CORRELATED = {
    "parameters": ["x3", "x1"],
    "rank_correlation": [[1.0, -0.7], [-0.7, 1.0]],
}


def test_rows_have_the_rank_correlations_and_laws_that_were_stated():
    entries = {
        "x1": UNIFORM,
        "x2": UNIFORM,
        "x3": {"distribution": "beta"} | dict(alpha=2.0, beta=5.0, lower=0.0, upper=1.0),
    }
    study = study_of(tables(entries, "sobol", 8192, dependence=CORRELATED))
    found = inputs_of(study)
    assert stats.spearmanr(found["x1"], found["x3"]).statistic == pytest.approx(-0.7, abs=2e-3)
    assert abs(stats.spearmanr(found["x1"], found["x2"]).statistic) < 2e-3
    for one in realised_inputs(study).values():
        assert one.distance < 2e-3
    assert realised_ranks(study)[0, 1] == pytest.approx(-0.7, abs=2e-3)


def test_three_inputs_have_all_three_correlations():
    ranks = ((1.0, 0.8, -0.3), (0.8, 1.0, 0.1), (-0.3, 0.1, 1.0))
    u = np.random.default_rng(1).random((100_000, 3))
    found = stats.spearmanr(correlated(u, ranks)).statistic
    np.testing.assert_allclose(found, ranks, atol=0.01)


@settings(deadline=None, max_examples=20)
@given(cuts=st.lists(st.integers(0, 64), max_size=4))
def test_dependent_rows_are_the_same_however_they_are_cut(cuts):
    factor = UNIFORM | {"times": "x1"}
    entries = {"x1": UNIFORM, "x2": factor, "x3": BELL, "x4": {"equals": "x3"}}
    study = study_of(tables(entries, samples=64, dependence=CORRELATED))
    edges = [0, *sorted(cuts), 64]
    parts = [row_block(study, i, j).x for i, j in zip(edges, edges[1:], strict=False)]
    assert np.concatenate(parts).tobytes() == row_block(study, 0, 64).x.tobytes()


@pytest.mark.parametrize(
    ("ranks", "said"),
    [
        (((1.0, 0.5),), "must have 2 rows of 2 numbers"),
        (((1.0, 0.5), (0.5, 0.9)), "must be 1: that of 'b' with itself"),
        (((1.0, 0.5), (0.4, 1.0)), "must be the same as [1][0] = 0.4"),
        (((1.0, 1.0), (1.0, 1.0)), "must lie between -1 and 1; for 1 use equals"),
    ],
)
def test_a_matrix_that_is_none_says_what_is_wrong(ranks, said):
    assert said in matrix_problem(("a", "b"), ranks).text


def test_a_near_miss_is_told_what_would_do():
    ranks = ((1.0, 0.9, 0.1), (0.9, 1.0, 0.9), (0.1, 0.9, 1.0))
    problem = matrix_problem(("a", "b", "c"), ranks)
    assert problem.text == (
        "no inputs can have these rank correlations together; as the others are,"
        " that of 'a' with 'b', 0.9, must lie between -0.308 and 0.494"
    )
    for entry, good in ((-0.309, False), (-0.308, True), (0.494, True), (0.495, False)):
        mended = ((1.0, entry, 0.1), (entry, 1.0, 0.9), (0.1, 0.9, 1.0))
        assert (matrix_problem(("a", "b", "c"), mended) is None) == good
    # Four inputs of which no two can be made to fit by one entry alone.
    ranks = tuple(tuple(1.0 if i == j else -0.6 for j in range(4)) for i in range(4))
    assert "multiplied by 0.53 or less" in matrix_problem(tuple("abcd"), ranks).text
    weaker = tuple(tuple(1.0 if i == j else -0.6 * 0.53 for j in range(4)) for i in range(4))
    assert matrix_problem(tuple("abcd"), weaker) is None


@pytest.mark.parametrize("method", ["saltelli", "morris", "fast"])
def test_designs_for_independent_inputs_are_refused_and_others_named(method):
    entries = {"x1": UNIFORM, "x3": UNIFORM}
    said = refusal(tables(entries, method, 128, dependence=CORRELATED))
    assert said.startswith(f'[design] method = "{method}": supposes independent inputs')
    assert "use monte-carlo or latin-hypercube" in said and "delta and pawn" in said


def test_methods_for_independent_inputs_are_refused_and_others_named():
    given = tables({"x1": UNIFORM, "x3": UNIFORM}, samples=256, dependence=CORRELATED)
    said = refusal(given | {"analysis": {"sensitivity": ["rbd-fast"]}})
    assert said.startswith('[analysis] sensitivity = "rbd-fast": supposes independent inputs')
    assert said.endswith("those that do not are 'delta' or 'pawn' or 'quantile' or 'regional'")
    ds = computed(study_of(given))
    assert sensitivities(ds)["method"] == "delta"
    with pytest.raises(InputError, match="'rbd-fast' supposes independent inputs.*delta, pawn, "):
        sensitivities(ds, "rbd-fast")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"parameters": ["x3", "x9"]}, '[dependence] parameters = "x9": is not uncertain'),
        ({"parameters": ["x3", "x2"]}, "follows another parameter already"),
        ({"parameters": ["x3", "x3"]}, '"x3" is listed twice'),
        ({"rank_corelation": 1}, "did you mean 'rank_correlation'?"),
    ],
)
def test_a_wrong_dependence_is_told(changes, said):
    entries = {"x1": UNIFORM, "x2": {"equals": "x1"}, "x3": UNIFORM}
    assert said in refusal(tables(entries, dependence=CORRELATED | changes))


# --- files


@pytest.fixture
def springs(tmp_path):
    """Return a folder with a study and the measurements that it names."""
    (tmp_path / "springs.csv").write_text("k, note\n0.25, a\n0.5, b\n0.75, c\n0.5, d\n")
    entry = {"distribution": "empirical", "file": "springs.csv", "column": "k"}
    (tmp_path / "study.toml").write_text(as_text(tables({"x1": entry, "x2": UNIFORM})))
    return tmp_path


def test_an_empirical_law_draws_the_values_of_the_column(springs):
    found = inputs_of(load_study(springs / "study.toml"))["x1"]
    assert set(found) == {0.25, 0.5, 0.75}
    assert (found == 0.5).mean() == pytest.approx(0.5, abs=0.04)


def test_a_result_needs_no_file(springs):
    study = load_study(springs / "study.toml")
    ds = computed(study)
    (springs / "springs.csv").unlink()
    again = study_from_text(ds.attrs["study"])
    assert again.identity == study.identity and again.text == study.text
    assert row_block(again, 0, 64).x.tobytes() == row_block(study, 0, 64).x.tobytes()


def test_the_identity_is_of_what_the_file_holds_not_of_its_name(springs):
    study = load_study(springs / "study.toml")
    text = (springs / "study.toml").read_text()
    (springs / "springs.csv").rename(springs / "other.csv")
    (springs / "study.toml").write_text(text.replace("springs.csv", "other.csv"))
    assert load_study(springs / "study.toml").identity == study.identity
    (springs / "other.csv").write_text("k\n0.25\n0.5\n0.75\n0.6\n")
    assert load_study(springs / "study.toml").identity != study.identity


@pytest.mark.parametrize(
    ("held", "said"),
    [
        (None, "no such file in"),
        ("", "has no column 'k' (its columns: none)"),
        ("kk\n1\n", "has no column 'k'; did you mean 'kk'? (its columns: kk)"),
        ("k,k\n1,2\n", "has several columns 'k'"),
        ("k\n0.5\nabc\n", "line 3: column 'k' must be a finite number: 'abc'"),
        ("k\n0.5\nnan\n", "line 3: column 'k' must be a finite number: 'nan'"),
        ("k\n", "has 0 rows (allowed: 1 to 1000000)"),
        ("k\n0.5\n0.5\n", "needs two different values at least"),
        ('k\n"0.5\n', "not CSV"),
    ],
)
def test_a_file_that_is_no_use_is_one_line(springs, held, said):
    (springs / "springs.csv").unlink()
    if held is not None:
        (springs / "springs.csv").write_text(held)
    with pytest.raises(InputError) as caught:
        load_study(springs / "study.toml")
    (line,) = caught.value.lines
    assert said in line and line.startswith(f"{springs}/study.toml: [uncertain.x1] ")


@pytest.fixture
def table(tmp_path):
    """Return a folder with rows to import, as CSV and as netCDF."""
    x = np.random.default_rng(3).uniform(0.1, 0.9, (100, 2))
    lines = ["x2,x1", *(f"{a!r},{b!r}" for b, a in x.tolist())]
    (tmp_path / "rows.csv").write_text("\n".join(lines))
    xr.Dataset({"x1": ("n", x[:, 0]), "x2": ("n", x[:, 1])}).to_netcdf(tmp_path / "rows.nc")
    return tmp_path, x


def imported(file="rows.csv", uncertain=None, **more):
    entries = {"x1": UNIFORM, "x2": UNIFORM} if uncertain is None else uncertain
    design = {"file": file} if file else {}
    return tables(entries, "imported", 100, design=design | more)


@pytest.mark.parametrize("file", ["rows.csv", "rows.nc"])
def test_imported_rows_are_those_of_the_file_to_the_bit(table, file):
    folder, x = table
    text = as_text(imported(file, {"x1": UNIFORM, "x2": UNIFORM, "x4": {"equals": "x2"}}))
    study = study_from_text(text, folder=folder)
    found = row_block(study, 0, 100).x
    np.testing.assert_array_equal(found[:, [0, 1, 3]], x[:, [0, 1, 1]])
    np.testing.assert_array_equal(row_block(study, 30, 31).x, found[30:31])
    ds = computed(study)
    assert sensitivities(ds)["method"] == "delta"
    assert summarise(ds)["outputs"]["y"]["mean_interval"]["low"] is None
    again = study_from_text(ds.attrs["study"])
    assert again.identity == study.identity
    np.testing.assert_array_equal(row_block(again, 0, 100).x, found)
    with pytest.raises(InputError, match="--samples 101: the file has 100 rows for 'imported'"):
        study.with_samples(101)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (imported(None), "[design] file: is missing: a CSV or netCDF file with the rows"),
        (imported("row.csv"), "did you mean 'rows.csv'?"),
        (imported(uncertain={"x3": UNIFORM}), "has no column 'x3'"),
        (imported(replicates=2), "[design] replicates = 2: must be 1 for 'imported'"),
        (imported(samples=101), "[design] samples = 101: the file has 100 rows"),
        (imported(uncertain={"x1": UNIFORM | {"times": "x2"}, "x2": UNIFORM}), "take it out"),
        (
            imported()
            | {
                "dependence": {"parameters": ["x1", "x2"]}
                | dict(rank_correlation=[[1.0, 0.5], [0.5, 1.0]])
            },
            "imported rows are as dependent as they are",
        ),
        (tables({"x1": UNIFORM}, design={"file": "rows.csv"}), "only for method = 'imported'"),
    ],
)
def test_what_cannot_be_imported_is_one_line(table, given, said):
    assert said in refusal(given, table[0])


def test_imported_values_must_lie_within_the_bounds(table):
    (table[0] / "rows.csv").write_text("x1,x2\n" + "0.5,0.5\n" * 50 + "1.5,0.5\n" * 50)
    said = refusal(imported(), table[0])
    assert "'x1' = 1.5 in row 51 is outside the parameter's bounds, 0.0 to 1.0 [1]" in said


# --- as stated, as realised


def test_the_distance_is_that_of_kolmogorov_and_smirnov():
    law = LAW.validate_python(BELL)
    x = np.random.default_rng(1).normal(0.52, 0.05, 500)
    exact = stats.kstest(x, stats.norm(0.5, 0.05).cdf).statistic
    assert compare(law, x).distance == pytest.approx(exact, rel=1e-12)
    die = LAW.validate_python({"distribution": "integer-range", "lower": 1, "upper": 6})
    assert compare(die, np.repeat(np.arange(1.0, 7.0), 10)).distance == pytest.approx(0)
    assert compare(die, np.ones(10)).distance == pytest.approx(5 / 6)


def test_check_shows_what_the_rows_make_of_the_laws(uq, write_study):
    more = """
        x4 = {equals = "x1"}
        [dependence]
        parameters = ["x1", "x2"]
        rank_correlation = [[1.0, 0.5], [0.5, 1.0]]
    """
    path = write_study("linear", "sobol", 1024, more=more)
    shown = uq("check", path).out
    assert "equals x1" in shown and "delta, pawn, quantile, regional can be had" in shown
    lines = [line.split() for line in shown.splitlines()]
    assert ["x1", "stated", "0.14", "0.5", "0.86"] in lines
    (pair,) = [line for line in lines if line[:2] == ["x1,", "x2"]]
    assert float(pair[2]) == 0.5 and float(pair[3]) == pytest.approx(0.5, abs=0.01)
    trajectories = write_study("linear", "morris", 4, name="steps")
    assert "do not follow these laws" in uq("check", trajectories).out


def test_a_figure_shows_each_input_as_stated_and_as_the_rows_have_it():
    from uq.drawing.input_plot import inputs

    entries = {"x1": BELL, "x2": UNIFORM | {"times": "x1"}, "x3": {"equals": "x1"}}
    figure = inputs(computed(study_of(tables(entries, "sobol", 4096))))
    assert [axes.get_xlabel() for axes in figure.axes] == [
        "Independent input (x_1)",
        "Independent input: factor on x1",
    ]
    for axes in figure.axes:
        found, stated = (patch.get_data().values for patch in axes.patches)
        np.testing.assert_allclose(found, stated, atol=2e-3)
        assert stated.sum() == pytest.approx(1, abs=1e-3)
    assert inputs(computed(study_of(tables({"x1": BELL}, "morris", 4)))) is None


def test_asking_of_a_result_still_works_with_files(springs):
    ds = computed(load_study(springs / "study.toml"))
    assert list(asking(ds, outputs=["y"]).attrs) == list(ds.attrs)
