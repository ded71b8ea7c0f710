"""Copulas of two inputs against closed forms, quadrature and OpenTURNS, and their rows."""

import mpmath
import numpy as np
import openturns as ot
import pytest
from computed import as_text, computed, study_of
from hypothesis import given, settings
from hypothesis import strategies as st
from input_studies import BELL, UNIFORM, inputs_of, refusal, tables
from scipy import stats

from uq.assess.row_inputs import correlated_inputs
from uq.errors import InputError
from uq.result.result import Result
from uq.sampling.copulas import (
    COPULAS,
    ClaytonPair,
    FrankPair,
    GumbelPair,
    NormalPair,
    StudentPair,
    SurvivalPair,
    copula_of_rank,
)
from uq.sampling.unit_cube import inside
from uq.study.row_sampling import row_block, rows

THETA, R, NU = 2.5, 0.6, 4.0
PAIRS = {
    "normal": NormalPair(R),
    "student": StudentPair(R, NU),
    "clayton": ClaytonPair(THETA),
    "gumbel": GumbelPair(THETA),
    "frank": FrankPair(THETA),
    "frank, negative": FrankPair(-6.0),
    "student, negative": StudentPair(-0.5, 3.0),
    "clayton, survival": SurvivalPair(ClaytonPair(THETA)),
    "gumbel, survival": SurvivalPair(GumbelPair(THETA)),
}
EACH = pytest.mark.parametrize("copula", PAIRS.values(), ids=PAIRS)


def by_openturns(copula):
    """Return the same copula of OpenTURNS."""
    if isinstance(copula, SurvivalPair):
        return None
    if isinstance(copula, NormalPair):
        return ot.NormalCopula(ot.CorrelationMatrix([[1.0, R], [R, 1.0]]))
    if isinstance(copula, StudentPair):
        r = copula.correlation
        return ot.StudentCopula(copula.freedom, ot.CorrelationMatrix([[1.0, r], [r, 1.0]]))
    archimedean = {ClaytonPair: ot.ClaytonCopula, GumbelPair: ot.GumbelCopula}
    return archimedean.get(type(copula), ot.FrankCopula)(copula.theta)


def points(n=400, seed=1):
    return np.random.default_rng(seed).uniform(0.01, 0.99, (2, n))


@EACH
def test_conditional_law_density_and_joint_law_are_derivatives_of_each_other(copula):
    u, v = points(60)
    step = 1e-5
    slope = (copula.joint(u + step, v) - copula.joint(u - step, v)) / (2 * step)
    np.testing.assert_allclose(copula.conditional(v, u), slope, atol=2e-6)
    slope = (copula.conditional(v + step, u) - copula.conditional(v - step, u)) / (2 * step)
    np.testing.assert_allclose(np.exp(copula.log_density(u, v)), slope, rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(copula.joint(u, v), copula.joint(v, u), atol=1e-8)


@EACH
def test_values_agree_with_openturns(copula):
    other = by_openturns(copula)
    if other is None:  # of 1 - u and 1 - v, whose copula is in this list
        return
    u, v = points(40)
    pairs = np.stack([u, v], axis=1)
    joint = np.array(other.computeCDF(pairs))[:, 0]
    # Quadrature to 1e-13 shows OpenTURNS' joint law of Student off by 3e-7, and negative for r < 0.
    student = isinstance(copula, StudentPair)
    if student and copula.correlation < 0:
        positive = StudentPair(-copula.correlation, copula.freedom)
        joint = u - positive.joint(u, 1 - v)
    np.testing.assert_allclose(copula.joint(u, v), joint, atol=1e-6 if student else 1e-8)
    density = np.array(other.computePDF(pairs))[:, 0]
    np.testing.assert_allclose(np.exp(copula.log_density(u, v)), density, rtol=1e-8)
    given_u = [[at] for at in u]
    conditional = other.computeConditionalCDF(v.tolist(), given_u)
    np.testing.assert_allclose(copula.conditional(v, u), conditional, atol=1e-9)
    quantile = other.computeConditionalQuantile(v.tolist(), given_u)
    np.testing.assert_allclose(copula.conditional_quantile(v, u), quantile, atol=1e-9)


@EACH
def test_conditional_quantiles_are_the_inverse(copula):
    u, w = points(4000)
    v = copula.conditional_quantile(w, u)
    kept = (v > 1e-9) & (v < 1 - 1e-4)  # else v itself is rounded too much
    np.testing.assert_allclose(copula.conditional(v, u)[kept], w[kept], rtol=1e-9)


@pytest.mark.parametrize("theta", [1.5, 2.5, 20.0])
def test_quantiles_of_gumbel_keep_their_digits_in_the_upper_tail(theta):
    copula, u = GumbelPair(theta), points()[0]
    for above in (1e-8, 1e-12):
        w = np.full(len(u), 1 - above)
        back = copula.conditional(copula.conditional_quantile(w, u), u)
        np.testing.assert_allclose(np.log(back), np.log(w), rtol=1e-5)


@pytest.mark.parametrize("name", list(COPULAS))
@pytest.mark.parametrize("rank", [0.001, 0.05, 0.5, 0.9, 0.999, -0.7])
def test_corners_of_the_unit_square_are_finite(name, rank):
    """The smallest and largest points that a design can draw, under any strength."""
    if rank < 0 and name in ("clayton", "gumbel"):
        return
    ends = np.array([2.0**-54, 1e-8, 0.5, 1 - 1e-8, 1 - 2.0**-53])
    u, w = (grid.ravel().copy() for grid in np.meshgrid(ends, ends))
    for freedom in (1.0, 4.0, 1000.0) if name == "student" else (None,):
        copula = copula_of_rank(name, rank, freedom)
        for one_of in (copula, SurvivalPair(copula)):
            with np.errstate(all="raise", under="ignore"):
                v = inside(one_of.conditional_quantile(w, u))
                below = one_of.conditional(v, u)
                density = one_of.log_density(u, v)
            assert ((v > 0) & (v < 1) & (below >= 0) & (below <= 1)).all()
            assert np.isfinite(density).all()


def mean_product(copula, step=0.04):
    """Return Spearman's correlation from 12 E[U V] - 3, over normal scores (trapezoidal rule)."""
    z = np.arange(-8.0, 8.0, step)
    weight = stats.norm.pdf(z) * step
    p = stats.norm.cdf(z)
    means = [
        p[i] * weight @ copula.conditional_quantile(p, np.full(len(p), p[i])) for i in range(len(p))
    ]
    return 12 * float(weight @ np.array(means)) - 3


@pytest.mark.parametrize(
    "copula",
    [StudentPair(0.6, 4.0), StudentPair(-0.5, 12.0), ClaytonPair(0.7), GumbelPair(1.7)]
    + [FrankPair(-4.0), SurvivalPair(ClaytonPair(0.7)), NormalPair(0.6)],
    ids=str,
)
def test_rank_correlations_are_those_of_the_copula(copula):
    assert copula.rank_correlation == pytest.approx(mean_product(copula), abs=1e-9)


def test_rank_correlations_of_heavy_tails_and_strong_dependence():
    """Against Debye's functions, Pickands' integral, the normal limit, and independent draws."""
    mpmath.mp.dps = 20

    def debye(n, x):
        integral = mpmath.quad(lambda t: t**n / mpmath.expm1(t), [0, 1, x / 4, x])
        return n / mpmath.mpf(x) ** n * integral

    for theta in (0.01, 3.0, 100.0):
        truth = 1 - 12 / mpmath.mpf(theta) * (debye(1, theta) - debye(2, theta))
        assert FrankPair(theta).rank_correlation == pytest.approx(float(truth), abs=1e-13)
    for theta in (1.001, 3.0, 40.0):
        truth = 12 * mpmath.quad(
            lambda t, power=theta: (1 + (t**power + (1 - t) ** power) ** (1 / power)) ** -2,
            [0, 0.45, 0.5, 0.55, 1],
        )
        assert GumbelPair(theta).rank_correlation == pytest.approx(float(truth) - 3, abs=1e-12)
    for theta in (0.001, 3.0, 80.0):
        other = ot.ClaytonCopula(theta).getSpearmanCorrelation()[0, 1]
        assert ClaytonPair(theta).rank_correlation == pytest.approx(other, abs=1e-7)
    near = [
        StudentPair(0.5, nu).rank_correlation - NormalPair(0.5).rank_correlation
        for nu in (500.0, 1000.0)
    ]
    assert near[0] == pytest.approx(2 * near[1], rel=0.01) and abs(near[1]) < 3e-4
    for nu in (1.0, 2.0):
        copula = StudentPair(0.8, nu)
        u, w = (column.copy() for column in stats.qmc.Sobol(2, seed=3).random(2**15).T)
        sampled = 12 * np.mean((u - 0.5) * (copula.conditional_quantile(w, u) - 0.5))
        assert copula.rank_correlation == pytest.approx(sampled, abs=2e-4)


@settings(max_examples=25, deadline=None)
@given(
    name=st.sampled_from(sorted(COPULAS)),
    rank=st.floats(0.001, 0.999),
    freedom=st.floats(1.0, 1000.0),
)
def test_a_copula_has_the_rank_correlation_that_was_asked_for(name, rank, freedom):
    freedom = freedom if name == "student" else None
    assert copula_of_rank(name, rank, freedom).rank_correlation == pytest.approx(rank, abs=1e-12)
    if name in ("student", "frank", "normal"):
        other = copula_of_rank(name, -rank, freedom)
        assert other.rank_correlation == pytest.approx(-rank, abs=1e-12)


@EACH
def test_tail_dependence_is_the_limit_of_the_joint_law(copula):
    lower, upper = copula.tails
    for tail, side in ((lower, copula), (upper, SurvivalPair(copula))):
        q = np.array([1e-5, 1e-8])
        if isinstance(copula, NormalPair | StudentPair):  # slowly approached, or by quadrature
            q = np.array([1e-4, 1e-5])
        shares = side.joint(q, q) / q
        if tail:
            assert shares[1] == pytest.approx(tail, abs=0.03)
        else:
            assert shares[1] < max(0.8 * shares[0], 1e-3)
    assert PAIRS["clayton"].tails == (2 ** (-1 / THETA), 0.0)
    assert PAIRS["gumbel"].tails == (0.0, 2 - 2 ** (1 / THETA))
    assert PAIRS["clayton, survival"].tails == (0.0, 2 ** (-1 / THETA))


DEPENDENT = {"parameters": ["x3", "x1"], "rank_correlation": [[1.0, 0.6], [0.6, 1.0]]}
TABLES = {
    "student": {"copula": "student", "degrees_of_freedom": 3.0},
    "clayton": {"copula": "clayton"},
    "survival clayton": {"copula": "clayton", "survival": True},
    "gumbel": {"copula": "gumbel"},
    "frank": {"copula": "frank"},
}
EVERY = pytest.mark.parametrize("copula", TABLES.values(), ids=TABLES)


def dependent(copula, method="sobol", samples=8192, uncertain=None, **more):
    entries = uncertain or {"x1": UNIFORM, "x2": UNIFORM, "x3": BELL | {"truncate": [0.4, 0.55]}}
    return study_of(tables(entries, method, samples, dependence=DEPENDENT | copula, **more))


@EVERY
@pytest.mark.parametrize("method", ["sobol", "latin-hypercube", "monte-carlo", "halton"])
def test_rows_have_the_copula_and_laws_that_were_stated(copula, method):
    study = dependent(copula, method)
    inputs = inputs_of(study)
    exact = method in ("sobol", "halton")
    assert stats.spearmanr(inputs["x1"], inputs["x3"]).statistic == pytest.approx(
        0.6, abs=5e-3 if exact else 0.03
    )
    assert abs(stats.spearmanr(inputs["x1"], inputs["x2"]).statistic) < 0.03
    u = (inputs["x1"] - 0.1) / 0.8
    law = stats.truncnorm(-2.0, 1.0, loc=0.5, scale=0.05)
    v = law.cdf(inputs["x3"])
    for points_of in (u, v):
        assert stats.kstest(points_of, "uniform").statistic < (0.01 if exact else 0.02)
    # Which of the two corners has more rows.
    lower, upper = np.mean((u < 0.1) & (v < 0.1)), np.mean((u > 0.9) & (v > 0.9))
    corner = {"clayton": 1, "survival clayton": -1, "gumbel": -1}
    names = ("survival " * copula.get("survival", False)) + copula["copula"]
    assert (lower - upper) * corner.get(names, 0) >= 0
    assert abs(lower - upper) > 0.01 or names not in corner
    expected = study.dependence.pair
    for a, b in ((0.02, 0.02), (0.1, 0.1), (0.5, 0.2), (0.9, 0.9), (0.98, 0.98)):
        share = np.mean((u <= a) & (v <= b))
        truth = float(expected.joint(np.array([a]), np.array([b]))[0])
        assert abs(share - truth) < 4.5 * np.sqrt(truth * (1 - truth) / len(u)) + 1e-4


@EVERY
@settings(max_examples=8, deadline=None)
@given(cuts=st.lists(st.integers(0, 64), max_size=4))
@pytest.mark.parametrize("method", ["monte-carlo", "shapley"])
def test_rows_are_the_same_however_they_are_cut(copula, method, cuts):
    factor = UNIFORM | {"times": "x1"}
    entries = {"x1": UNIFORM, "x2": factor, "x3": BELL, "x4": {"equals": "x3"}}
    study = dependent(copula, method, 16, entries)
    last = rows(study)
    edges = [0, *sorted(min(cut, last) for cut in cuts), last]
    parts = [row_block(study, i, j).x for i, j in zip(edges, edges[1:], strict=False)]
    assert np.concatenate(parts).tobytes() == row_block(study, 0, last).x.tobytes()


def test_the_normal_copula_is_the_default_and_keeps_its_rows_and_identity():
    plain = dependent({}, samples=64)
    named = dependent({"copula": "normal"}, samples=64)
    assert plain.identity == named.identity != dependent({"copula": "frank"}, samples=64).identity
    assert row_block(plain, 0, 64).x.tobytes() == row_block(named, 0, 64).x.tobytes()
    assert len({dependent(copula, samples=64).identity for copula in TABLES.values()}) == len(
        TABLES
    )


NEGATIVE = {"rank_correlation": [[1.0, -0.6], [-0.6, 1.0]]}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"copula": "clayton"} | NEGATIVE,
            "[dependence] rank_correlation = -0.6: must be between 0.001 and 0.999 for copula ="
            ' "clayton"; for a negative one use "student", "frank" or "normal"',
        ),
        ({"copula": "gumbel"} | NEGATIVE, 'between 0.001 and 0.999 for copula = "gumbel"'),
        ({"copula": "claiton"}, "no such copula; did you mean 'clayton'?"),
        ({"copula": "student"}, 'degrees_of_freedom: is missing for "student": a number from 1'),
        (
            {"copula": "student", "degrees_of_freedom": 0.5},
            "[dependence] degrees_of_freedom = 0.5: must be a number from 1 to 1000",
        ),
        (
            {"copula": "clayton", "degrees_of_freedom": 4.0},
            '[dependence] degrees_of_freedom = 4.0: is only for copula = "student"',
        ),
        ({"survival": True}, 'is only for copula = "clayton", "gumbel"'),
        ({"copula": "frank", "survival": True}, '"frank" has the same tails above and below'),
        (
            {"copula": "frank", "rank_correlation": [[1.0, 0.0], [0.0, 1.0]]},
            "must be 0.001 or more from 0",
        ),
        (
            {"copula": "gumbel", "rank_correlation": [[1.0, 0.9999], [0.9999, 1.0]]},
            "must be between 0.001 and 0.999",
        ),
        (
            {
                "copula": "gumbel",
                "parameters": ["x1", "x2", "x3"],
                "rank_correlation": [[1.0, 0.5, 0.5], [0.5, 1.0, 0.5], [0.5, 0.5, 1.0]],
            },
            '[dependence] copula = "gumbel": is for two parameters, and there are 3; use "normal"',
        ),
    ],
)
def test_a_wrong_copula_is_refused_in_one_line(changes, message):
    entries = {"x1": UNIFORM, "x2": UNIFORM, "x3": UNIFORM}
    assert message in refusal(tables(entries, dependence=DEPENDENT | changes))


def test_a_misspelt_copula_is_the_only_fault_of_its_table():
    entries, options = {"x1": UNIFORM, "x3": UNIFORM}, {"copula": "claiton", "survival": True}
    assert "did you mean 'clayton'" in refusal(tables(entries, dependence=DEPENDENT | options))
    options = {"copula": "student", "degrees_of_freedom": "four"}
    assert "must be a number" in refusal(tables(entries, dependence=DEPENDENT | options))


def test_the_command_line_states_the_copula_and_its_tails(uq, tmp_path):
    path, result = tmp_path / "pair.toml", tmp_path / "pair.nc"
    options = {"copula": "clayton", "survival": True}
    path.write_text(
        as_text(tables({"x1": UNIFORM, "x3": BELL}, samples=200, dependence=DEPENDENT | options))
    )
    lower, upper = copula_of_rank("clayton", 0.6).tails
    shown = " ".join(uq("check", path).out.split())
    assert f"survival Clayton copula; tail dependence: lower {upper:g}, upper {lower:.5g}" in shown
    assert uq("run", path, "-o", result, "--quiet").code == 0
    changes = ("--set", "dependence.copula=student", "--set", "dependence.degrees_of_freedom=9")
    ended = uq("what-if", result, *changes)
    assert ended.out.count("as studied: survival Clayton copula") == 1, ended.err
    assert "copula; survival" not in " ".join(ended.out.split())


def test_inputs_without_rank_correlation_may_depend_on_each_other():
    """Student's copula has dependent tails, whatever the rank correlation."""
    options = {"copula": "student", "degrees_of_freedom": 2.0}
    nothing = {"rank_correlation": [[1.0, 0.0], [0.0, 1.0]]}
    study = dependent(options | nothing, "monte-carlo", 4000)
    assert study.dependence.pair.correlation == 0.0
    u, v = (stats.rankdata(inputs_of(study)[name]) / 4000 - 0.5 for name in ("x1", "x3"))
    assert abs(np.corrcoef(u, v)[0, 1]) < 0.05 < np.corrcoef(np.abs(u), np.abs(v))[0, 1]
    related = correlated_inputs(Result(computed(study)))
    assert related == {"x3": ("x1",), "x1": ("x3",)}


def test_an_invalid_copula_in_a_result_is_refused():
    """The text of a study may have been edited in the file of a result."""
    ds = computed(dependent({"copula": "gumbel"}, "monte-carlo", 64))
    for good, bad in (
        ('copula = "gumbel"', 'copula = "student"'),
        ("[[1.0, 0.6], [0.6, 1.0]]", "[[1.0]]"),
        ("[[1.0, 0.6], [0.6, 1.0]]", "[[1.0, -0.6], [-0.6, 1.0]]"),
    ):
        assert good in ds.attrs["study"]
        edited = ds.assign_attrs(study=ds.attrs["study"].replace(good, bad))
        with pytest.raises(InputError, match=r"^\[dependence\] "):
            correlated_inputs(Result(edited))


def test_several_tables_are_refused():
    assert "must be a table" in refusal(
        tables({"x1": UNIFORM, "x3": UNIFORM}) | {"dependence": [DEPENDENT, DEPENDENT]}
    )
