"""Regressions: a row is predicted without itself, and a process is found whatever its rows are."""

import numpy as np
import pytest

from uq.stats.regressions import (
    CHAOS,
    FOLDS,
    PROCESS,
    Predictor,
    ScaledInputs,
    fit_chaos,
    process_of,
    regress,
    scale_of,
    scaled,
)

RNG = np.random.default_rng(1)
Z = RNG.uniform(-1, 1, (80, 2))
Y = np.sin(2 * Z[:, 0]) + Z[:, 0] * Z[:, 1]
PARTS = np.arange(80) % FOLDS
INPUTS = ScaledInputs(Z, PARTS, (True, True))


@pytest.mark.parametrize("kind", [CHAOS, PROCESS])
def test_a_row_is_predicted_by_the_rows_of_other_parts(kind):
    def crossed(y):
        # Rows are standardised together: the same mean and sd in both cases.
        regression = regress(INPUTS, y, np.arange(80), (kind,))
        return Predictor(regression, INPUTS).cross_fitted(Z, PARTS)

    other = Y.copy()
    other[PARTS == 0] = RNG.permutation(Y[PARTS == 0])
    before, after = crossed(Y), crossed(other)
    assert after[PARTS == 0] == pytest.approx(before[PARTS == 0], abs=1e-4)
    assert np.abs(after - before)[PARTS != 0].max() > 0.01


@pytest.mark.parametrize("kind", [CHAOS, PROCESS])
def test_stated_errors_are_those_of_rows_left_out(kind):
    regression = regress(INPUTS, Y, np.arange(80), (kind,))
    left_out = Predictor(regression, INPUTS).cross_fitted(Z, PARTS)
    assert regression.sd * np.array(regression.errors) == pytest.approx(Y - left_out, abs=1e-9)


def test_the_better_kind_is_taken():
    rough = np.abs(Z[:, 0]) ** 0.5
    for y in (Y, rough):
        q2 = {kind: regress(INPUTS, y, np.arange(80), (kind,)).q2 for kind in (CHAOS, PROCESS)}
        assert regress(INPUTS, y, np.arange(80)).kind == max(q2, key=q2.get)


def test_rows_that_occur_twice_have_a_process_in_the_unit_of_the_output():
    z, y = np.concatenate([Z, Z[:20]]), 1e6 + 1e3 * np.concatenate([Y, Y[:20]])
    _, predict = process_of(z, y)
    mean, error = predict(Z[:5])
    assert mean == pytest.approx(1e6 + 1e3 * Y[:5], abs=10.0)
    assert (error < 50.0).all()
    assert predict(np.array([[5.0, 5.0]]))[1] > 100.0


def test_a_scale_is_logarithmic_or_uniform_by_the_shape_of_the_column():
    normal = RNG.normal(size=200)
    scales = {
        (False, True): RNG.uniform(0, 1, 200),
        (False, False): normal,
        (True, False): np.exp(normal),
        (True, True): np.exp(RNG.uniform(0, 5, 200)),
    }
    for (logarithmic, uniform), column in scales.items():
        scale = scale_of("x", column)
        assert (scale.logarithmic, scale.uniform) == (logarithmic, uniform)
        ends = scale(column).min(), scale(column).max()
        assert ends == pytest.approx((scale.low, scale.high))
        if uniform:
            assert ends == pytest.approx((-1, 1))
        else:
            assert scale(column).std() == pytest.approx(1.0)


def test_inputs_of_few_values_whose_polynomials_are_alike_have_a_fit():
    """Of three values; OpenTURNS finds a singular matrix in this sample."""
    rng = np.random.default_rng(11)
    x = np.column_stack(
        [rng.standard_normal(80), rng.choice([1.0, 2.0, 4.0], 80, p=[0.5, 0.3, 0.2])]
    )
    scales = [scale_of(name, column) for name, column in zip("xk", x.T, strict=True)]
    y = x[:, 0] * x[:, 1] + 0.3 * x[:, 1] ** 2
    fit = fit_chaos(scaled(scales, x), (y - y.mean()) / y.std(), (False, True))
    assert len(fit["terms"]) == len(fit["coefficients"]) >= 1
