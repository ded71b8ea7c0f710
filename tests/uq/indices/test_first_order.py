"""Shares that inputs explain alone, of plain samples: no bias, and intervals that cover."""

import numpy as np
import pytest
from answered import numbers_in
from computed import asking, linear, with_output
from scipy import special
from scipy.stats import qmc

from uq.assess.answer.answer import answer
from uq.assess.answer.rankings import unexplained
from uq.assess.sensitivities import methods
from uq.indices.index import S1, RefusedError
from uq.indices.method import DesignSample
from uq.indices.methods import METHODS, fed_by
from uq.indices.residual_variance import residual_variance
from uq.result.result import Result
from uq.sampling.designs import DESIGNS
from uq.stats.dependent_rows import Dependence

REPETITIONS = 40


def shares_of(y, replicate=None, **inputs):
    """Return the indices by the method that a plain sample feeds by default."""
    more = {} if replicate is None else {"dependence": Dependence(replicate)}
    sample = DesignSample.plain(np.asarray(y, float), inputs, **more)
    return METHODS[fed_by(DESIGNS["monte-carlo"])[0]].indices(sample)


def wear(u):
    return -0.5 * special.ndtri(u[:, 0]) + 0.1 * special.ndtri(u[:, 1]), 25 / 26


def defect(u):
    """In 3 % of the rows something breaks that explains 60 % of the variance."""
    size = np.sqrt(0.09 * 1.5 / (0.03 * 0.97))
    y = -size * (u[:, 0] < 0.03) + 0.3 * special.ndtri(u[:, 1])
    return y, 0.6


def hump(u):
    a, b = special.ndtri(u[:, 0]), special.ndtri(u[:, 1])
    return -(a**2) + 0.6 * b, 2 / 2.36


def step(u):
    return (u[:, 0] > 0.1) + u[:, 1], 0.09 / (0.09 + 1 / 12)


@pytest.mark.parametrize(
    ("function", "within"), [(wear, 0.002), (defect, 0.04), (hump, 0.02), (step, 0.02)]
)
def test_a_share_is_without_bias_and_its_interval_covers(function, within):
    """Random balance gives 0.948, 0.31, 0.73 and 0.46 instead of 0.962, 0.6, 0.85 and 0.52."""
    estimates, held = [], []
    for seed in range(REPETITIONS):
        u = np.random.default_rng(seed).random((1000, 2))
        y, truth = function(u)
        share = shares_of(y, a=u[:, 0], b=u[:, 1]).values[S1]["a"]
        estimates.append(share.value)
        held += [share.low <= truth <= share.high] if share.has_interval else []
    assert np.mean(estimates) == pytest.approx(truth, abs=within)
    assert len(held) >= REPETITIONS // 2 and np.mean(held) > 0.85


def test_a_jump_with_fewer_rows_beyond_than_lags_leaves_no_bias():
    """A parabola in up to 100 lags gives 0.229 of 40 rows beyond the jump."""
    rng = np.random.default_rng(1)
    x, noise = rng.random((10, 4000)), rng.normal(scale=0.5, size=(10, 4000))
    rows = zip(x, 5.0 * (x > 0.99) + noise, strict=True)
    left = [residual_variance(column, y[:, None]).variance for column, y in rows]
    assert np.mean(left) == pytest.approx(0.25, abs=0.006)


def test_values_that_rows_share_show_the_variance_that_is_left_exactly():
    rng = np.random.default_rng(0)
    x, y = rng.integers(0, 4, 400).astype(float), rng.normal(size=400)
    y += np.array([3.0, 0.0, 1.0, 7.0])[x.astype(int)]
    within = sum((x == k).mean() * y[x == k].var(ddof=1) for k in range(4))
    shuffled = rng.permutation(400)
    for order in (np.arange(400), shuffled):
        left = residual_variance(x[order], y[order, None]).variance
        assert left == pytest.approx(within, rel=1e-12)


def test_a_wave_of_fewer_rows_than_twice_the_lags_is_no_part_of_the_noise():
    """Of 15 rows a wave, eight lags alone covered in one sample of ten: 0.88 instead of 0.67."""
    held = []
    for seed in range(REPETITIONS):
        u = np.random.default_rng(seed).random((300, 2))
        y = np.sin(40 * np.pi * u[:, 0]) + 0.5 * special.ndtri(u[:, 1])
        try:
            index = shares_of(y, a=u[:, 0], b=u[:, 1]).values[S1]["a"]
        except RefusedError:
            continue
        held.append(index.low <= 2 / 3 <= index.high)
    assert len(held) > 0.8 * REPETITIONS and np.mean(held) > 0.85


def test_indices_that_add_up_to_more_than_1_are_refused():
    a, noise = np.random.default_rng(1).normal(size=(2, 300))
    with pytest.raises(RefusedError, match=r"S1 of all inputs add up to 1\.\d+ \(1\.\d+ to"):
        shares_of(a + 0.5 * noise, a=a, b=a + 0.01 * noise)


def lognormal(u):
    return np.exp(0.5 * special.ndtri(u).sum(axis=1)), 1 / (np.exp(0.25) + 1)


@pytest.mark.parametrize("function", [lognormal, defect])
def test_whether_an_index_has_an_interval_does_not_depend_on_the_values(function):
    """Samples that show twenty influential rows are not like the others."""
    held = []
    for seed in range(REPETITIONS):
        u = np.random.default_rng(seed).random((300, 2))
        y, truth = function(u)
        index = shares_of(y, a=u[:, 0], b=u[:, 1]).values[S1]["a"]
        held.append(index.low <= truth <= index.high)
    assert np.mean(held) > 0.85
    few = shares_of(y[:199], a=u[:199, 0], b=u[:199, 1])
    assert not any(index.has_interval for index in few.values[S1].values())


def test_what_no_single_input_explains_allows_for_one_more_influential_row():
    u = np.random.default_rng(0).random((300, 2))
    indices = shares_of(lognormal(u)[0], a=u[:, 0], b=u[:, 1])
    left, products = unexplained(indices), indices.half_products
    half = np.sqrt(sum(products[pair] * (1 + (pair[0] != pair[1])) for pair in products))
    assert left.low < left.value - 1.01 * half and left.high > left.value + 1.01 * half


def test_of_few_rows_no_index_has_an_interval_and_none_leads():
    """A jump that no row shows would leave the other input all of the variance: 1.000."""
    ds = linear(samples=150)
    ds = asking(with_output(ds, "y", 2.0 + ds["x2"].values, "lifetime"), outputs=["y"])
    ranking = answer(ds).lead.ranking
    assert ranking.leader is None and ranking.rows_factor >= 200 / 150
    assert ranking.sentence.endswith("has no interval: 200 rows are needed.")


def test_rows_of_a_sequence_are_compared_between_replicates():
    """Neighbours in one Sobol' sequence differ more than independent rows: 0.06 too low."""
    estimates = []
    for seed in range(12):
        u = np.vstack([qmc.Sobol(4, seed=8 * seed + k).random(64) for k in range(8)])
        y, part = u @ np.array([1.0, 2.0, 3.0, 4.0]), np.repeat(np.arange(8), 64)
        share = shares_of(y, part, a=u[:, 0], d=u[:, 3]).values[S1]["d"]
        assert share.low < 16 / 30 < share.high
        estimates.append(share.value)
    assert np.mean(estimates) == pytest.approx(16 / 30, abs=0.02)


def test_one_replicate_has_no_interval():
    ds = linear("sobol", samples=128)
    result = shares_of(ds["y"].values, ds["replicate"].values, x4=ds["x4"].values)
    assert not result.values[S1]["x4"].has_interval and result.nulls
    assert result.notes[0].startswith("the rows of one replicate depend on each other")


def product(of_pair):
    """Return log life = a b + 0.3 c + 0.05 e of normal inputs: ST of a and b is 0.92."""
    a, b, c, e = np.random.default_rng(5).normal(size=(4, 3000))
    ds = linear(samples=3000)
    columns = zip(("x1", "x2", "x3", "x4"), (a, b, c, e), strict=True)
    ds = ds.assign({name: ("row", column, ds[name].attrs) for name, column in columns})
    ds = with_output(ds, "life", np.exp(of_pair(a * b) + 0.3 * c + 0.05 * e), "lifetime")
    return asking(ds, outputs=["life"])


@pytest.mark.parametrize("of_pair", [np.array, np.sign])
def test_what_leads_alone_is_called_so_and_what_is_beyond_single_inputs_stated(of_pair):
    """Polynomials do not represent the sign of a product: the design that shows it is named."""
    conclusions = answer(product(of_pair))
    ranking = conclusions.lead.ranking
    assert ranking.sentence.startswith("x3 alone contributes most: ")
    assert ranking.contributions[0].inputs == ("x3",) and ranking.may_be_overturned
    ranking_json = conclusions.fact.json["quantities"]["life"]["ranking"]
    assert ranking_json["unexplained"]["value"] == pytest.approx(0.91, abs=0.06)
    *_, text = ranking.sentence.split("Single inputs leave ")
    assert numbers_in(text)[0] == round(100 * ranking_json["unexplained"]["value"])
    if of_pair is np.sign:
        assert "interactions could change the order; a 'saltelli' design shows them." in text
    else:
        assert list(ranking_json["totals"])[:2] in (["x1", "x2"], ["x2", "x1"])
        assert ranking_json["totals"]["x1"] == pytest.approx(0.92, abs=0.06)
    assert not any(advice.rule in ("measure", "source") for advice in conclusions.advice)


def test_random_balance_is_a_method_by_name_and_ranks_nothing():
    ds = linear(samples=400)
    assert methods(Result(ds)) == ("first-order",)
    asked = asking(ds, outputs=["y"], sensitivity=["rbd-fast"])
    assert methods(Result(asked)) == ("rbd-fast",)
    assert answer(asked).lead.ranking.method == "first-order"
    assert answer(asked).lead.ranking.contributions == answer(ds).lead.ranking.contributions
