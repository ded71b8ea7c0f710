"""The analytic models are the functions they claim to be, and fail only where asked to."""

from math import pi

import numpy as np
import pytest

from models.analytic import EXPONENTIAL_WEAR, G_FUNCTION, ISHIGAMI, LINEAR, LinearSettings
from uq.contract import Status

MODELS = [ISHIGAMI, G_FUNCTION, LINEAR, EXPONENTIAL_WEAR]
A = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0])


def evaluate(model, x, settings=None):
    x = np.asarray(x, dtype=float)
    return model.batch(x, np.zeros(len(x), np.uint64), settings or model.settings())


def grid(nodes, weights, d):
    """Return points and weights of a product rule."""
    x = np.stack(np.meshgrid(*[nodes] * d, indexing="ij"), axis=-1).reshape(-1, d)
    w = np.stack(np.meshgrid(*[weights] * d, indexing="ij"), axis=-1).reshape(-1, d).prod(axis=1)
    return x, w / w.sum()


def moments(model, x, w):
    y = evaluate(model, x)[0]["y"]
    mean = w @ y
    return mean, w @ (y - mean) ** 2


def first_order_variance(model, x, w, i):
    """Return the variance of the mean given input i, by the same rule."""
    y = evaluate(model, x)[0]["y"]
    group = np.unique(x[:, i], return_inverse=True)[1]
    share = np.bincount(group, w)
    conditional = np.bincount(group, w * y) / share
    return share @ (conditional - w @ y) ** 2


def test_ishigami_has_its_published_moments_and_indices():
    nodes, weights = np.polynomial.legendre.leggauss(24)
    x, w = grid(pi * nodes, weights, 3)
    variance = 7**2 / 8 + 0.1 * pi**4 / 5 + 0.1**2 * pi**8 / 18 + 1 / 2
    assert moments(ISHIGAMI, x, w) == pytest.approx((3.5, variance), rel=1e-10)
    published = [0.3139, 0.4424, 0.0]
    for i, index in enumerate(published):
        partial = first_order_variance(ISHIGAMI, x, w, i)
        assert partial / variance == pytest.approx(index, abs=5e-5)


def test_g_function_has_its_closed_form_moments_and_indices():
    # Two Gauss points in each half are exact: the function is linear in each input there.
    half = 0.25 + 0.25 / np.sqrt(3) * np.array([-1.0, 1.0])
    x, w = grid(np.concatenate([half, half + 0.5]), np.ones(4), 8)
    partial = 1 / (3 * (1 + A) ** 2)
    variance = np.prod(1 + partial) - 1
    assert moments(G_FUNCTION, x, w) == pytest.approx((1.0, variance), rel=1e-10)
    for i in range(8):
        partial_variance = first_order_variance(G_FUNCTION, x, w, i)
        assert partial_variance == pytest.approx(partial[i], rel=1e-10)


def test_linear_has_its_closed_form_moments_and_indices():
    x, w = grid(0.5 + 0.5 / np.sqrt(3) * np.array([-1.0, 1.0]), np.ones(2), 4)
    assert moments(LINEAR, x, w) == pytest.approx((5.0, 30 / 12), rel=1e-12)
    for i in range(4):
        variance = first_order_variance(LINEAR, x, w, i)
        assert variance == pytest.approx((i + 1) ** 2 / 12, rel=1e-12)


def test_a_life_is_depth_over_rate_and_never_below_the_threshold():
    rows = [
        [2e-10, 1e-4, 0.0],
        [2e-10, 1e-4, 2e-10],
        [2e-10, 1e-4, 3e-10],
        [0.0, 1e-4, 0.0],
        [0.0, 0.0, 0.0],
        [2e-10, 0.0, 0.0],
        [1e-320, 1e6, 0.0],
    ]
    outputs, status = evaluate(EXPONENTIAL_WEAR, rows)
    expected = [1e-4 / 2e-10, 1e-4 / 2e-10, np.inf, np.inf, np.inf, 0.0, np.inf]
    np.testing.assert_array_equal(outputs["life"], expected)
    assert not status.any()


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_a_row_does_not_depend_on_the_rows_beside_it(model):
    bounds = np.array([model.parameter(name).bounds for name in model.parameter_names])
    low, high = bounds.T
    x = np.random.default_rng(3).uniform(low, high, (257, len(bounds)))
    (name,) = model.outputs
    whole = evaluate(model, x)[0][name]
    singly = np.concatenate([evaluate(model, row[None])[0][name] for row in x])
    backwards = evaluate(model, x[::-1])[0][name][::-1]
    assert whole.tobytes() == singly.tobytes() == backwards.tobytes()


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_the_nominal_point_lies_within_the_bounds_and_runs(model):
    for name, value in model.nominal.items():
        low, high = model.parameter(name).bounds
        assert low <= value <= high
    outputs, status = evaluate(model, [list(model.nominal.values())])
    assert set(outputs) == set(model.outputs)
    assert status.dtype == np.int8
    assert list(status) == [Status.OK]


@pytest.mark.parametrize(("word", "value"), [("nan", np.nan), ("inf", np.inf)])
def test_linear_fails_by_value_only_above_the_line(word, value):
    x = [[0.4, 0, 0, 0], [0.5, 0, 0, 0], [0.6, 0, 0, 0]]
    outputs, status = evaluate(LINEAR, x, LinearSettings(fail_above=0.5, fail_how=word))
    np.testing.assert_array_equal(outputs["y"], [0.4, 0.5, value])
    assert not status.any()


def test_linear_fails_by_an_exception_or_a_shape_on_request():
    good, bad = [[0.5, 0, 0, 0]], [[0.6, 0, 0, 0]]
    raising = LinearSettings(fail_above=0.5, fail_how="raise")
    assert evaluate(LINEAR, good, raising)[0]["y"] == [0.5]
    with pytest.raises(ValueError, match="x1 is above fail_above = 0.5"):
        evaluate(LINEAR, bad, raising)
    misshapen = LinearSettings(fail_above=0.5, fail_how="shape")
    assert evaluate(LINEAR, good, misshapen)[0]["y"].shape == (1,)
    assert evaluate(LINEAR, bad, misshapen)[0]["y"].shape == (2,)


def test_linear_never_fails_unless_asked():
    y = evaluate(LINEAR, [[1.0, 1.0, 1.0, 1.0]])[0]["y"]
    assert y == [10.0]
